//! Keyframes: the source's channels as functions of time, resampling, and the channels to be written.

pub mod channel;
pub mod limits;
pub mod resample;
pub mod tracks;
