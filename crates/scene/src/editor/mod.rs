//! The editor owns the library, the state and the history, and is the only way to change them. It has no UI, GPU or I/O: the
//! page, the window, the command line and the tests are shells around it.
//!
//! Shells call it (`open`, `apply`, `undo`, …) and present the resulting [`Event`]s to the user.

mod camera;
mod contents;
mod event;
mod export;
mod maps;
mod motions;
mod names;
mod new_version;
mod one_character;
mod open;
mod opened;
mod other_reading;
mod reduced_motion;
mod scene;
mod steps;
mod suit;
mod transact;
mod validation;

pub use crate::library::ModelFiles;
pub use contents::{AboutLink, Contents, OpenedMap, OpenedModel};
pub use event::{Event, Reading};
pub use export::{
    AWAITS_IMAGES, ClipFormat, Export, ExportPlan, ExportedFile, OneFileFormat, Packaging, PlannedClip, Recipient,
    RootBone, derived_clip, write_clip,
};
pub use maps::{MapProblem, reconciled_maps};
pub use names::{name_and_place, short_name};
pub use scene::Scene;
pub use validation::{ValidatorGroup, ValidatorReport};

use std::collections::BTreeMap;

use serde_json::Value;

use crate::library::{Environment, Library, ModelId, Motion};
use crate::state::{
    ClipChoice, Command, DEFAULT_ASPECT, EnvironmentChoice, History, LinkError, OrbitCamera, ViewerState, from_object,
    looks_past, view_problems,
};
use open::Shelved;
use other_reading::OtherReading;
use transact::Change;

/// Decides whether a model can be shown, for example whether it fits on the graphics device. The error is for the user.
pub type Admit<'a> = &'a mut dyn FnMut(&crate::library::Model) -> Result<(), String>;

/// Owns the library, the state and the history. Every change to them goes through its methods.
#[derive(Debug)]
pub struct Editor {
    library: Library,
    state: ViewerState,
    history: History,
    /// Data kept with each loaded model.
    shelf: BTreeMap<ModelId, Shelved>,
    /// Motions that don't fit the model, until the user decides what to do with them.
    refused: Vec<Motion>,
    other_reading: Option<OtherReading>,
    /// Name of the joint map's file while it is being opened.
    opened_map: Option<String>,
    /// What is known of a link while its view is being opened.
    about_link: AboutLink,
    /// A joint map was opened from the user's local files.
    has_private_map: bool,
    /// Errors about retargeted clips that have been reported.
    reported: Vec<String>,
    /// Width over height of the viewport, which some camera commands depend on.
    aspect: f32,
    /// The camera that stands in for the automatic one since an option has changed what that would frame.
    held_camera: Option<OrbitCamera>,
    /// Whether the camera follows is chosen for each clip, since neither a view nor the user has said it.
    suits_follow: bool,
    reduced_motion: reduced_motion::ReducedMotion,
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
    /// Takes a library and a state, and retargets the library's motions as the state asks.
    pub fn new(library: Library, state: ViewerState) -> Self {
        let mut editor = Self {
            library,
            state,
            history: History::default(),
            shelf: BTreeMap::new(),
            refused: Vec::new(),
            other_reading: None,
            opened_map: None,
            about_link: AboutLink::default(),
            has_private_map: false,
            reported: Vec::new(),
            aspect: DEFAULT_ASPECT,
            held_camera: None,
            suits_follow: false,
            reduced_motion: reduced_motion::ReducedMotion::default(),
            events: Vec::new(),
            needs_redraw: true,
            is_changed: false,
        };
        editor.retarget();
        editor
    }

    /// Returns the loaded models and motions.
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// Returns the current state.
    pub fn state(&self) -> &ViewerState {
        &self.state
    }

    /// Returns the events since the last call, oldest first.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// Whether the viewport may look different than at the last call.
    pub fn take_needs_redraw(&mut self) -> bool {
        std::mem::take(&mut self.needs_redraw)
    }

