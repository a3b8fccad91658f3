//! A frame ready to draw: `evaluate` turns the library and the state into plain numbers. No clock and no randomness: the
//! same library and state give the same frame.
//!
//! A pose is sampled once, into the frame: whatever needs it reads [`Frame::pose`] and the frame's matrices.

mod evaluate;
mod formula;
mod overlays;
mod pick;
mod pick_vertex;
mod pose_document;
mod view;

use std::ops::Range;
use std::sync::Arc;

use gaitway_character::anim::{JointIndex, Pose, PropertyValues};
use gaitway_character::asset::{LightKind, Panorama};
use gaitway_character::mesh::{Bounds, Material, PaletteEntry, SkinningMode};
use glam::{Affine3A, Mat4, Vec3, Vec4};

use crate::library::{ClipId, ModelId};
use crate::state::{Background, Channel, Comparison, KeyLight, LightSetup, ToneMap};

pub use evaluate::{evaluate, travelled};
pub use formula::{FormulaTerm, JointMatrices, VertexFormula, joint_matrices, vertex_formula};
pub use pick::{PickedJoint, pick_joint};
pub use pick_vertex::pick_vertex;
pub use pose_document::{NodePose, PoseDocument, pose_document};
pub use view::current_orbit;

/// Input of the renderer. Reused between frames, so that evaluation stops allocating once the buffers have grown.
#[derive(Debug, Default)]
pub struct Frame {
    /// The camera.
    pub view: View,
    /// Display settings.
    pub look: Look,
    /// What the panes compare.
    pub comparison: Option<Comparison>,
    /// Columns and rows of equally sized panes that share one camera.
    pub panes: [u32; 2],
    /// The active model first, once per pane; then the source of its borrowed clip, if shown.
    pub characters: Vec<Character>,
    /// The active model's clip that the pose was sampled from; none for the rest pose.
    pub clip: Option<ClipId>,
    /// The file's own lights in world space; if empty, the key light is used.
    pub lights: Vec<FrameLight>,
    /// The environment, if it is an image; replaces [`Look::light`].
    pub panorama: Option<Arc<Panorama>>,
    /// Overlay lines (bounds, axes), their width in pixels.
    pub lines: Vec<Line>,
    /// Bones of the skeletons, present even if hidden, so that clicks can pick them.
    pub bones: Vec<Bone>,
    /// World-space bounds of everything visible over the whole clip; the shadow map and the grid fit to them.
    pub bounds: Bounds,
    scratch: evaluate::Scratch,
}

impl Frame {
    /// Removes the axes of the selected joint, which belong to the interface and not into a picture.
    pub fn remove_axes(&mut self) {
        self.lines.retain(|line| !line.on_top);
    }

    /// Local pose of the active model: the clip, blended, with everything set manually. Empty without a model.
    pub fn pose(&self) -> &Pose {
        &self.scratch.sampler.pose
    }

    /// The values of material, light, camera and visibility properties that the clip or the expressions change.
    pub fn properties(&self) -> &PropertyValues {
        &self.scratch.sampler.properties
    }

    /// The weights of the active model's expressions from the clip or set manually, before they override each other.
    pub fn expressions(&self) -> &[f32] {
        self.scratch.sampler.expressions()
    }

    /// Whether what is on a joint of the active model is shown; false outside the chosen scene.
    pub fn is_visible(&self, joint: JointIndex) -> bool {
        self.scratch.model_scene.joints.visible.get(joint.get()).copied().unwrap_or(false)
    }
}

/// The camera of a frame, shared by all panes.
#[derive(Debug, Clone, Copy, Default)]
pub struct View {
    /// Right-handed, looking along −Z.
    pub view_from_world: Mat4,
    /// WebGPU's clip space: depth from 0 (near) to 1 (far), Y up.
    pub projection_from_view: Mat4,
    /// Position of the camera in world space.
    pub eye: Vec3,
}

/// Display settings that apply to the whole frame.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Multiplies linear colours: 2^stops.
    pub exposure: f32,
    /// Tone-mapping operator, applied after exposure.
    pub tone_map: ToneMap,
    /// Rotation of the environment and the key light about +Y.
    pub environment_radians: f32,
    /// What lights the scene besides the file's own lights.
    pub light: LightSetup,
    /// Replaces the environment's own key light.
    pub key: Option<KeyLight>,
    /// What shows behind the scene.
    pub background: Background,
    /// What surfaces show.
    pub channel: Channel,
    /// Draws the surfaces. Without them nothing casts a shadow.
    pub mesh: bool,
    /// Draws the edges of triangles, over the surfaces if those are drawn.
    pub wireframe: bool,
    /// Draws the skeleton as spheres and boxes.
    pub boxes: bool,
    /// Shades meshes without normals smooth instead of flat.
    pub smooth: bool,
    /// Draws shadows, on the ground as well as on meshes.
    pub shadow: bool,
    /// `None` hides the grid.
    pub grid: Option<Grid>,
    /// Height of the plane that the character stands on and that receives shadows.
    pub ground_height: f32,
    /// Time within the clip, for what moves without keys; 0 at rest.
    pub time_secs: f32,
}

