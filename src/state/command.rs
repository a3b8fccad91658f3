//! Everything the user can do to the view. Menus, keys, links, scripts and tests all send these commands.

use super::{Background, CameraChoice, ClipChoice, MapEdit, UpAxis, ViewerState};
use crate::anim::{LoopMode, TimeRange};
use crate::mesh::SkinningMode;
use crate::retarget::{Feet, JointMap, RootOptions, Unmapped};

#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Replaces the whole state (a link, the script interface).
    Replace(Box<ViewerState>),
    SetScene(Option<usize>),
    SetClip(ClipChoice),
    SetPlaying(bool),
    TogglePlaying,
    /// Moves the playhead, in clip seconds.
    Seek(f64),
    /// Advances time by seconds of the clock; playback speed is applied here.
    Advance(f64),
    /// Steps forwards (+1) or backwards (−1) by frames of `1 / frames_per_sec`, and pauses.
    StepFrames(i32),
    SetSpeed(f64),
    SetLoopMode(LoopMode),
    SetRange(Option<TimeRange>),
    SetSkinning(SkinningMode),
    SetMorph {
        index: usize,
        weight: Option<f32>,
    },
    ClearMorphs,
    /// Poses a joint manually (index in the file; Euler angles in degrees from its rest pose); `None` returns it to the clip.
    SetPose {
        joint: usize,
        degrees: Option<[f32; 3]>,
    },
    ClearPose,
    /// Renames a joint (index in the file); an empty name restores the file's.
    RenameJoint {
        joint: usize,
        name: String,
    },
    SetShow(super::Show),
    SetInspect(super::Inspect),
    SelectJoint(Option<usize>),
    SelectVertex(Option<super::VertexChoice>),
    SetCamera(CameraChoice),
    /// Orbits the target.
    Orbit {
        yaw_radians: f32,
        pitch_radians: f32,
    },
    /// Moves the target parallel to the viewport, in fractions of its height.
    Pan {
        right: f32,
        up: f32,
    },
    /// Multiplies the distance. The point at this offset from the viewport's centre, in fractions of its height, stays where
    /// it is; with a running turntable, the centre does.
    Zoom {
        factor: f32,
        right: f32,
        up: f32,
    },
    /// Frames everything, keeping the direction.
    FrameAll,
    SetFov(f32),
    SetFollow(bool),
    /// Degrees per second; 0 stops the turntable.
    SetTurntable(f32),
    SetUp(UpAxis),
    SetExposure(f32),
    SetEnvironment(f32),
    SetBackground(Background),
    SetEmbed(bool),
    /// Replaces the joint map of a motion in the library, and of all that share its skeleton; `None` restores the proposed map.
    SetMap {
        motion: usize,
        map: Option<Box<JointMap>>,
    },
    /// Maps a joint of the model to a joint of a motion, or to none; both by index in their files.
    SetSource {
        motion: usize,
        target: usize,
        source: Option<usize>,
    },
    /// Edits the map of a motion in another way.
    EditMap {
        motion: usize,
        edit: MapEdit,
    },
    SetUnmapped(Option<Unmapped>),
    SetRoot(Option<RootOptions>),
    SetFeet(Option<Feet>),
    /// Reconciles the maps with the loaded files: names become joint numbers, missing maps are proposed, others are dropped.
    ReconcileMaps,
}
