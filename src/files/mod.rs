//! Getting at bytes: disk, drop, picker, network; sorting files by what they are; decoding images. Produces
//! [`crate::library::Model`]s and [`crate::library::Motion`]s.

mod address;
#[cfg(not(target_arch = "wasm32"))]
mod decode;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
mod image_limit;
mod png;
mod sort;
#[cfg(target_arch = "wasm32")]
mod web;

pub use address::raw_address;
#[cfg(not(target_arch = "wasm32"))]
pub use decode::decode_images;
#[cfg(not(target_arch = "wasm32"))]
pub use disk::{OpenError, Opened, open_bytes, open_paths, read_paths, read_set};
pub use image_limit::set_largest_image;
pub use png::encode_png;
pub use sort::{Role, SortError, Sorted, read_map, sort};
#[cfg(target_arch = "wasm32")]
pub use web::{Item, OpenError, open_items, open_view};
