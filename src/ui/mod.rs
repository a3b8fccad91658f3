//! The panels: functions that show a library and a view state and give back commands. They never change either, and
//! know neither the clock nor the GPU; what only matters to the panels themselves lives in [`UiState`].

mod clips;
mod feet;
mod keys;
mod motion;
mod tabs;
mod transport;
mod viewport;
mod widgets;

use std::collections::HashSet;

use egui::{Rect, Ui};

use crate::anim::Clip;
use crate::editor::Export;
use crate::frame::{Frame, PickedJoint};
use crate::library::{Library, Model, ModelId};
use crate::state::{Command, ViewerState, active_clip, clip_secs};

pub use crate::editor::short_name;
pub use keys::{KEY_TABLE, KeyHelp};
pub use tabs::Tab;
pub use viewport::overlays::overlays;
pub use viewport::picture::{PictureSlot, labels, picture};
pub use widgets::style::install;

use tabs::{formula, view_options};
use viewport::{gizmo, overlays, picture};
use widgets::{controls, icons, scrub, style};

/// What the panels show. `frame` is what is on the screen: one behind while a command is under way.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    pub library: &'a Library,
    pub state: &'a ViewerState,
    pub frame: &'a Frame,
}

impl<'a> Shown<'a> {
    /// Which clip the state chooses; none: the rest pose.
    pub fn clip_index(&self) -> Option<usize> {
        active_clip(self.library.active()?, self.state)
    }

    pub fn clip(&self) -> Option<&'a Clip> {
        self.library.active()?.clip(self.clip_index()?)
    }

    /// The playhead inside the clip; 0 at rest.
    pub fn clip_time_secs(&self) -> f64 {
        match (self.library.active(), self.clip_index()) {
            (Some(model), Some(clip)) => clip_secs(model, clip, self.state),
            _ => 0.0,
        }
    }

    /// What a frame step is and what times are counted in.
    pub fn frames_per_sec(&self) -> f64 {
        match (self.library.active(), self.clip_index()) {
            (Some(model), Some(clip)) => model.frames_per_sec(clip),
            _ => 30.0,
        }
    }
}

/// What only the panels remember.
#[derive(Debug)]
pub struct UiState {
    pub clips_open: bool,
    pub inspector_open: bool,
    /// On a narrow screen the panels are sheets over the picture, one at a time.
    pub sheet: Option<Sheet>,
    pub tab: Tab,
    pub clip_search: String,
    /// The shown model and the height of the panel when its row was last brought into sight.
    models_seen: Option<(ModelId, u32)>,
    /// The model, its chosen clip and the height of the list when it was last shown.
    clips_seen: Option<(ModelId, Option<usize>, u32)>,
    pub joint_search: String,
    pub help_open: bool,
    /// There is a gallery of samples, which can be asked for.
    pub has_gallery: bool,
    /// Shown until dismissed.
    pub error: Option<String>,
    /// The error is about motions that were refused: what else can be done with them is offered.
    pub motion_refused: bool,
    pub progress: Option<Progress>,
    /// Asks for a path, where the platform has no way to choose files: what has been typed so far.
    pub path_prompt: Option<PathPrompt>,
    /// Time stands still: the playhead is held, or the rings around a joint are aimed at.
    pub holds_time: bool,
    /// The joint under the pointer, as the file numbers it.
    pub hovered_joint: Option<usize>,
    hovered: Option<PickedJoint>,
    /// Width over height of the picture, as last shown.
    pub aspect: f32,
    /// Whether there is an edit to take back, or one to do again.
    pub can_undo: bool,
    pub can_redo: bool,
    /// Says briefly that something was done.
    pub toast: Option<Toast>,
    /// The chosen joint can be turned by hand.
    pub turning: bool,
    /// The chosen joint's matrices are shown.
    matrices: bool,
    probe: formula::Probe,
    /// A joint that is being renamed, as the file numbers it, and what has been typed so far.
    renaming: Option<(usize, String)>,
    /// A video is being recorded: nothing but the picture is on the canvas.
    pub recording: bool,
    picture: view_options::PictureSettings,
    grab: Option<gizmo::Grab>,
    /// The help was open in the last pass already.
    help_shown: bool,
    /// Where the open sheet is.
    sheet_rect: Option<Rect>,
    motion: motion::MotionTab,
    key_marks: scrub::KeyMarks,
    /// Joints whose children are folded away, as the file numbers them, and the model they belong to.
    folded: HashSet<usize>,
    folded_of: Option<ModelId>,
    /// The joint the tree was last scrolled to.
    scrolled_to: Option<usize>,
    /// The joint that it is scrolled to in the next pass.
    scroll_next: Option<usize>,
}

impl UiState {
    /// A link about a joint that is turned by hand means the turning.
    pub fn turn_to_link(&mut self, state: &ViewerState) {
        self.turning = state.selection.joint.is_some_and(|joint| state.edits.pose.contains_key(&joint));
        if self.turning {
            self.tab = Tab::Scene;
        }
    }

    /// Of a model without skins that has morph targets their sliders are shown: its tree tells little.
    pub fn turn_to_model(&mut self, library: &Library) {
        let has_morphs = |model: &Model| !model.asset.skeleton.rest().morph_weights.is_empty();
        let is_morphed = |model: &Model| model.asset.skins.is_empty() && has_morphs(model);
        if self.open_tab(library) == Tab::Scene && library.active().is_some_and(is_morphed) {
            self.tab = Tab::Display;
        }
    }

    /// The tab that is open. One about motions that were taken back waits for them to come again.
    fn open_tab(&self, library: &Library) -> Tab {
        if self.tab == Tab::Motion && library.motions().is_empty() { Tab::Scene } else { self.tab }
    }

