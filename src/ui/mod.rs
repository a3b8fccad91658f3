//! The user interface: functions that show a library and a view state and return commands. They change neither, and know
//! neither the clock nor the GPU; what only the interface remembers lives in [`UiState`].

mod change;
mod clips;
mod feet;
mod gestures;
mod header;
mod keys;
mod layers;
mod motion;
mod output;
mod pins;
mod search;
mod tabs;
pub mod text;
mod tracks;
mod transport;
mod typing;
mod viewport;
mod widgets;

use egui::{Context, Rect, Ui};
use gaitway_scene::editor::ValidatorReport;
use gaitway_scene::frame::Frame;
use gaitway_scene::library::{Library, Model, ModelClip, ModelId};
use gaitway_scene::state::{ViewerState, active_clip, clip_secs};

pub use gestures::{begin_gestures, end_gestures};
pub use keys::{KEY_TABLE, KeyHelp};
pub use output::{Output, RecordingFormat, Saved, UiAction, VideoSettings};
pub use tabs::Tab;
pub use viewport::awaited::title_and_hint;
pub use viewport::help::Help;
pub use viewport::labels::labels;
pub use viewport::notices::{Messages, Progress, Toast};
pub use viewport::overlays::overlays;
pub use viewport::{ViewportSlot, ViewportState, viewport};
pub use widgets::style::FONT;

use viewport::sheet;
use widgets::{controls, icons, modal, scrub, style};

/// Prepares a context: fonts, styles, and what goes to a field instead of to shortcuts.
pub fn install(context: &Context) {
    style::install(context);
    typing::install(context);
}

/// What the interface shows. `frame` is what is on the screen: one behind while a command is being applied.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The loaded models and motions.
    pub library: &'a Library,
    /// The current view state, which `frame` may not show yet.
    pub state: &'a ViewerState,
    /// The last evaluated frame.
    pub frame: &'a Frame,
}

impl<'a> Shown<'a> {
    /// Returns the current clip, or `None` for the rest pose.
    pub fn clip(&self) -> Option<&'a ModelClip> {
        active_clip(self.library.active()?, self.state)
    }

    /// Whether the current clip has a duration, so that there is something to play.
    pub fn is_animated(&self) -> bool {
        self.clip().is_some_and(|clip| clip.duration_secs() > 0.0)
    }

    /// Playhead position in the clip; 0 for the rest pose.
    pub fn clip_time_secs(&self) -> f64 {
        self.clip().map_or(0.0, |clip| clip_secs(clip, self.state))
    }

    /// Frame rate for frame steps and frame numbers.
    pub fn frames_per_sec(&self) -> f64 {
        self.clip().map_or(30.0, ModelClip::frames_per_sec)
    }
}

/// State of the interface itself, grouped by the code that owns it. Never part of a link.
#[derive(Debug, Default)]
pub struct UiState {
    /// What the app reports; set by the app.
    pub host: HostState,
    /// Progress, errors and toasts.
    pub messages: Messages,
    /// Which panels, sheet and tab are open.
    pub layout: Layout,
    /// Aspect ratio, hovered joint and gizmo drag of the viewport.
    pub viewport: ViewportState,
    /// State of the selected joint's card in the Scene tab.
    pub joint_card: tabs::JointCard,
    /// The list of keys and gestures.
    pub help: Help,
    /// The box about Gaitway is open.
    pub about_open: bool,
    /// Time stands still while the user holds the playhead or points at the rotation gizmo.
    pub holds_time: bool,
    /// The model in the open Info tab, which needs its thumbnails and the GPU memory; taken by the app in each frame.
    pub info_model: Option<ModelId>,
    /// While a modal is open: the control that had the focus when it opened, if any. It gets the focus back.
    focus_before_modal: Option<Option<egui::Id>>,
    /// A menu was open at the end of the last frame.
    had_popup: bool,
    /// The Khronos validator was asked for in the Info tab, or runs there; its results then scroll into view.
    is_validating: bool,
    lists: tabs::Lists,
    clip_list: clips::ClipList,
    scene_tree: tabs::SceneTree,
    vertex_probe: tabs::VertexProbe,
    picture_settings: tabs::PictureSettings,
    /// The Camera tab was opened for them; they then scroll into view.
    seeks_picture_settings: bool,
    key_marks: scrub::KeyMarks,
    motion: motion::MotionTab,
}

