//! The frame loop: connects the editor, the viewport and the panels to a window or a page.

mod device;
mod host;
mod inbox;
pub mod mirror;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod notices;
mod record;
mod recording;
mod run;
mod save;
mod scene_texture;
mod timing;
mod validate;
mod viewport;

pub use device::{FatalHook, set_fatal_hook};
pub use host::{Host, Video};
pub use inbox::{Inbox, Loads, Message, Reply, ScriptCall};
pub use run::App;

#[cfg(not(target_arch = "wasm32"))]
pub use device::native_options;
#[cfg(target_arch = "wasm32")]
pub use device::web_options;
#[cfg(not(target_arch = "wasm32"))]
pub use native::{WindowError, run_native};
