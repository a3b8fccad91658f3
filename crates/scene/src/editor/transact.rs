//! Changes of the view, and what the editor does about them: whatever changes it, what has changed decides what follows.

use super::Editor;
use super::camera::LookedAt;
use crate::state::{Command, OrbitCamera, ViewerState};

/// What a change is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    /// An edit of what is shown: the camera stays where the user expects it.
    Edit,
    /// Another view, or other files: they come with a clip and a camera of their own.
    View,
}

/// What is compared with the view after a change.
struct Before {
    state: ViewerState,
    /// What the viewport shows if the camera is automatic.
    view: Option<OrbitCamera>,
    /// See [`Editor::looked_at`].
    looked_at: Option<LookedAt>,
}

impl Editor {
    /// Makes a change and reacts to what differs after it. Returns the problems of retargeting.
    pub(super) fn transact(&mut self, kind: Change, change: impl FnOnce(&mut Self)) -> Vec<String> {
        let before = match kind {
            Change::Edit => {
                Some(Before { state: self.state.clone(), view: self.automatic_view(), looked_at: self.looked_at() })
            }
            Change::View => None,
        };
        change(self);
        (self.needs_redraw, self.is_changed) = (true, true);
        let problems = match before {
            Some(before) => self.react(before),
            None => self.retarget(),
        };
        self.note_private();
        problems
    }

    fn react(&mut self, Before { state: before, view, looked_at }: Before) -> Vec<String> {
        let (old, new) = (&before.character.edits, &self.state.character.edits);
        let is_retargeted = before.character.retarget != self.state.character.retarget || old.clips != new.clips;
        let is_moved = is_retargeted || !old.overrides_like(new);
        let has_turned = old.up != new.up;
        let has_chosen_clip = before.character.playhead.clip != self.state.character.playhead.clip;
        let problems = if is_retargeted { self.retarget() } else { Vec::new() };
        if has_turned {
            self.apply(Command::FrameAll);
        }
        match view {
            Some(_) if has_chosen_clip => {
                self.hold(None);
                self.suit_automatic_follow();
            }
            Some(view) if is_retargeted => self.hold_view(view),
            Some(view) if is_moved => self.hold_still(view),
            _ => {}
        }
        if let Some(looked_at) = looked_at {
            self.keep_looking(looked_at);
        }
        problems
    }
}
