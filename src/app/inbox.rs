//! Messages from outside the frame loop: finished loads, the script interface, the HTML shell. They are handled in order at the
//! start of the next frame; sending one wakes the app.

use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use gaitway_scene::editor::{Contents, ExportedFile};
use gaitway_scene::library::ModelId;
use gaitway_scene::state::ViewerState;

use crate::ui::Progress;

/// A message to the frame loop.
pub enum Message {
    /// A load has started or progressed; displayed until `Opened` or `OpenFailed`.
    OpenProgress(Progress),
    /// Files are ready: models to activate, motions to retarget. With `state` (a link), that replaces the state too.
    Opened {
        /// The models, motions and joint map that were read.
        contents: Box<Contents>,
        /// `None` keeps what still fits of the current state.
        state: Option<Box<ViewerState>>,
        /// Whether `state` is a change of the current state rather than a link's.
        is_change: bool,
        /// Answered with the problems that the shell shows, once the viewport shows the model, or with the error.
        reply: Option<Reply<Vec<String>>>,
    },
    /// Nothing was opened; shows the message.
    OpenFailed(String),
    /// Nothing was opened; the caller reports why.
    OpenFailedSilently,
    /// A request failed; shows the message.
    Failed(String),
    /// Shows a notice.
    Notice(String),
    /// A file written in the background is ready to save.
    Save(ExportedFile),
    /// A file was saved under this name, with a remark for the user, or couldn't be.
    Saved(Result<(String, Option<String>), String>),
    /// The recording has ended: the name of the saved file, `None` if it was cancelled, or why there is none.
    Recorded(Result<Option<String>, String>),
    /// The Khronos validator's report on a model as JSON, or why there is none.
    Validated(ModelId, Result<String, String>),
    /// A call from the script interface.
    Script(ScriptCall),
}

/// Called once with the result, or with the message for the user.
pub type Reply<T> = Box<dyn FnOnce(Result<T, String>)>;

/// Calls of `window.gaitway` that need the loop's data.
pub enum ScriptCall {
    /// Sets some keys of the link, given as an object; answered after the frame that shows the result.
    Apply(serde_json::Value, Reply<()>),
    /// Returns the viewport as PNG bytes.
    Screenshot(Reply<Vec<u8>>),
}

/// Numbers loads. One that was started earlier may finish later: only the latest is shown.
#[derive(Debug, Default)]
pub struct Loads(Cell<u32>);

impl Loads {
    /// Returns the number of a new load.
    pub fn start(&self) -> u32 {
        self.0.set(self.0.get() + 1);
        self.0.get()
    }

    /// Whether no other load has been started since.
    pub fn is_latest(&self, number: u32) -> bool {
        self.0.get() == number
    }
}

/// A queue that any code can send to.
#[derive(Clone)]
pub struct Inbox {
    queue: Arc<Mutex<VecDeque<Message>>>,
    context: egui::Context,
}

impl Inbox {
    /// Returns an empty queue that wakes `context` when something is sent. Clones share the queue.
    pub fn new(context: egui::Context) -> Self {
        Self { queue: Arc::default(), context }
    }

    /// Appends a message and requests a repaint, so that the next frame handles it.
    pub fn send(&self, message: Message) {
        if let Ok(mut queue) = self.queue.lock() {
            queue.push_back(message);
        }
        self.wake();
    }

    /// Requests a frame.
    pub fn wake(&self) {
        self.context.request_repaint();
    }

    /// Removes the oldest message.
    pub fn take(&self) -> Option<Message> {
        self.queue.lock().ok()?.pop_front()
    }
}
