//! Tests of the converter, on archives made here.

#[path = "../../../../tests/support/damage.rs"]
mod damage;
mod errors;
#[path = "../../../../tests/support/glb.rs"]
mod glb;
mod meaning;
mod mutation;
#[path = "../../../../tests/support/numpy.rs"]
mod numpy;
