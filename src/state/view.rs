//! The view state: together with the library it determines the picture completely.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{CameraChoice, MotionMap};
use crate::anim::{LoopMode, TimeRange};
use crate::mesh::SkinningMode;
use crate::retarget::{Feet, RootOptions, Unmapped};

/// Everything a person can set. Joints are named by their number in the file's own order, so that the state can be
/// written down without the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewerState {
    /// Where the shown model comes from: URLs, `sample:NAME`, or file names of dropped files.
    pub model: Vec<String>,
    /// Files that clips are borrowed from, besides those that come with the model: as for `model`.
    pub motion: Vec<String>,
    /// Which joints follow which, one map for each pair of skeletons; what is missing is filled in automatically.
    pub map: Vec<MotionMap>,
    /// These three win over what the maps say; none: as they say.
    pub unmapped: Option<Unmapped>,
    pub root: Option<RootOptions>,
    pub feet: Option<Feet>,
    /// Scene of the file; none: the file's default.
    pub scene: Option<usize>,
    pub clip: ClipChoice,
    /// The playhead in clip seconds; runs on beyond the range while looping.
    pub time_secs: f64,
    /// The clip before, while it blends into the present one.
    pub fade: Option<Fade>,
    pub playing: bool,
    pub speed: f64,
    pub loop_mode: LoopMode,
    /// In and out points; none: the whole clip.
    pub range: Option<TimeRange>,
    pub skinning: SkinningMode,
    /// Morph weights set by hand, by index in `Pose::morph_weights`; they win over the clip.
    pub morph: BTreeMap<usize, f32>,
    /// Joints turned by hand, by their numbers in the file: Euler angles in degrees, see [`super::rotation_by_hand`]. They
    /// win over the clip.
    pub pose: BTreeMap<usize, [f32; 3]>,
    /// Names given to joints by hand, by their numbers in the file; never empty. They are shown and written instead of the
    /// file's.
    pub names: BTreeMap<usize, String>,
    pub show: Show,
    /// The chosen joint, by its number in the file: its transforms are shown, and its influence with `show.weights`.
    pub joint: Option<usize>,
    /// The chosen vertex: how its joints move it is shown.
    pub vertex: Option<VertexChoice>,
    pub camera: CameraChoice,
    pub fov_degrees: f32,
    /// The camera stays with the character's root.
    pub follow: bool,
    /// How fast the camera goes around the target by itself, degrees per second of the clock.
    pub turntable: f32,
    pub up: UpAxis,
    /// In stops: the picture is multiplied by 2^exposure.
    pub exposure: f32,
    /// Turn of the environment about the vertical.
    pub environment_degrees: f32,
    pub background: Background,
    /// Only the picture and the transport.
    pub embed: bool,
    /// Keys of a link that this version does not know: kept and written back.
    pub unknown: BTreeMap<String, String>,
}

impl Default for ViewerState {
    fn default() -> Self {
        Self {
            model: Vec::new(),
            motion: Vec::new(),
            map: Vec::new(),
            unmapped: None,
            root: None,
            feet: None,
            scene: None,
            clip: ClipChoice::First,
            time_secs: 0.0,
            fade: None,
            playing: true,
            speed: 1.0,
            loop_mode: LoopMode::Loop,
            range: None,
            skinning: SkinningMode::Linear,
            morph: BTreeMap::new(),
            pose: BTreeMap::new(),
            names: BTreeMap::new(),
            show: Show::default(),
            joint: None,
            vertex: None,
            camera: CameraChoice::Auto,
            fov_degrees: 35.0,
            follow: false,
            turntable: 0.0,
            up: UpAxis::Y,
            exposure: 0.0,
            environment_degrees: 0.0,
            background: Background::Studio,
            embed: false,
            unknown: BTreeMap::new(),
        }
    }
}

/// A vertex of one piece of a mesh, where that mesh hangs on a node: all as indices into the asset's lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct VertexChoice {
    pub instance: usize,
    pub primitive: usize,
    pub vertex: usize,
}

/// What is left of a clip that was changed for another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fade {
    pub clip: ClipChoice,
    /// Where the clip was then, in its own seconds; it goes on from there.
    pub time_secs: f64,
    /// Since the change, in clip seconds.
    pub elapsed_secs: f64,
}

#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClipChoice {
    #[default]
    First,
    RestPose,
    /// A clip's name, or its index in decimal when the name is empty or not unique.
    Named(String),
}

/// What is drawn besides the model. The skeleton is drawn anyway when there is no mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Show {
    pub mesh: bool,
    pub skeleton: bool,
    pub weights: bool,
    pub bounds: bool,
    pub wireframe: bool,
    pub grid: bool,
    pub shadow: bool,
    /// The three skinning modes side by side.
    pub split: bool,
    /// The file that the clip is borrowed from, beside the model.
    pub source: bool,
    /// The same, in the model's own place.
    pub over: bool,
    /// With the source: bones are coloured by how far their turns away from the rest differ from the source's.
    pub error: bool,
    /// The skeleton as spheres and boxes instead of pointed bones.
    pub boxes: bool,
    /// Meshes without normals are smooth instead of flat.
    pub smooth: bool,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            mesh: true,
            skeleton: false,
            weights: false,
            bounds: false,
            wireframe: false,
            grid: true,
            shadow: true,
            split: false,
            source: false,
            over: false,
            error: false,
            boxes: false,
            smooth: false,
        }
    }
}

/// Which axis of the file points up in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpAxis {
    X,
    #[default]
    Y,
    Z,
    MinusX,
    MinusY,
    MinusZ,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Background {
    /// A soft neutral gradient, the same in light and dark themes.
    #[default]
    Studio,
    /// sRGB.
    Color([u8; 3]),
    Transparent,
}
