//! Tests of the converter, on text made here and on real files.

mod data;
mod glb;
mod mutation;
mod text;
