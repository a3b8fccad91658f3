//! The page's module: see [`gaitway_part::module!`].

gaitway_part::module!(gaitway_fbx_writer::convert);
