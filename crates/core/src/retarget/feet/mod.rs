//! Foot contacts, and feet planted where they touch the ground.

mod contacts;
mod leg;
mod plant;

pub use contacts::{contacts, source_height};
pub use plant::planted_channels;