/// What the app tells the interface: what can be done at the moment.
#[derive(Debug, Default)]
pub struct HostState {
    /// The platform can show a gallery of samples.
    pub has_gallery: bool,
    /// The platform can show Gaitway in full screen.
    pub has_fullscreen: bool,
    /// The platform can save self-contained pages that show a scene.
    pub can_save_page: bool,
    /// There is a step to undo.
    pub can_undo: bool,
    /// There is an undone step to redo.
    pub can_redo: bool,
    /// The next undo takes back the user's edit of a joint map or of how motions are retargeted.
    pub can_undo_retargeting: bool,
    /// The next redo repeats such an edit.
    pub can_redo_retargeting: bool,
    /// Counts for the last image, and frame times.
    pub drawn: Drawn,
    /// GPU memory of the shown models in bytes: geometry and images.
    pub drawn_bytes: [u64; 2],
    /// Small copies of the images of `thumbnails_of`, by index in the asset.
    pub thumbnails: Vec<Option<egui::TextureId>>,
    /// The model that they were made for.
    pub thumbnails_of: Option<ModelId>,
    /// The video that is being recorded; everything else waits.
    pub recording: Option<RecordingProgress>,
    /// The host can run the Khronos validator.
    pub has_validator: bool,
    /// The model was read from a glTF, which can be validated.
    pub has_gltf: bool,
    /// The last validation and its model.
    pub validation: Option<(ModelId, Validation)>,
}

/// State of the validation of a model's file.
#[derive(Debug, Clone, PartialEq)]
pub enum Validation {
    /// The validator is running.
    Running,
    /// The validator's report.
    Done(ValidatorReport),
    /// Why there is no report.
    Failed(String),
}

/// What the last image took to draw.
#[derive(Debug, Clone, Copy, Default)]
pub struct Drawn {
    /// Draw calls of the shadow pass and of all panes.
    pub draw_calls: u32,
    /// Triangles of meshes and bones in all panes.
    pub triangles: u32,
    /// Times between frames while something moves.
    pub frames: FrameTimes,
}

/// Times between the last frames in seconds, without the pauses while nothing moves.
#[derive(Debug, Clone, Copy)]
pub struct FrameTimes {
    secs: [f32; Self::CAPACITY],
    /// Number of times added so far.
    count: usize,
}

impl Default for FrameTimes {
    fn default() -> Self {
        Self { secs: [0.0; Self::CAPACITY], count: 0 }
    }
}

impl FrameTimes {
    /// Maximum number of times.
    pub const CAPACITY: usize = 120;

    /// Adds a time, in place of the oldest one when full.
    pub fn push(&mut self, secs: f32) {
        self.secs[self.count % Self::CAPACITY] = secs;
        self.count += 1;
    }

    /// Returns the times, the oldest first.
    pub fn iter(&self) -> impl Iterator<Item = f32> + '_ {
        let oldest = self.count.saturating_sub(Self::CAPACITY);
        (oldest..self.count).map(|at| self.secs[at % Self::CAPACITY])
    }

    /// Returns the mean of the times; `None` before the first.
    pub fn mean_secs(&self) -> Option<f32> {
        let count = self.count.min(Self::CAPACITY);
        (count > 0).then(|| self.iter().sum::<f32>() / count as f32)
    }
}

/// How far the recording of a video has got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordingProgress {
    /// Frames drawn so far.
    pub frames_done: u32,
    /// Number of frames of the video.
    pub frame_count: u32,
}

/// Which panels are open.
#[derive(Debug)]
pub struct Layout {
    /// The clips panel, on the left, is open. Ignored on a small screen.
    pub clips_open: bool,
    /// The inspector, on the right, is open. Ignored on a small screen.
    pub inspector_open: bool,
    /// On a small screen the panels are sheets over the viewport, one at a time. Closed on a large one.
    pub sheet: Option<Sheet>,
    /// The chosen inspector tab. The Scene tab stands in for Motion while that has nothing to show.
    pub tab: Tab,
    /// The screen has sheets instead of side panels.
    is_small: bool,
    /// Where the open sheet is.
    sheet_rect: Option<Rect>,
    /// How far the user has dragged the sheet above its usual height.
    sheet_raised: f32,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            clips_open: true,
            inspector_open: true,
            sheet: None,
            tab: Tab::Scene,
            is_small: false,
            sheet_rect: None,
            sheet_raised: 0.0,
        }
    }
}

