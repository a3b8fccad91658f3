//! Brings the rests of both skeletons together before motion is transferred.

pub mod rest;
pub mod swing;
