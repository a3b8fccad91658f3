//! What the page tells a session.

use serde::{Deserialize, Serialize};

use crate::{Item, Link, RequestId, TaskId};

/// Something that has happened. Its JSON is its name, or an object with its data under that name: code that reads the name from among
/// the data takes twice as much of the page's program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase")]
pub enum Event {
    /// The page looks for a back end that works. A program that ran has ended.
    Launch,
    /// A program for one has been loaded. Answered by [`Effect::Run`](crate::Effect::Run).
    Loaded,
    /// The program shows its first image.
    Started {
        /// Parts of the link that couldn't be loaded, one sentence for each.
        problems: Vec<String>,
    },
    /// The program has ended, with everything that it was doing.
    Stopped {
        /// Why, for the user.
        reason: String,
    },
    /// No program can be started.
    CannotRun {
        /// Why.
        failure: Failure,
    },
    /// Files came with the page. Its links can name them.
    Hold {
        /// Files that belong together.
        items: Vec<Item>,
    },
    /// Something is opened.
    Open {
        /// Whoever waits for the answer; nobody does where the user opens something.
        request: Option<RequestId>,
        /// Who opens it.
        by: By,
        /// One set of files.
        items: Vec<Item>,
        /// What the files are opened as.
        role: Role,
    },
    /// The browser shows another entry of its history, or an address that was typed.
    Moved {
        /// The link in the address, or the first screen's.
        link: Link,
        /// What the entry's state holds.
        state: EntryState,
    },
    /// The program's view has changed.
    Changed {
        /// Its link, which has the bare names of local files.
        link: Link,
    },
    /// Nothing has changed for a moment since the last [`Effect::SettleSoon`](crate::Effect::SettleSoon).
    Settled,
    /// [`Effect::Read`](crate::Effect::Read) is done.
    Read {
        /// The task.
        task: TaskId,
    },
    /// [`Effect::Show`](crate::Effect::Show) is done.
    Opened {
        /// The task.
        task: TaskId,
        /// What the items were.
        kind: Kind,
    },
    /// [`Effect::Follow`](crate::Effect::Follow) is done, as far as that is possible.
    Followed {
        /// The task.
        task: TaskId,
        /// The sources that were read.
        read: Vec<String>,
        /// What couldn't be opened, one sentence for each.
        problems: Vec<String>,
    },
    /// A task has failed and changed nothing.
    Failed {
        /// The task.
        task: TaskId,
        /// Why.
        failure: Failure,
    },
    /// The answer to [`Effect::FindReferences`](crate::Effect::FindReferences).
    Lacking {
        /// The task.
        task: TaskId,
        /// The files that are referred to and not among the items.
        names: Vec<String>,
    },
    /// A script has set keys of the link.
    Applied {
        /// The sources that were read for that.
        read: Vec<String>,
    },
    /// The images of the model that is shown couldn't be loaded.
    ImagesFailed {
        /// Why.
        problem: String,
    },
    /// The user wants to load again what [`Effect::Report`](crate::Effect::Report) has listed.
    TryAgain,
    /// The user brings the files that [`Effect::Ask`](crate::Effect::Ask) has asked for later, or not at all.
    Later,
    /// The user shares a view. Answered by [`Effect::Share`](crate::Effect::Share).
    Share {
        /// Its link.
        link: Link,
    },
    /// The user opens a view in another tab. Answered by [`Effect::Visit`](crate::Effect::Visit).
    Visit {
        /// Its link.
        link: Link,
    },
}

/// Who opens something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum By {
    /// The user: by a drop, a dialog or the system.
    Hand,
    /// A script of the page itself.
    Script,
    /// The page around this one, which already knows the files that it gives.
    Frame,
}

/// What files are opened as.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum Role {
    /// Whatever they are.
    #[default]
    Any,
    /// Motions: models lend theirs.
    Motion,
}

/// What has been opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum Kind {
    /// A model, perhaps with motions.
    Model,
    /// Motions alone.
    Motion,
    /// An image that lights the scene.
    Light,
    /// A joint map.
    Map,
}

/// The state of an entry in the browser's history. Pages of other versions write it, too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EntryState {
    /// The entry's number; `None` for an address that was typed.
    pub number: Option<u32>,
    /// The entry has shown the user's own files.
    pub own: bool,
}

/// What the program says about what it shows.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Shown {
    /// Something of it is one of the user's own files.
    pub is_private: bool,
    /// There is no model.
    pub is_empty: bool,
    /// The sources of the models.
    pub models: Vec<String>,
}

/// Why something couldn't be done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Its kind, for scripts.
    pub code: Option<ErrorCode>,
    /// The message for the user.
    pub message: String,
}

impl Failure {
    pub(crate) fn new(code: ErrorCode, message: impl Into<String>) -> Self {
        Self { code: Some(code), message: message.into() }
    }

    pub(crate) fn is(&self, code: ErrorCode) -> bool {
        self.code == Some(code)
    }

    /// Returns the message as a sentence.
    pub(crate) fn sentence(&self) -> String {
        format!("{}.", self.message.trim_end_matches('.'))
    }
}

/// What kind of failure an error is, for scripts: the `code` of the errors that `window.gaitway` rejects with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorCode {
    /// A file, sample or server is not there, or did not answer.
    NotFound,
    /// The browser does not let this page read the file.
    CrossOrigin,
    /// Gaitway cannot read such a file, or cannot show it here.
    Unsupported,
    /// A file, an argument or a value is invalid.
    Malformed,
    /// A limit on what is read is exceeded.
    TooLarge,
    /// The user cancelled it, or something else was opened in the meantime.
    Cancelled,
    /// The program or its graphics device has stopped.
    LostDevice,
    /// The browser has no graphics API that Gaitway can use.
    NoGraphics,
}
