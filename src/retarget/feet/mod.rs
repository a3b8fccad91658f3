//! Foot contacts, and feet planted where they touch the ground.

pub mod contacts;
mod plant;
