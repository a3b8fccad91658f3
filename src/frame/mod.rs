//! One picture, ready to draw: `evaluate` turns what is loaded and what is set into plain numbers. No clock, no chance:
//! the same library and state give the same frame.

mod evaluate;
mod formula;
mod overlays;
mod pick;
mod pick_vertex;
mod pose_document;
mod view;

use std::ops::Range;

use glam::{Affine3A, Mat4, Vec3, Vec4};

use crate::asset::LightKind;
use crate::library::ModelId;
use crate::mesh::{Bounds, PaletteEntry, SkinningMode};
use crate::state::Background;

pub use evaluate::{evaluate, travelled};
pub use formula::{FormulaPart, JointMatrices, VertexFormula, joint_matrices, vertex_formula};
pub use pick::{PickedJoint, pick_joint};
pub use pick_vertex::pick_vertex;
pub use pose_document::pose_document;

/// What the renderer reads. Reused from frame to frame, so that nothing is allocated once it has grown.
#[derive(Debug, Default)]
pub struct Frame {
    pub view: View,
    pub look: Look,
    /// How the picture is divided: columns and rows of panes of one size, all seen by the same camera.
    pub panes: [u32; 2],
    /// The shown model first: once, or once for each pane. Then the source, if it is on the stage.
    pub characters: Vec<Character>,
    /// The file's own lights in world space; empty: the studio's key light shines.
    pub lights: Vec<FrameLight>,
    /// Overlay lines (skeleton without shapes, bounds, axes), drawn with a width in pixels.
    pub lines: Vec<Line>,
    /// Bones and joints of the skeletons, also where they are not drawn: a click finds them.
    pub bones: Vec<Bone>,
    /// World-space box of all that can be seen over the clip: fits the shadow and the grid.
    pub bounds: Bounds,
    scratch: evaluate::Scratch,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct View {
    pub view_from_world: Mat4,
    /// Depth from 0 (near) to 1 (far), Y up, as WebGPU's clip space.
    pub projection_from_view: Mat4,
    pub eye: Vec3,
}

#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Factor on linear colours: 2^stops.
    pub exposure: f32,
    pub environment_radians: f32,
    pub background: Background,
    pub mesh: bool,
    pub wireframe: bool,
    pub skeleton: bool,
    /// Of spheres and boxes.
    pub boxes: bool,
    /// Meshes without normals are smooth instead of flat.
    pub smooth: bool,
    pub shadow: bool,
    pub grid: Option<Grid>,
    /// Height of the plane that shadows fall on, where the character stands.
    pub ground_height: f32,
}

/// A grid on the ground plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    pub height: f32,
    /// Distance of thin lines, a power of ten in metres; every tenth is thick.
    pub spacing: f32,
    /// Where it has faded out, from `center`.
    pub radius: f32,
    pub center: Vec3,
}

/// One model in one pose.
#[derive(Debug, Default)]
pub struct Character {
    pub model: ModelId,
    pub skinning: SkinningMode,
    /// The one pane it is in, row by row; none: in all of them.
    pub pane: Option<u32>,
    pub world_from_joint: Vec<Affine3A>,
    /// Palettes of all draws, one after the other, in world space.
    pub palette: Vec<PaletteEntry>,
    pub morph_weights: Vec<f32>,
    pub draws: Vec<Draw>,
}

/// One mesh instance. A mesh without skin has a palette of one entry: its node.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    /// Index into [`crate::asset::Asset::instances`].
    pub instance: usize,
    pub mesh: usize,
    /// Into [`Character::palette`].
    pub palette: Range<u32>,
    /// Into [`Character::morph_weights`].
    pub morph_weights: Range<u32>,
    /// The node's transform mirrors: front faces are wound the other way. Never for skinned meshes.
    pub mirrored: bool,
    /// With the heat-map on: the chosen joint's position in this draw's palette, `u32::MAX` when it is not in it. The
    /// surface is coloured by that joint's weight instead of its material.
    pub heat_joint: Option<u32>,
    /// World-space middle, for sorting transparent parts.
    pub center: Vec3,
}

#[derive(Debug, Clone, Copy)]
pub struct FrameLight {
    pub kind: LightKind,
    /// Linear colour times intensity.
    pub color: Vec3,
    pub position: Vec3,
    /// The way the light travels.
    pub direction: Vec3,
    /// 0: unlimited.
    pub range: f32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    pub from: Vec3,
    pub to: Vec3,
    /// Linear, straight alpha.
    pub color: Vec4,
    pub width_pixels: f32,
    /// Drawn through everything in front of it.
    pub on_top: bool,
}

/// A tapered octahedron from head to tail, drawn through the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bone {
    pub head: Vec3,
    pub tail: Vec3,
    /// Radius at the widest, metres; a joint ball of the same radius is drawn at the head. A box is half as thick.
    pub radius: f32,
    /// Linear.
    pub color: Vec4,
    /// The joint at the head, as its file numbers it.
    pub joint: u32,
    /// It is the source's, not the model's.
    pub of_source: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            exposure: 1.0,
            environment_radians: 0.0,
            background: Background::Studio,
            mesh: true,
            wireframe: false,
            skeleton: false,
            boxes: false,
            smooth: false,
            shadow: true,
            grid: None,
            ground_height: 0.0,
        }
    }
}
