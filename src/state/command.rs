//! Everything a person can do to the view. Menu, keys, links, scripts and tests all use this list.

use super::{Background, CameraChoice, ClipChoice, MapEdit, UpAxis, ViewerState};
use crate::anim::{LoopMode, TimeRange};
use crate::mesh::SkinningMode;
use crate::retarget::{Feet, JointMap, RootOptions, Unmapped};

#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Takes over a whole state (a link, undo, the script interface).
    Replace(Box<ViewerState>),
    SetScene(Option<usize>),
    SetClip(ClipChoice),
    SetPlaying(bool),
    TogglePlaying,
    /// Puts the playhead somewhere, in clip seconds.
    Seek(f64),
    /// Time went by while playing, in seconds of the clock; speed is applied here.
    Advance(f64),
    /// To the next (+1) or previous (−1) frame of `1 / frames_per_sec`; pauses.
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
    /// Turns a joint by hand (its number in the file; Euler angles in degrees from its rest), or lets the clip have it.
    SetPose {
        joint: usize,
        degrees: Option<[f32; 3]>,
    },
    ClearPose,
    /// Calls a joint (its number in the file) something else; an empty name: as the file does.
    RenameJoint {
        joint: usize,
        name: String,
    },
    SetShow(super::Show),
    SetInspect(super::Inspect),
    SelectJoint(Option<usize>),
    SelectVertex(Option<super::VertexChoice>),
    SetCamera(CameraChoice),
    /// Turns about the target, radians.
    Orbit {
        yaw_radians: f32,
        pitch_radians: f32,
    },
    /// Moves the target in the picture plane, in fractions of the picture's height.
    Pan {
        right: f32,
        up: f32,
    },
    /// Multiplies the distance. What is that far right of and above the picture's middle, in fractions of its height, stays
    /// where it is; while the camera turns by itself, its middle does.
    Zoom {
        factor: f32,
        right: f32,
        up: f32,
    },
    /// Back to automatic framing, keeping the direction.
    FrameAll,
    SetFov(f32),
    SetFollow(bool),
    /// Degrees per second; 0: the camera stands.
    SetTurntable(f32),
    SetUp(UpAxis),
    SetExposure(f32),
    SetEnvironment(f32),
    SetBackground(Background),
    SetEmbed(bool),
    /// Replaces the map for a motion of the library (and all that share its skeleton) by one in joint numbers; none:
    /// what is proposed.
    SetMap {
        motion: usize,
        map: Option<Box<JointMap>>,
    },
    /// Lets one joint of the model follow another joint of a motion, or none; both as their files number them.
    SetSource {
        motion: usize,
        target: usize,
        source: Option<usize>,
    },
    /// Changes the map for a motion in another way.
    EditMap {
        motion: usize,
        edit: MapEdit,
    },
    SetUnmapped(Option<Unmapped>),
    SetRoot(Option<RootOptions>),
    SetFeet(Option<Feet>),
    /// Converts maps that fit the loaded files to numbers, proposes missing ones, drops the others.
    ReconcileMaps,
}
