//! Placeholder while the first version is laid out.
