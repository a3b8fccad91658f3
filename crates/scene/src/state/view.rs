//! The view state. Together with the library, it completely determines the image.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{Contacts, Feet, Pin, RootOptions, Unmapped};
use serde::{Deserialize, Serialize};

use super::{CameraChoice, Channel, EnvironmentChoice, Hidden, Lighting, MotionMap, ToneMap};
use crate::library::{ClipEdits, ClipId, LayeredClip, LookTarget};

/// Everything the user can set. The group a field is in says what happens to it:
///
/// | group | starts over with another model | covered by undo |
/// | --- | --- | --- |
/// | `sources` and `playhead` of the character, `selection`, `camera` | yes | no |
/// | `retarget` and `edits` of the character, `inspect` | yes | yes |
/// | `display`, `lighting` | no | yes |
/// | `playback`, `camera_options`, `page` | no | no |
///
/// [`ViewerState::for_model`] and `undoable` are the only code that depends on that. Joints are identified by
/// their index in the file's own order, so that the state can be written down without the file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewerState {
    /// The character on the stage.
    pub character: CharacterView,
    /// What the viewport explains.
    pub inspect: Inspect,
    /// The selected joint and vertex.
    pub selection: Selection,
    /// Where the model is seen from.
    pub camera: CameraChoice,
    /// How clips play.
    pub playback: Playback,
    /// How the scene is drawn.
    pub display: Display,
    /// What lights the scene.
    pub lighting: Lighting,
    /// How any camera behaves.
    pub camera_options: CameraOptions,
    /// What the page does with the view.
    pub page: PageOptions,
    /// Whether values may reveal something about the user's local files, because they were set while these were shown: names of
    /// joints and clips, a pose, a joint map. Copies of the state are private as well, whatever is shown by then. Not in links.
    #[serde(skip)]
    pub is_private: bool,
}

impl ViewerState {
    /// Returns the view of another model: everything about the model comes from `model`, the rest is kept. Ends a crossfade.
    pub fn for_model(self, model: Self) -> Self {
        let Self { playback, display, lighting, camera_options, page, .. } = self;
        let playhead = Playhead { fade: None, ..model.character.playhead };
        let character = CharacterView { playhead, ..model.character };
        // The light may be one of the user's local files.
        let names_file = matches!(&lighting.environment, EnvironmentChoice::File(origin) if !origin.contains("://"));
        let is_private = model.is_private || self.is_private && names_file;
        Self { character, playback, display, lighting, camera_options, page, is_private, ..model }
    }

    /// Returns the default view of a model from this source.
    pub fn of_model(source: String) -> Self {
        let sources = Sources { model: vec![source], ..Sources::default() };
        Self { character: CharacterView { sources, ..CharacterView::default() }, ..Self::default() }
    }

    /// Returns the view with a sample as its model if it names none.
    pub fn or_sample(mut self, name: &str) -> Self {
        let sources = &mut self.character.sources;
        if sources.model.is_empty() {
            sources.model.push(format!("sample:{name}"));
        }
        self
    }

    /// Whether surfaces show the weights of the selected joint.
    pub fn shows_weights(&self) -> bool {
        self.inspect.weights && self.selection.joint.is_some()
    }

    /// The channel that surfaces show: weights take its place.
    pub fn channel(&self) -> Channel {
        if self.shows_weights() { Channel::Shaded } else { self.display.channel }
    }

    /// Whether the turntable moves the camera. A file's own camera stays where it is.
    pub fn is_turning(&self) -> bool {
        self.camera_options.turntable != 0.0 && !matches!(self.camera, CameraChoice::File(_))
    }

    /// Pauses the view and stops its turntable, for users who prefer reduced motion. Returns the replaced settings.
    pub fn reduce_motion(&mut self) -> SavedMotion {
        let playing = Some(std::mem::take(&mut self.playback.playing));
        let turntable = Some(std::mem::take(&mut self.camera_options.turntable));
        SavedMotion { playing, turntable }
    }

