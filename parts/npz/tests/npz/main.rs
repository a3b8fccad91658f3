//! Tests of the converter, on files made here.

mod arrays;
#[path = "../../../../tests/support/damage.rs"]
mod damage;
mod errors;
#[path = "../../../../tests/support/glb.rs"]
mod glb;
mod meaning;
mod mutation;
#[path = "../../../../tests/support/numpy.rs"]
mod numpy;
mod person;
