//! What was asked for and isn't done: items to open, links to follow, and how far each is.

use serde::{Deserialize, Serialize};

use crate::companions::{Question, Set};
use crate::held::Files;
use crate::{By, Item, Kind, Link, RequestId, TaskId};

/// What was asked for, in its order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Ask(pub u32);

/// Something that was asked for: items to open, a link to follow, or first the one and then the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Job {
    /// Later ones have higher numbers.
    pub ask: Ask,
    /// `None` for a link.
    pub opening: Option<Opening>,
    pub stage: Stage,
}

/// What somebody opens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Opening {
    pub request: Option<RequestId>,
    pub by: By,
    /// As given.
    pub set: Set,
    /// A link waits for some of the items, which are shown as it says, in its entry of the history.
    pub is_in_entry: bool,
    /// The task that has shown the items, and what they were.
    pub shown: Option<(TaskId, Kind)>,
}

/// How far something is that was asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Stage {
    /// Waits for the model on its way.
    Turn,
    /// Waits for those before it to be joined with what they belong to.
    Join(Set),
    /// Waits for what its .gltf refers to.
    Joining(TaskId, Question),
    /// Waits for the program.
    Program(Set),
    /// Is read and shown, and may complete a link with all that was given.
    Loading(Load, Vec<Item>),
    /// A link is followed.
    Following(Box<Following>),
}

/// Items that are read, and then shown by the program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Load {
    pub task: TaskId,
    pub set: Set,
    pub is_private: bool,
    pub is_by_hand: bool,
    /// The program has been told of it.
    pub is_read: bool,
}

impl Stage {
    /// Returns what is being loaded.
    pub fn load(&self) -> Option<&Load> {
        match self {
            Self::Loading(load, _) => Some(load),
            Self::Following(following) => following.load(),
            Self::Turn | Self::Join(_) | Self::Joining(..) | Self::Program(_) => None,
        }
    }

    pub fn load_mut(&mut self) -> Option<&mut Load> {
        match self {
            Self::Loading(load, _) => Some(load),
            Self::Following(following) => following.load_mut(),
            Self::Turn | Self::Join(_) | Self::Joining(..) | Self::Program(_) => None,
        }
    }

    /// Returns the task that it waits for.
    pub fn task(&self) -> Option<TaskId> {
        match self {
            Self::Joining(task, _) => Some(*task),
            Self::Loading(load, _) => Some(load.task),
            Self::Following(following) => following.task(),
            Self::Turn | Self::Join(_) | Self::Program(_) => None,
        }
    }

    /// Whether the view may change for it.
    pub fn has_begun(&self) -> bool {
        matches!(self, Self::Loading(..) | Self::Following(_))
    }

    fn items(&self) -> Vec<&Item> {
        match self {
            Self::Turn => Vec::new(),
            Self::Join(set) | Self::Program(set) => set.items.iter().collect(),
            Self::Joining(_, question) => question.iter().collect(),
            Self::Loading(load, given) => load.set.items.iter().chain(given).collect(),
            Self::Following(following) => following.items(),
        }
    }
}

impl Job {
    /// Returns all items that it refers to.
    pub fn items(&self) -> Vec<&Item> {
        let mut items = self.stage.items();
        items.extend(self.opening.iter().flat_map(|opening| &opening.set.items));
        items
    }
}

/// A link to follow, and what its entry of the history showed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Followed {
    /// As in the address.
    pub link: Link,
    /// The same with the names of the files that are held.
    pub held_link: Link,
    pub files: Files,
    pub was_private: bool,
    /// The files were open before the page was reloaded; `None` if the entry tells.
    pub is_own: Option<bool>,
    /// Read all of it again.
    pub reload: bool,
}

impl Followed {
    pub fn of(link: Link) -> Self {
        let (held_link, files) = (link.clone(), Files::default());
        Self { link, held_link, files, was_private: false, is_own: None, reload: false }
    }
}

/// A link that is being followed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Following {
    pub followed: Followed,
    /// As far as it can be shown.
    pub link_for_now: Link,
    /// Local files of what was shown before.
    pub before: Files,
    /// A key of the files that were shown before.
    pub shown_before: String,
    /// Something else was on its way, so the program has to be told in any case.
    pub overtakes: bool,
    pub step: Step,
}

/// What the program does, in this order. Each may be left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Step {
    Begun,
    /// Shows local files of the model.
    Model(Load),
    /// Shows the model, which borrows the motions, instead of the one that was shown before.
    Base(TaskId),
    /// Shows local files of the motions.
    Motion(Load),
    /// Shows the link with what has been read.
    Link(TaskId),
}

impl Following {
    pub fn load(&self) -> Option<&Load> {
        match &self.step {
            Step::Model(load) | Step::Motion(load) => Some(load),
            Step::Begun | Step::Base(_) | Step::Link(_) => None,
        }
    }

    pub fn load_mut(&mut self) -> Option<&mut Load> {
        match &mut self.step {
            Step::Model(load) | Step::Motion(load) => Some(load),
            Step::Begun | Step::Base(_) | Step::Link(_) => None,
        }
    }

    pub fn task(&self) -> Option<TaskId> {
        match &self.step {
            Step::Model(load) | Step::Motion(load) => Some(load.task),
            Step::Base(task) | Step::Link(task) => Some(*task),
            Step::Begun => None,
        }
    }

    pub fn items(&self) -> Vec<&Item> {
        let loaded = self.load().into_iter().flat_map(|load| &load.set.items);
        loaded.chain(self.followed.files.iter()).chain(self.before.iter()).collect()
    }
}
