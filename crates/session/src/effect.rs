//! What a session has the page do.

use serde::{Deserialize, Serialize};

use crate::{Failure, FileId, Item, Kind, Link, RequestId, Role, TaskId};

/// Something to do, in the order in which they are returned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "effect", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub enum Effect {
    /// Start the program with a view. Answered by [`Event::Started`](crate::Event::Started).
    Run {
        /// Its link.
        link: Link,
        /// The model's files, if it isn't loaded from addresses.
        model: Vec<Item>,
        /// Files of the motions and the light.
        motion: Vec<Item>,
        /// Some of them are the user's own.
        is_private: bool,
    },
    /// End the program and start it again.
    Restart,
    /// Read files into memory. Answered by [`Event::Read`](crate::Event::Read), and followed by `Show` or `Forget`.
    Read {
        /// The task.
        task: TaskId,
        /// What to read.
        items: Vec<Item>,
    },
    /// Show items, of which the files have been read. The program cancels what it is loading. Answered by
    /// [`Event::Opened`](crate::Event::Opened).
    Show {
        /// The task.
        task: TaskId,
        /// What to show.
        items: Vec<Item>,
        /// What it is opened as.
        role: Role,
        /// Files among the items are the user's own.
        is_private: bool,
        /// Settings that suit the items may be chosen.
        is_by_hand: bool,
    },
    /// Forget what a task has read, or what is known of what it has opened.
    Forget {
        /// The task.
        task: TaskId,
    },
    /// Show a link, as far as that is possible without the files that it waits for. The program cancels what it is loading.
    /// Answered by [`Event::Followed`](crate::Event::Followed).
    Follow {
        /// The task.
        task: TaskId,
        /// The link.
        link: Link,
        /// Read all of its files again.
        reload: bool,
    },
    /// List what .gltf files refer to that isn't among the items. Of other files, the names are enough. Answered by
    /// [`Event::Lacking`](crate::Event::Lacking).
    FindReferences {
        /// The task.
        task: TaskId,
        /// The files.
        items: Vec<Item>,
    },
    /// Add an entry to the browser's history.
    Push {
        /// Its state.
        state: EntryUpdate,
        /// The part of its address after `#`.
        link: Link,
    },
    /// Change the current entry.
    Replace {
        /// Its state.
        state: EntryUpdate,
        /// The part of its address after `#`; `None` leaves the address as it is.
        link: Option<Link>,
    },
    /// Ask the user for files that a link needs, unless the page shows something more important.
    Ask {
        /// What is needed, one line for each file.
        files: Vec<String>,
        /// Names of files that couldn't be opened.
        others: Option<String>,
        /// They were open before the page was reloaded.
        is_own: bool,
    },
    /// Stop asking.
    CloseAsk,
    /// List what couldn't be loaded, and offer to load it again.
    Report {
        /// One sentence for each part.
        problems: Vec<String>,
        /// Says what is missing.
        title: String,
        /// Says what is shown instead.
        rest: String,
        /// The button that leaves it so.
        without: String,
    },
    /// Close that list.
    CloseReport,
    /// Load the images of the model that is shown again.
    LoadImages,
    /// Show a notice.
    Notify {
        /// The notice.
        text: String,
    },
    /// Tell screen readers about an error that the program shows.
    SayProblem {
        /// The error.
        message: String,
    },
    /// Show an error, and tell screen readers about it: the program doesn't know of it.
    Refuse {
        /// The error.
        message: String,
    },
    /// Forget the error that screen readers were told.
    ForgetProblem,
    /// Tell screen readers what a task has opened.
    Announce {
        /// The task.
        task: TaskId,
        /// What it was.
        kind: Kind,
    },
    /// What the user opened needs the room of the gallery.
    HideGallery,
    /// What the user did is done: the keyboard controls the viewport.
    Focus,
    /// Answer with [`Event::Settled`](crate::Event::Settled) in a moment; again from now, if it is due already.
    SettleSoon,
    /// Answer a request with what a task has opened.
    Reply {
        /// The request.
        request: RequestId,
        /// The task.
        task: TaskId,
    },
    /// Answer a request with an error.
    Reject {
        /// The request.
        request: RequestId,
        /// The error.
        failure: Failure,
    },
    /// Show the dialog for sharing.
    Share {
        /// The link for others.
        link: Link,
        /// The same for a frame of another page.
        embedded: Link,
        /// Files that others need besides the link, one line for each.
        files: Vec<String>,
    },
    /// Open the page in another tab.
    Visit {
        /// The link.
        link: Link,
    },
    /// Forget files, which nothing can show again.
    Release {
        /// The files.
        files: Vec<FileId>,
    },
}

/// The new state of an entry in the browser's history.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct EntryUpdate {
    /// The entry's number.
    pub number: u32,
    /// It has shown the user's own files.
    pub own: bool,
}

/// What the page reads of a session at any time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Facts {
    /// The link of the current view.
    pub link: Link,
    /// It names files that exist only on this computer.
    pub is_local: bool,
    /// What a link needs, if files are asked for.
    pub need: Option<String>,
    /// A page around this one must not learn what is shown.
    pub is_private: bool,
    /// How often the user's own files were opened: reveals any that came and went.
    pub seen_private: u32,
}
