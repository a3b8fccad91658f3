//! Keyframes: reading the source's channels and adding keys where the source has none.

pub mod resample;
pub mod track;