    /// Ends what was begun about one of the motions: there are others now.
    pub fn other_motions(&mut self) {
        self.motion.other_motions();
        if matches!(self.path_prompt, Some(PathPrompt { purpose: PathPurpose::Save(_), .. })) {
            self.path_prompt = None;
        }
    }
}

impl Default for UiState {
    fn default() -> Self {
        Self {
            clips_open: true,
            inspector_open: true,
            sheet: None,
            tab: Tab::Scene,
            clip_search: String::new(),
            models_seen: None,
            clips_seen: None,
            joint_search: String::new(),
            help_open: false,
            has_gallery: false,
            error: None,
            turning: false,
            matrices: false,
            probe: formula::Probe::default(),
            renaming: None,
            recording: false,
            picture: view_options::PictureSettings::default(),
            grab: None,
            motion_refused: false,
            progress: None,
            path_prompt: None,
            holds_time: false,
            hovered_joint: None,
            hovered: None,
            aspect: 1.6,
            can_undo: false,
            can_redo: false,
            toast: None,
            help_shown: false,
            sheet_rect: None,
            motion: Default::default(),
            key_marks: scrub::KeyMarks::default(),
            folded: HashSet::new(),
            folded_of: None,
            scrolled_to: None,
            scroll_next: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sheet {
    Clips,
    Inspector,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    pub name: String,
    /// From 0 to 1; none: not known.
    pub fraction: Option<f32>,
}

/// A path that is being typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathPrompt {
    pub purpose: PathPurpose,
    pub path: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathPurpose {
    Open,
    OpenMotion,
    Save(Saved),
}

/// A file that can be saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    File(Export),
    /// What is on the screen, at a size of its own in pixels.
    Picture {
        size: [u32; 2],
        transparent: bool,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Toast {
    pub text: String,
    /// egui's time at which it goes.
    pub until_secs: f64,
    /// What it says can be undone: it has a button for that.
    pub undoable: bool,
}

impl Toast {
    /// Longer than others, for the hand to get there.
    pub const UNDOABLE_SECS: f64 = 3.5;
}

/// What pressing things asks for.
#[derive(Debug, Default, PartialEq)]
pub struct Output {
    pub commands: Vec<Command>,
    pub actions: Vec<UiAction>,
}

/// What is not a change of the view state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum UiAction {
    /// Let the person choose files.
    OpenFiles,
    /// Show the gallery of samples.
    ShowGallery,
    /// Let the person choose files to borrow motion from, or a joint map.
    ChooseMotion,
    /// Do what the prompt was for with what was typed into it.
    UsePath(PathPurpose, String),
    /// Give the person a file.
    Save(Saved),
    /// Show another of the models that are there.
    ShowModel(ModelId),
    /// Let go of a model; of the one that is shown when there is another.
    CloseModel(ModelId),
    /// Borrow no more from a motion.
    RemoveMotion(usize),
    /// Show the skeleton of a motion by itself instead of the model.
    ShowMotionAlone(usize),
    /// What is offered for motions that were refused.
    ShowRefusedAlone,
    MapRefusedByHand,
    /// Record one round of the clip, or end that before its time.
    Record,
    StopRecording,
    /// Give the person a link to this view.
    ShareLink,
    Undo,
    Redo,
}

/// Screens narrower than this get sheets instead of side panels.
pub const NARROW_WIDTH: f32 = 700.0;

/// Shows the panels around the picture and gives back the rectangle that is left for it.
pub fn panels(ui: &mut Ui, shown: Shown<'_>, local: &mut UiState, out: &mut Output) -> Rect {
    let narrow = is_narrow(ui);
    let width = ui.ctx().content_rect().width();
    // The screen is cleared to the panels' colour: filling them again would cost as much as the rest where the CPU draws.
    let side = egui::Frame::new().inner_margin(egui::Margin { left: 14, right: 14, top: 14, bottom: 8 });
    let bottom = egui::Frame::new().inner_margin(egui::Margin { left: 12, right: 12, top: 2, bottom: 6 });
    local.holds_time = false;
    if local.recording {
        return ui.available_rect_before_wrap();
    }
    egui::Panel::bottom("transport")
        .frame(bottom)
        .resizable(false)
        .show_separator_line(false)
        .show(ui, |ui| transport::show(ui, &shown, local, narrow, out));
    if !narrow && !shown.state.page.embed {
        if local.clips_open {
            egui::Panel::left("clips")
                .frame(side)
                .default_size(252.0)
                .size_range(190.0..=(0.3 * width).clamp(190.0, 420.0))
                .show_separator_line(false)
                .show(ui, |ui| clips::show(ui, &shown, local, out));
        }
        if local.inspector_open {
            egui::Panel::right("inspector")
                .frame(side)
                .default_size(304.0)
                .size_range(260.0..=(0.38 * width).clamp(260.0, 520.0))
                .show_separator_line(false)
                .show(ui, |ui| tabs::show(ui, &shown, local, out));
        }
    }
    let free = ui.available_rect_before_wrap();
    local.sheet_rect = (narrow && !shown.state.page.embed && local.sheet.is_some()).then(|| overlays::sheet_rect(free));
    match local.sheet_rect {
        // Above the sheet, or the character would be behind it.
        Some(sheet) => free.with_max_y(sheet.top() + f32::from(overlays::SHEET_CORNER)),
        None => free,
    }
}

fn is_narrow(ui: &Ui) -> bool {
    ui.ctx().content_rect().width() < NARROW_WIDTH
}
