//! Getting at bytes: disk, drop, picker, network; and decoding images. Produces [`crate::library::Model`]s.

#[cfg(not(target_arch = "wasm32"))]
mod decode;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub use decode::decode_images;
#[cfg(not(target_arch = "wasm32"))]
pub use disk::{OpenError, Opened, open_bytes, open_paths};
#[cfg(target_arch = "wasm32")]
pub use web::{Item, OpenError, decode_images, open_items};