    /// Returns the groups that undo covers.
    pub(super) fn undoable(&self) -> UndoableEdits<'_> {
        let Self { character: CharacterView { retarget, edits, .. }, inspect, display, lighting, .. } = self;
        UndoableEdits { retarget, edits, inspect, display, lighting }
    }

    /// Whether the groups that undo covers are equal.
    pub fn has_edits_of(&self, other: &Self) -> bool {
        self.undoable() == other.undoable()
    }

    /// Copies the groups that undo covers from another state.
    pub(super) fn restore_undoable(&mut self, from: &Self) {
        let UndoableEdits { retarget, edits, inspect, display, lighting } = from.undoable();
        self.is_private |= from.is_private;
        self.character.retarget.clone_from(retarget);
        self.character.edits.clone_from(edits);
        self.lighting.clone_from(lighting);
        (self.inspect, self.display) = (*inspect, *display);
    }
}

/// All of the view that belongs to one character.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct CharacterView {
    /// The files and the scene.
    pub sources: Sources,
    /// How motions are retargeted.
    pub retarget: RetargetEdits,
    /// Changes to the model itself.
    pub edits: Edits,
    /// The active clip and the time in it.
    pub playhead: Playhead,
}

/// A view's own settings of motion, for links, while the preference for reduced motion overrides them. `None` if it
/// doesn't, or once the user has changed the setting.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SavedMotion {
    /// Whether clips play.
    pub playing: Option<bool>,
    /// Speed of the turntable in degrees per second.
    pub turntable: Option<f32>,
}

/// The groups of a [`ViewerState`] that undo covers.
#[derive(Debug, PartialEq)]
pub(super) struct UndoableEdits<'a> {
    retarget: &'a RetargetEdits,
    edits: &'a Edits,
    inspect: &'a Inspect,
    display: &'a Display,
    lighting: &'a Lighting,
}

/// The files and the scene.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Sources {
    /// Where the active model comes from: URLs, `sample:NAME`, or names of local files.
    pub model: Vec<String>,
    /// Files whose clips are retargeted, besides those in the model's own archive; written like `model`.
    pub motion: Vec<String>,
    /// Scene of the file; `None` is the file's default.
    pub scene: Option<usize>,
}

/// How motions are retargeted.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct RetargetEdits {
    /// One joint map per pair of skeletons; a missing map is proposed.
    pub map: Vec<MotionMap>,
    /// Overrides what joints without a source do; `None` leaves it to each map.
    pub unmapped: Option<Unmapped>,
    /// Overrides the root options; `None` leaves them to each map.
    pub root: Option<RootOptions>,
    /// Overrides what feet do; `None` leaves it to each map.
    pub feet: Option<Feet>,
    /// Overrides what contacts do; `None` leaves it to each map.
    pub contacts: Option<Contacts>,
    /// The editor planted the feet, not a view or the user. Links don't have it, so it isn't written.
    #[serde(skip)]
    pub feet_are_automatic: bool,
}

impl RetargetEdits {
    /// Sets what feet do, as a view or the user says.
    pub(super) fn set_feet(&mut self, feet: Option<Feet>) {
        (self.feet, self.feet_are_automatic) = (feet, false);
    }
}

/// Changes to the model itself.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Edits {
    /// Morph weights by index in `Pose::morph_weights`; they override the clip.
    pub morph: BTreeMap<usize, f32>,
    /// Weights of expressions, 0 to 1, by [`Expression::name`](gaitway_character::avatar::Expression::name); they override the
    /// clip.
    pub expressions: BTreeMap<String, f32>,
    /// Joints posed manually, by index in the file: Euler angles in degrees, see [`crate::library::manual_rotation`]. They override
    /// the clip.
    pub pose: BTreeMap<usize, [f32; 3]>,
    /// Pinned joints, by index in the file. They override the clip and manual poses.
    pub pins: BTreeMap<usize, Pin>,
    /// Custom joint names, by index in the file; never empty. They replace the file's names on screen and in exported files,
    /// except where a glTF file is copied unchanged.
    pub names: BTreeMap<usize, String>,
    /// Copies, names and changes of clips.
    pub clips: ClipEdits,
    /// Clips over the active one, the lowest first.
    pub layers: Vec<LayeredClip>,
    /// Name of the material variant (KHR_materials_variants); `None` shows the file's own materials.
    pub variant: Option<String>,
    /// Nodes and materials that are not shown.
    pub hidden: Hidden,
    /// Which axis of the file points up.
    pub up: UpAxis,
}

