//! The page's module: see [`gaitway_part::module!`].

gaitway_part::module!(gaitway_npz::convert);
