//! Opening files from disk, network, drop or picker: reads them, sorts them by content and decodes images, which gives
//! [`gaitway_scene::editor::Contents`]. The trait `source::Source` is what disk and network have in common.

mod address;
#[cfg(not(target_arch = "wasm32"))]
mod decode;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
mod early;
mod error;
mod image_limits;
mod images;
mod open;
mod origins;
#[cfg(any(target_arch = "wasm32", test))]
mod plain_image;
mod png;
mod read;
#[cfg(not(target_arch = "wasm32"))]
mod save;
mod sort;
mod source;
mod view;
#[cfg(target_arch = "wasm32")]
mod web;
#[cfg(not(target_arch = "wasm32"))]
mod web_page;
#[cfg(not(target_arch = "wasm32"))]
mod zip;

pub use address::raw_address;
#[cfg(not(target_arch = "wasm32"))]
pub use decode::decode_images;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use disk::is_below;
#[cfg(not(target_arch = "wasm32"))]
pub use disk::{Disk, Opened, STANDARD_STREAM, member_of, open_paths, read_paths};
pub use early::EarlyWatch;
pub use error::OpenError;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use error::describe;
pub use image_limits::ImageLimits;
pub use images::has_ktx2;
pub use png::encode_png;
pub use read::{Item, extensions};
#[cfg(not(target_arch = "wasm32"))]
pub use save::{SaveError, TemporaryFile, is_stream, refuse_input, save_file};
pub use sort::{Role, SortError, Sorted, read_map, sort};
pub use source::Progress;
pub use view::Held;
#[cfg(target_arch = "wasm32")]
pub use web::{OnImage, open_items, open_view, within};
#[cfg(not(target_arch = "wasm32"))]
pub use web_page::{Backend, NoTemplate, PAGE_VARIABLE, WebPage, escaped, read_template};
#[cfg(not(target_arch = "wasm32"))]
pub use zip::zip;