impl Edits {
    /// Range of a morph weight that is set manually.
    pub const MORPH_WEIGHT: RangeInclusive<f32> = -10.0..=10.0;
    /// Range of an expression's weight.
    pub const EXPRESSION_WEIGHT: RangeInclusive<f32> = 0.0..=1.0;

    /// Whether the same overrides the clip.
    pub fn overrides_like(&self, other: &Self) -> bool {
        let Self { morph, expressions, pose, pins, .. } = self;
        (morph, expressions, pose, pins) == (&other.morph, &other.expressions, &other.pose, &other.pins)
    }
}

/// What the viewport explains about the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Inspect {
    /// The influence of the selected joint as a heat map.
    pub weights: bool,
    /// The three skinning methods side by side.
    pub split: bool,
    /// A borrowed clip from each rest of its motion side by side, unless `split` is on.
    pub rests: bool,
}

/// The active clip and the time in it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Playhead {
    /// The active clip.
    pub clip: ClipChoice,
    /// In clip seconds; runs on beyond the range while looping.
    pub time_secs: f64,
    /// `None` unless a crossfade is in progress.
    pub fade: Option<Fade>,
    /// In and out points; `None` is the whole clip.
    pub range: Option<TimeRange>,
}

/// What the user has selected in the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Selection {
    /// Joint by index in the file: displays its transforms and, with `inspect.weights`, its influence.
    pub joint: Option<usize>,
    /// The vertex whose skinning is explained.
    pub vertex: Option<VertexChoice>,
}

/// How clips play.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Playback {
    /// Whether clip time advances.
    pub playing: bool,
    /// Clip seconds per second of the clock, within [`Self::SPEED`].
    pub speed: f64,
    /// What happens at the end of the range.
    pub loop_mode: LoopMode,
}

impl Playback {
    /// Range of the speed.
    pub const SPEED: RangeInclusive<f64> = 0.1..=4.0;
}

impl Default for Playback {
    fn default() -> Self {
        Self { playing: true, speed: 1.0, loop_mode: LoopMode::Loop }
    }
}

/// How the scene is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Display {
    /// Skinning method.
    pub skinning: SkinningMode,
    /// What is drawn.
    pub show: Show,
    /// What surfaces show.
    pub channel: Channel,
    /// The target of an avatar's gaze.
    pub look_at: LookTarget,
    /// Whether an avatar's spring bones are simulated.
    pub springs: bool,
    /// In stops, within [`Self::EXPOSURE`]: the image is multiplied by 2^exposure.
    pub exposure: f32,
    /// The tone mapping.
    pub tone_map: ToneMap,
    /// Rotation of the lighting about the vertical axis.
    pub environment_degrees: f32,
    /// What is behind the scene.
    pub background: Background,
}

impl Display {
    /// Range of the exposure, in stops.
    pub const EXPOSURE: RangeInclusive<f32> = -10.0..=10.0;
}

impl Default for Display {
    fn default() -> Self {
        Self {
            skinning: SkinningMode::Linear,
            show: Show::default(),
            channel: Channel::Shaded,
            look_at: LookTarget::Off,
            springs: false,
            exposure: 0.0,
            tone_map: ToneMap::Neutral,
            environment_degrees: 0.0,
            background: Background::Studio,
        }
    }
}

/// How any camera behaves. Its position depends on the model: see [`ViewerState::camera`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CameraOptions {
    /// Vertical field of view, within [`Self::FOV_DEGREES`].
    pub fov_degrees: f32,
    /// The camera travels with the character's root.
    pub follow: bool,
    /// Speed of the turntable in degrees per second of the clock, within [`Self::TURNTABLE`].
    pub turntable: f32,
}

impl CameraOptions {
    /// Range of the vertical field of view.
    pub const FOV_DEGREES: RangeInclusive<f32> = 5.0..=120.0;
    /// Range of the turntable's speed.
    pub const TURNTABLE: RangeInclusive<f32> = -360.0..=360.0;
}

