//! What a person has set, as plain data, and the one way to change it. Knows no user interface, GPU or clock.

mod camera;
mod command;
mod link;
mod view;

pub use camera::{CameraChoice, OrbitCamera};
pub use command::{Command, apply};
pub use link::{LinkError, from_link, to_link};
pub use view::{Background, ClipChoice, Show, UpAxis, ViewerState};