impl Layout {
    /// Shows or hides a panel.
    fn toggle(&mut self, panel: Sheet) {
        match panel {
            _ if self.is_small => self.sheet = if self.sheet == Some(panel) { None } else { Some(panel) },
            Sheet::Clips => self.clips_open = !self.clips_open,
            Sheet::Inspector => self.inspector_open = !self.inspector_open,
        }
    }

    /// Opens the inspector at a tab.
    fn show_tab(&mut self, tab: Tab) {
        (self.tab, self.inspector_open, self.sheet) = (tab, true, Some(Sheet::Inspector));
    }

    /// The tab that is shown. The Motion tab waits while there is nothing in it.
    fn open_tab(&self, library: &Library) -> Tab {
        if self.tab == Tab::Motion && !tabs::has_motion_tab(library) { Tab::Scene } else { self.tab }
    }
}

/// A panel shown as a sheet on a small screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sheet {
    /// Open models and clips.
    Clips,
    /// The inspector tabs.
    Inspector,
}

/// On narrower screens, half of the screen is the viewport's only without the inspector.
const ROOMY_WIDTH: f32 = 1400.0;

impl UiState {
    /// Closes the inspector of a screen that has no room for it beside the first picture, unless the view is about a joint in it.
    pub fn start(&mut self, screen_width: f32) {
        self.layout.inspector_open = screen_width >= ROOMY_WIDTH || self.joint_card.is_posing;
    }

    /// Shows the pose sliders if the opened view selects a joint that it poses manually.
    pub fn on_view_opened(&mut self, state: &ViewerState) {
        self.joint_card.is_posing =
            state.selection.joint.is_some_and(|joint| state.character.edits.pose.contains_key(&joint));
        if self.joint_card.is_posing {
            (self.layout.tab, self.layout.inspector_open) = (Tab::Scene, true);
        }
    }

    /// Shows the sliders of an unskinned model with morph targets: its tree says little.
    pub fn on_model_opened(&mut self, library: &Library) {
        let has_morphs = |model: &Model| !model.asset.skeleton.rest().morph_weights.is_empty();
        let is_morphed = |model: &Model| model.asset.skins.is_empty() && has_morphs(model);
        if self.layout.open_tab(library) == Tab::Scene && library.active().is_some_and(is_morphed) {
            self.layout.tab = Tab::Display;
        }
    }

    /// Shows the joint table of a motion that the user maps manually. With `takes_focus`, its first joint gets the focus, which the
    /// control that began it had.
    pub fn on_map_started(&mut self, takes_focus: bool) {
        self.layout.show_tab(Tab::Motion);
        self.motion.focus_table(takes_focus);
    }

    /// Brings the Motion tab forward. On a small screen, the viewport stays in sight.
    pub fn on_motions_added(&mut self) {
        (self.layout.tab, self.layout.inspector_open) = (Tab::Motion, true);
    }

    /// Whether a modal dialog is open.
    pub fn has_modal(&self) -> bool {
        self.help.is_open || self.about_open || self.motion.is_picking() || self.host.recording.is_some()
    }

    /// Drops what was begun for a motion, whose index may now be another's.
    pub fn on_motions_changed(&mut self) {
        self.motion.other_motions();
    }

    /// Drops what is shown about a model's images, which have only now arrived.
    pub fn forget_images(&mut self) {
        self.lists = tabs::Lists::default();
        self.host.thumbnails_of = None;
    }
}

/// Screens narrower than this get sheets instead of side panels.
const SMALL_WIDTH: f32 = 700.0;
/// The same for screens lower than [`LOW_HEIGHT`]: phones held sideways, where side panels would leave no viewport.
const SMALL_WIDTH_IF_LOW: f32 = 1000.0;
const LOW_HEIGHT: f32 = 450.0;
/// Lower screens have room for the transport, but not for the header as well.
const MIN_HEIGHT_FOR_HEADER: f32 = 200.0;
/// Lower screens are all viewport.
const MIN_HEIGHT_FOR_TRANSPORT: f32 = 150.0;