impl Default for CameraOptions {
    fn default() -> Self {
        Self { fov_degrees: 35.0, follow: false, turntable: 0.0 }
    }
}

/// What an embedded view shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Embed {
    /// Everything: the view isn't embedded.
    #[default]
    Off,
    /// The viewport, the transport, and a button that opens the view in a page of its own.
    Page,
    /// The viewport and the transport.
    Transport,
    /// The viewport alone.
    Viewport,
}

impl Embed {
    /// Whether another page embeds the view.
    pub fn is_on(self) -> bool {
        self != Self::Off
    }

    /// Whether the transport is shown.
    pub fn has_transport(self) -> bool {
        self != Self::Viewport
    }
}

/// What the page does with the view.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct PageOptions {
    /// How much of the page is shown where another page embeds the view.
    pub embed: Embed,
    /// Unknown link keys with all their values, preserved when the link is written again; for `show`, its unknown words.
    pub unknown: BTreeMap<String, Vec<String>>,
}

/// A vertex of a primitive of a mesh instance; all are indices into the asset's lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct VertexChoice {
    /// Index into [`gaitway_character::asset::AssetParts::instances`].
    pub instance: usize,
    /// Index into the mesh's primitives.
    pub primitive: usize,
    /// Index into the primitive's positions, so copies made on loading count.
    pub vertex: usize,
}

/// The outgoing clip of a crossfade.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fade {
    /// The clip that fades out.
    pub clip: ClipChoice,
    /// Clip time when the crossfade started; the clip plays on from there.
    pub time_secs: f64,
    /// Time since then, in clip seconds.
    pub elapsed_secs: f64,
}

/// Which clip is active.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClipChoice {
    /// The first clip; the rest pose if there are no clips.
    #[default]
    First,
    /// The first clip of the motions that were opened for the model; without any, as [`Self::First`].
    FirstOfMotions,
    /// No clip: every joint at rest.
    RestPose,
    /// This clip; the rest pose while the model lacks it.
    Clip(ClipId),
}

impl ClipChoice {
    /// Returns the choice of a clip that is still to be looked up by its name, or by its index in decimal.
    pub fn called(name: &str) -> Self {
        Self::Clip(ClipId::called(name))
    }
}

/// What is drawn. A model without meshes always shows its skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Show {
    /// Surfaces of the meshes.
    pub mesh: bool,
    /// Bones between the joints.
    pub skeleton: bool,
    /// Box around the current pose.
    pub bounds: bool,
    /// Triangle edges of the meshes.
    pub wireframe: bool,
    /// Grid on the ground.
    pub grid: bool,
    /// The model's shadow on the ground.
    pub shadow: bool,
    /// The source of a retargeted clip, beside the model.
    pub source: bool,
    /// The source, overlaid on the model.
    pub over: bool,
    /// With the source: colours bones by their rotation error relative to it.
    pub error: bool,
    /// Draws the skeleton as spheres and boxes instead of octahedral bones.
    pub boxes: bool,
    /// Includes bones that move no mesh in the skeleton.
    pub controls: bool,
    /// Shades meshes without normals smooth instead of flat.
    pub smooth: bool,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            mesh: true,
            skeleton: false,
            bounds: false,
            wireframe: false,
            grid: true,
            shadow: true,
            source: false,
            over: false,
            error: false,
            boxes: false,
            controls: false,
            smooth: false,
        }
    }
}

/// Which axis of the file points up in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpAxis {
    /// The file's +X.
    X,
    /// The file's +Y.
    #[default]
    Y,
    /// The file's +Z.
    Z,
    /// The file's −X.
    MinusX,
    /// The file's −Y.
    MinusY,
    /// The file's −Z.
    MinusZ,
}

/// What is behind the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Background {
    /// A soft neutral gradient, the same in light and dark themes.
    #[default]
    Studio,
    /// sRGB.
    Color([u8; 3]),
    /// Alpha 0.
    Transparent,
    /// What lights the scene.
    Environment,
    /// The same, out of focus.
    Blurred,
}
