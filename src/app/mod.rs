//! The frame loop: owns the state, the library, the renderer and the panels.

mod inbox;

pub use inbox::{Inbox, Message, Opening, Reply, ScriptCall};