    /// Whether the state has changed since the last call, other than by time passing.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.is_changed)
    }

    /// Sets the viewport's width over height, which some camera commands depend on.
    pub fn set_aspect(&mut self, aspect: f32) {
        self.aspect = aspect;
    }

    /// Applies a command, keeping the camera where the user expects it. Ignores a replacement state whose files are not the
    /// loaded ones: something else was opened after it was requested.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::Replace(view) if self.has_files_of(&view) => {
                let problems = self.transact(Change::View, |editor| editor.set_view(*view.clone()));
                self.settle_view(&view, problems);
            }
            Command::Replace(_) => {}
            // Nothing follows from time, which must not cost a copy of the state in every frame.
            Command::Advance(_) => {
                self.needs_redraw = true;
                let command = self.prepare_camera(command);
                self.record(command);
            }
            command => self.edit(command),
        }
    }

    fn edit(&mut self, command: Command) {
        self.suits_follow &= !matches!(command, Command::SetFollow(_));
        let rematched = self.map_to_rematch(&command);
        self.notify_follow(&command);
        self.tell_source(&command);
        let problems = self.transact(Change::Edit, |editor| {
            let command = editor.prepare_camera(command);
            editor.record(command);
        });
        self.report(problems);
        if let Some((motion, before)) = rematched {
            self.notify_rematch(&motion, &before);
        }
    }

    /// Sets some keys of the link; all or none.
    ///
    /// # Errors
    /// The message for the user if a value or a joint map is invalid.
    pub fn apply_partial(&mut self, partial: &Value) -> Result<(), String> {
        let (mut state, errors) = from_object(&self.state, &self.library, partial);
        if !errors.is_empty() {
            return Err(errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
        }
        if !self.has_files_of(&state) {
            return Err(OTHER_FILES.to_owned());
        }
        let before = self.state.clone();
        // What it says is no longer chosen automatically.
        self.suits_follow &= partial.get("follow").is_none();
        state.character.retarget.feet_are_automatic &= partial.get("feet").is_none();
        let view = state.clone();
        let problems = self.transact(Change::View, |editor| editor.record(Command::Replace(Box::new(state))));
        if problems.is_empty() {
            let mut unusable = view_problems(&view, self.library.active());
            unusable.retain(|problem| partial.get(problem.key()).is_some());
            self.tell(&unusable, problems);
            return Ok(());
        }
        self.state = before;
        self.retarget();
        Err(problems.join("; "))
    }

    /// The loaded environment that lights the scene.
    fn environment(&self) -> Option<&Environment> {
        match &self.state.lighting.environment {
            EnvironmentChoice::File(origin) => self.library.environment(origin),
            EnvironmentChoice::Setup(_) => None,
        }
    }

    /// Whether anything shown is one of the user's local files, or anything set may come from one.
    pub fn is_private(&self) -> bool {
        self.state.is_private || self.shows_private()
    }

    /// Marks the state as private while the user's local files are shown: from now on, it may have values from them.
    fn note_private(&mut self) {
        self.state.is_private |= self.shows_private();
    }

    fn shows_private(&self) -> bool {
        self.has_private_map
            || self.library.active().is_some_and(|model| model.is_own)
            || self.library.motions().iter().any(|motion| motion.is_own)
            || self.environment().is_some_and(|environment| environment.is_own)
    }

    /// Applies a command through the history, without the additional rules of [`Editor::apply`].
    fn record(&mut self, command: Command) {
        let before = self.moving_parts();
        self.history.apply(&mut self.state, &self.library, command);
        self.note_moving_parts(before);
    }

    /// Whether the state names the loaded files. Replacing the state loads none.
    fn has_files_of(&self, state: &ViewerState) -> bool {
        let (new, now) = (&state.character.sources, &self.state.character.sources);
        new.model == now.model && new.motion == now.motion
    }

    /// Tells all that is wrong with a view that was just applied, and `problems` of retargeting. If its link still waits for files,
    /// replaces an unknown clip, and tells only what is not understood.
    pub(super) fn settle_view(&mut self, view: &ViewerState, problems: Vec<String>) {
        let AboutLink { mut errors, is_partial } = std::mem::take(&mut self.about_link);
        if is_partial {
            if self.is_clip_unknown() {
                self.state.character.playhead.clip = ClipChoice::First;
            }
            return self.tell(&errors, Vec::new());
        }
        errors.extend(view_problems(view, self.library.active()));
        let has_model = self.library.active().is_some_and(|model| !model.is_placeholder());
        if has_model && looks_past(&self.library, &self.state, self.aspect) {
            errors.push(LinkError::LooksPast);
        }
        self.tell(&errors, problems);
    }

    /// Tells what can't be used of a view, below its problems if there are any. Alone it isn't an error: the rest of the view is
    /// shown.
    fn tell(&mut self, errors: &[LinkError], problems: Vec<String>) {
        const MAX_LINES: usize = 12;
        let mut lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let more = lines.len().saturating_sub(MAX_LINES);
        lines.truncate(MAX_LINES);
        if more > 0 {
            lines.push(format!("and {more} more"));
        }
        if !problems.is_empty() {
            self.report(problems);
            self.report(lines);
        } else if !lines.is_empty() {
            self.events.push(Event::AboutView(lines.join(".\n") + "."));
        }
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