/// A grid on the ground plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// World-space Y of the grid.
    pub height: f32,
    /// Distance between thin lines, a power of ten in metres; every tenth line is thick.
    pub spacing: f32,
    /// Distance from `center` at which the grid has faded out.
    pub radius: f32,
    /// Middle of the grid in world space, at `height`.
    pub center: Vec3,
}

/// A model in a pose.
#[derive(Debug, Default)]
pub struct Character {
    /// The model whose meshes are drawn; for a source, that of its [`Motion::stage`](crate::library::Motion::stage).
    pub model: ModelId,
    /// Skinning method, for which `palette` is written.
    pub skinning: SkinningMode,
    /// Index of its pane, row by row; none for all panes.
    pub pane: Option<u32>,
    /// Index of the material variant in [`gaitway_character::asset::AssetParts::variants`]; `None` for the file's own materials.
    pub variant: Option<usize>,
    /// Materials whose surfaces are not drawn, in ascending order; `None` is the default material.
    pub hidden_materials: Vec<Option<usize>>,
    /// One per joint of the model.
    pub world_from_joint: Vec<Affine3A>,
    /// World-space palettes of all draws, concatenated.
    pub palette: Vec<PaletteEntry>,
    /// Weights of all morph targets, laid out as in [`Pose::morph_weights`].
    pub morph_weights: Vec<f32>,
    /// The materials that the clip animates, without their names, and their indices in the asset, in ascending order.
    pub materials: Vec<(usize, Material)>,
    /// Mesh instances of the chosen scene, in the asset's order.
    pub draws: Vec<Draw>,
}

impl Character {
    /// Returns the palette of one of this character's draws.
    pub fn palette_of(&self, draw: &Draw) -> &[PaletteEntry] {
        self.palette.get(draw.palette.start as usize..draw.palette.end as usize).unwrap_or_default()
    }

    /// Returns the morph weights of one of this character's draws.
    pub fn morph_weights_of(&self, draw: &Draw) -> &[f32] {
        self.morph_weights.get(draw.morph_weights.start as usize..draw.morph_weights.end as usize).unwrap_or_default()
    }
}

/// A mesh instance. The palette of an unskinned mesh has a single entry, its node.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    /// Index into [`gaitway_character::asset::AssetParts::instances`].
    pub instance: usize,
    /// Index into [`gaitway_character::asset::AssetParts::meshes`].
    pub mesh: usize,
    /// Whether this is another EXT_mesh_gpu_instancing copy of the draw before it.
    pub is_copy: bool,
    /// False if the file, the clip or the user hides the node or an ancestor.
    pub visible: bool,
    /// Range in [`Character::palette`].
    pub palette: Range<u32>,
    /// Range in [`Character::morph_weights`].
    pub morph_weights: Range<u32>,
    /// The node's transform mirrors, which flips the winding of front faces. Never set for skinned meshes.
    pub mirrored: bool,
    /// Heat map: index of the chosen joint in this draw's palette, `u32::MAX` if it is not there. The surface is coloured
    /// by that joint's weight instead of its material.
    pub heat_joint: Option<u32>,
    /// World-space center, for sorting transparent surfaces.
    pub center: Vec3,
}

/// A light of the file, placed in the world.
#[derive(Debug, Clone, Copy)]
pub struct FrameLight {
    /// Directional, point or spot, with the cone of a spot.
    pub kind: LightKind,
    /// Linear colour times intensity.
    pub color: Vec3,
    /// World space; unused by directional lights.
    pub position: Vec3,
    /// Direction in which the light travels.
    pub direction: Vec3,
    /// 0: unlimited.
    pub range: f32,
}

/// A line segment of constant width on screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Start in world space.
    pub from: Vec3,
    /// End in world space.
    pub to: Vec3,
    /// Linear, straight alpha.
    pub color: Vec4,
    /// In pixels of the render target.
    pub width_pixels: f32,
    /// Drawn over everything in front of it.
    pub on_top: bool,
}

/// A tapered octahedron from head to tail, drawn over the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bone {
    /// Position of the joint in world space.
    pub head: Vec3,
    /// Position of the child joint, or end of the stub at the end of a chain. World space.
    pub tail: Vec3,
    /// Largest radius, metres; the joint at the head is a ball of the same radius. A box is half as thick.
    pub radius: f32,
    /// Linear.
    pub color: Vec4,
    /// The file's number of the joint at the head.
    pub joint: u32,
    /// Belongs to the source of the borrowed clip instead of the model.
    pub of_source: bool,
    /// Drawn. Hidden bones can still be picked.
    pub visible: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            exposure: 1.0,
            tone_map: ToneMap::Neutral,
            environment_radians: 0.0,
            light: LightSetup::Studio,
            key: None,
            background: Background::Studio,
            channel: Channel::Shaded,
            mesh: true,
            wireframe: false,
            boxes: false,
            smooth: false,
            shadow: true,
            grid: None,
            ground_height: 0.0,
            time_secs: 0.0,
        }
    }
}
