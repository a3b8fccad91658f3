//! The editor owns what is loaded and what is set, and is the only way to change either. It knows no UI, GPU or I/O: the page,
//! the window, the command line and the tests are shells around it.
//!
//! Everything that happens is a call (`open`, `apply`, `undo`, …); what the shell should tell the user about it is an [`Event`].

mod camera;
mod contents;
mod event;
mod export;
mod motions;
mod names;
mod open;
mod steps;

pub use contents::{Contents, ModelFiles, OpenedModel, container_of};
pub use event::Event;
pub use export::{Export, ExportedFile};
pub use names::{name_and_place, short_name};

use std::collections::BTreeMap;

use serde_json::Value;

use crate::library::{Library, ModelId, Motion};
use crate::state::{Command, History, ViewerState, from_object};
use open::Shelved;

/// Says whether a model can be shown, for example whether it fits on the graphics device; the error is what the user sees.
pub type Admit<'a> = &'a mut dyn FnMut(&crate::library::Model) -> Result<(), String>;

#[derive(Debug)]
pub struct Editor {
    library: Library,
    state: ViewerState,
    history: History,
    /// What is kept of each model besides the model itself.
    shelf: BTreeMap<ModelId, Shelved>,
    /// Motions that did not fit the model, until the user says what to do with them.
    refused: Vec<Motion>,
    /// A local joint map was opened.
    has_own_map: bool,
    /// Errors about retargeted clips that have been reported.
    reported: Vec<String>,
    /// Width over height of the viewport, which some camera commands depend on.
    aspect: f32,
    events: Vec<Event>,
    needs_redraw: bool,
    is_changed: bool,
}

impl Default for Editor {
    fn default() -> Self {
        Self::new(Library::default(), ViewerState::default())
    }
}

impl Editor {
    /// For most windows; shells that know theirs call [`Editor::set_aspect`].
    const USUAL_ASPECT: f32 = 1.6;

    pub fn new(library: Library, state: ViewerState) -> Self {
        let mut editor = Self {
            library,
            state,
            history: History::default(),
            shelf: BTreeMap::new(),
            refused: Vec::new(),
            has_own_map: false,
            reported: Vec::new(),
            aspect: Self::USUAL_ASPECT,
            events: Vec::new(),
            needs_redraw: true,
            is_changed: false,
        };
        editor.retarget();
        editor
    }

    pub fn library(&self) -> &Library {
        &self.library
    }

    pub fn state(&self) -> &ViewerState {
        &self.state
    }

    /// What happened since the last call, oldest first.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// Whether the picture may differ from that at the last call.
    pub fn take_needs_redraw(&mut self) -> bool {
        std::mem::take(&mut self.needs_redraw)
    }

    /// Whether anything was set since the last call; time going by does not count.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.is_changed)
    }

    pub fn set_aspect(&mut self, aspect: f32) {
        self.aspect = aspect;
    }

    /// Applies a command, keeping the camera where the user expects it. A replacement state that names other files than the
    /// loaded ones is ignored: something else was opened since it was asked for.
    pub fn apply(&mut self, command: Command) {
        if matches!(&command, Command::Replace(state) if !self.has_files_of(state)) {
            return;
        }
        self.is_changed |= !matches!(command, Command::Advance(_));
        self.needs_redraw = true;
        let is_about_motion = is_about_motion(&command);
        let refits = matches!(command, Command::SetUp(_));
        self.tell_about_follow(&command);
        let command = self.prepare_camera(command);
        self.record(command);
        if refits {
            self.apply(Command::FrameAll);
        }
        if is_about_motion {
            let problems = self.retarget();
            self.report(problems);
        }
    }

    /// Sets some keys of the link, all or none.
    ///
    /// # Errors
    /// What is wrong with the values, or with the joint maps among them.
    pub fn apply_partial(&mut self, partial: &Value) -> Result<(), String> {
        let (state, errors) = from_object(&self.state, partial);
        if !errors.is_empty() {
            return Err(errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
        }
        if !self.has_files_of(&state) {
            return Err(OTHER_FILES.to_owned());
        }
        let before = self.state.clone();
        self.record(Command::Replace(Box::new(state)));
        let problems = self.retarget();
        (self.needs_redraw, self.is_changed) = (true, true);
        if problems.is_empty() {
            return Ok(());
        }
        self.state = before;
        self.retarget();
        Err(problems.join("; "))
    }

    /// Whether anything loaded is one of the user's local files.
    pub fn is_private(&self) -> bool {
        self.has_own_map
            || self.library.active().is_some_and(|model| model.is_own)
            || self.library.motions().iter().any(|motion| motion.is_own)
    }

    /// Changes the state through the history, without any of the rules of [`Editor::apply`].
    fn record(&mut self, command: Command) {
        self.history.apply(&mut self.state, &self.library, command);
    }

    /// A replacement state must name the files that are loaded, since it loads none.
    fn has_files_of(&self, state: &ViewerState) -> bool {
        let (new, now) = (&state.sources, &self.state.sources);
        new.model == now.model && new.motion == now.motion
    }

    fn notify(&mut self, text: String) {
        self.events.push(Event::Notice { text, undoable: false });
    }

    fn notify_undoable(&mut self, text: String) {
        self.events.push(Event::Notice { text, undoable: true });
    }

    fn report(&mut self, problems: Vec<String>) {
        self.events.extend(problems.into_iter().map(Event::Problem));
    }
}

const OTHER_FILES: &str = "something else was opened in the meantime";

/// Whether retargeted clips depend on what the command sets.
fn is_about_motion(command: &Command) -> bool {
    matches!(
        command,
        Command::Replace(_)
            | Command::SetMap { .. }
            | Command::SetSource { .. }
            | Command::EditMap { .. }
            | Command::SetUnmapped(_)
            | Command::SetRoot(_)
            | Command::SetFeet(_)
    )
}
