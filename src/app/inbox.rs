//! Messages from outside the frame loop: finished loads, the script interface, the HTML shell. Handled in order at the
//! start of the next frame; sending one wakes the app up.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use crate::editor::Contents;
use crate::state::{Command, ViewerState};

/// What the loop is told.
pub enum Message {
    /// A load has begun or got further; shown until `Opened` or `OpenFailed`.
    OpenProgress(Opening),
    /// What was opened is ready to be shown instead of the present model, or to be borrowed from. With `state`, that state
    /// is taken over too (a link).
    Opened {
        contents: Box<Contents>,
        state: Option<Box<ViewerState>>,
        reply: Option<Reply<serde_json::Value>>,
    },
    /// What is on the screen stays; the message is shown.
    OpenFailed(String),
    /// As `OpenFailed`, but whoever asked for it says what was wrong.
    OpenGivenUp,
    Commands(Vec<Command>),
    /// Something that was asked for cannot be had; the message is shown.
    Failed(String),
    /// A file that took its time is there, under this name.
    Save(String, Vec<u8>),
    Script(ScriptCall),
}

#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    pub name: String,
    pub received_bytes: u64,
    /// 0: not known.
    pub total_bytes: u64,
}

/// Called once with the answer, or the message a person sees.
pub type Reply<T> = Box<dyn FnOnce(Result<T, String>)>;

/// Calls of `window.gaitway` that need the loop's own data.
pub enum ScriptCall {
    /// The keys of the link as an object.
    State(Reply<serde_json::Value>),
    /// Some keys of the link as an object; answered after the frame that shows it.
    Apply(serde_json::Value, Reply<()>),
    /// The pose document of what is on the screen.
    Pose(Reply<serde_json::Value>),
    /// PNG bytes of the picture alone.
    Screenshot(Reply<Vec<u8>>),
    Stats(Reply<serde_json::Value>),
}

/// A queue that can be filled from anywhere on the loop's thread.
#[derive(Clone)]
pub struct Inbox {
    queue: Arc<Mutex<VecDeque<Message>>>,
    context: egui::Context,
}

impl Inbox {
    pub fn new(context: egui::Context) -> Self {
        Self { queue: Arc::default(), context }
    }

    pub fn send(&self, message: Message) {
        if let Ok(mut queue) = self.queue.lock() {
            queue.push_back(message);
        }
        self.context.request_repaint();
    }

    /// The oldest message not yet handled.
    pub fn take(&self) -> Option<Message> {
        self.queue.lock().ok()?.pop_front()
    }
}