/// Shows the panels and returns the rectangle that they leave for the viewport.
pub fn panels(ui: &mut Ui, shown: Shown<'_>, local: &mut UiState, out: &mut Output) -> Rect {
    local.holds_time = false;
    local.vertex_probe.keep_to(shown.library.active().map(|model| model.id));
    let small = is_small(ui);
    local.layout.is_small = small;
    style::size_controls(ui, small);
    let height = ui.ctx().content_rect().height();
    if !shown.state.page.embed.is_on() && height >= MIN_HEIGHT_FOR_HEADER {
        header::show(ui, &shown, local, out);
    }
    let has_sheet = small && !shown.state.page.embed.is_on() && local.layout.sheet.is_some();
    let below_header = ui.available_rect_before_wrap();
    let side_sheet = has_sheet.then(|| sheet::side_rect(below_header)).flatten();
    if has_sheet && side_sheet.is_none() && sheet::takes_all(below_header) {
        // The viewport keeps its size behind the sheet, and so the camera its framing.
        local.layout.sheet_rect = Some(below_header);
        return below_header;
    }
    if let Some(rect) = side_sheet {
        // Beside the transport, since such screens are low.
        let place = egui::Panel::right("side sheet").frame(egui::Frame::NONE).exact_size(rect.width());
        place.resizable(false).show_separator_line(false).show(ui, |_| ());
        local.layout.sheet_raised = local.layout.sheet_raised.min(0.0);
    }
    if height >= MIN_HEIGHT_FOR_TRANSPORT && shown.state.page.embed.has_transport() {
        let side = if small { 6 } else { 12 };
        let bottom = egui::Frame::new().inner_margin(egui::Margin { left: side, right: side, top: 2, bottom: 6 });
        egui::Panel::bottom("transport")
            .frame(bottom)
            .resizable(false)
            .show_separator_line(false)
            .show(ui, |ui| transport::show(ui, &shown, local, small, out));
    }
    if !small && !shown.state.page.embed.is_on() {
        side_panels(ui, &shown, local, out);
    }
    let free = ui.available_rect_before_wrap();
    let raised = &mut local.layout.sheet_raised;
    local.layout.sheet_rect = side_sheet.or_else(|| has_sheet.then(|| sheet::bottom_rect(free, raised)));
    match local.layout.sheet_rect {
        // The viewport ends where the sheet begins, so that the character is not behind it.
        Some(rect) if side_sheet.is_some() => free.with_max_x(rect.left() + f32::from(style::WINDOW_CORNER)),
        Some(rect) => free.with_max_y(rect.top() + f32::from(style::WINDOW_CORNER)),
        None => free,
    }
}

fn side_panels(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let width = ui.ctx().content_rect().width();
    // No fill: the screen is already cleared to the panels' colour, and on software renderers a fill costs as much as the rest.
    let frame = egui::Frame::new().inner_margin(egui::Margin { left: 14, right: 14, top: 14, bottom: 8 });
    if local.layout.clips_open {
        egui::Panel::left("clips")
            .frame(frame)
            .default_size(252.0)
            .size_range(190.0..=(0.3 * width).clamp(190.0, 420.0))
            .show_separator_line(false)
            .show(ui, |ui| clips::show(ui, shown, local, out));
        name_edge(ui, "clips", text::RESIZE_CLIPS);
    }
    if local.layout.inspector_open {
        egui::Panel::right("inspector")
            .frame(frame)
            .default_size((0.21 * width).clamp(304.0, 420.0))
            .size_range(260.0..=(0.38 * width).clamp(260.0, 520.0))
            .show_separator_line(false)
            .show(ui, |ui| tabs::show(ui, shown, local, 0.0, out));
        name_edge(ui, "inspector", text::RESIZE_INSPECTOR);
    }
}

/// Names the edge that resizes a panel of this `Ui`, and tells its share of the room: egui calls each of them the same. The salt of
/// its id is egui's own.
fn name_edge(ui: &Ui, panel: &str, name: &str) {
    let edge = ui.scope_id().with(panel).with("__resize");
    ui.ctx().accesskit_node_builder(edge, |node| {
        node.set_label(name);
        if let Some(share) = node.numeric_value() {
            node.set_value(text::percent(share));
        }
    });
}

fn is_small(ui: &Ui) -> bool {
    let size = ui.ctx().content_rect().size();
    size.x < if size.y < LOW_HEIGHT { SMALL_WIDTH_IF_LOW } else { SMALL_WIDTH }
}
