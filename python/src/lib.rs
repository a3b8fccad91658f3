//! The Python package: classes and functions over those of the command line, with NumPy arrays for times and poses. `gaitway.pyi`
//! has their types, `docs/python.md` an introduction. Whatever takes long lets other Python threads run.
//!
//! Options, messages and documents are those of the command line: keyword arguments are parsed as its options. One build for
//! Python's stable ABI serves all versions from 3.10 on.

#![deny(unsafe_code)]
// As in the other packages: files are untrusted.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod arrays;
mod clip;
mod error;
mod file;
mod retarget;
mod show;

/// Load characters and motions, propose joint maps, retarget clips, and sample poses as NumPy arrays.
///
/// Units are metres and seconds; Y is up; rotations are quaternions in the order x, y, z, w.
#[pyo3::pymodule]
mod gaitway {
    #[pymodule_export]
    use crate::clip::Clip;
    #[pymodule_export]
    use crate::error::Error;
    #[pymodule_export]
    use crate::file::{File, Model, Motion, load_model, load_motion};
    #[pymodule_export]
    use crate::retarget::{Retargeted, propose_map, retarget};
    #[pymodule_export]
    use crate::show::{Scene, show};
}
