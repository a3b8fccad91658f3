//! Everything the user can do to the view. Menus, keys, links, scripts and tests all send these commands.

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{Contacts, Feet, JointMap, Pin, RootOptions, Unmapped};

use super::{
    Background, CameraChoice, Channel, ClipChoice, ClipEdit, Embed, EnvironmentChoice, Hidden, KeyLight, MapEdit,
    MotionMap, ToneMap, UpAxis, ViewerState,
};
use crate::library::{ClipId, LayeredClip, LookTarget, MotionId};

/// A change to the view, applied by [`super::apply()`].
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Replaces the whole state (a link, the script interface).
    Replace(Box<ViewerState>),
    /// Shows a scene of the file, by index; `None` shows the default one.
    SetScene(Option<usize>),
    /// Starts a clip from its beginning and clears the range. While playing, crossfades if either clip asks for it.
    SetClip(ClipChoice),
    /// Plays or pauses. A clip that plays once and has ended restarts.
    SetPlaying(bool),
    /// Plays if paused, otherwise pauses.
    TogglePlaying,
    /// Moves the playhead, in clip seconds.
    Seek(f64),
    /// Advances time by seconds of the clock; playback speed is applied here.
    Advance(f64),
    /// Steps forwards (+1) or backwards (−1) by frames of `1 / frames_per_sec`, and pauses.
    StepFrames(i32),
    /// Sets the playback speed, a factor within [`Playback::SPEED`](super::Playback::SPEED).
    SetSpeed(f64),
    /// Sets what happens at the end of the range, keeping the current pose.
    SetLoopMode(LoopMode),
    /// Sets the in and out points, in clip seconds; `None` plays the whole clip.
    SetRange(Option<TimeRange>),
    /// Sets the skinning method.
    SetSkinning(SkinningMode),
    /// Overrides a morph weight.
    SetMorph {
        /// Index into `Pose::morph_weights`.
        index: usize,
        /// Clamped to [`Edits::MORPH_WEIGHT`](super::Edits::MORPH_WEIGHT); `None` returns it to the clip.
        weight: Option<f32>,
    },
    /// Returns all morph weights to the clip.
    ClearMorphs,
    /// Overrides the weight of an expression.
    SetExpression {
        /// [`Expression::name`](gaitway_character::avatar::Expression::name).
        name: String,
        /// Clamped to [`Edits::EXPRESSION_WEIGHT`](super::Edits::EXPRESSION_WEIGHT); `None` returns it to the clip.
        weight: Option<f32>,
    },
    /// Returns all expressions to the clip.
    ClearExpressions,
    /// Sets the target of an avatar's gaze.
    SetLookAt(LookTarget),
    /// Turns an avatar's spring bones on or off.
    SetSprings(bool),
    /// Poses a joint manually (index in the file; Euler angles in degrees from its rest pose); `None` returns it to the clip.
    SetPose {
        /// Index in the file.
        joint: usize,
        /// See [`crate::library::manual_rotation`].
        degrees: Option<[f32; 3]>,
    },
    /// Returns all joints to the clip.
    ClearPose,
    /// Pins a joint, unless the model can't pin it this way; `None` returns it to the clip.
    SetPin {
        /// Index in the file.
        joint: usize,
        /// Replaces the pin it had.
        pin: Option<Pin>,
    },
    /// Renames a joint (index in the file); an empty name restores the file's.
    RenameJoint {
        /// Index in the file.
        joint: usize,
        /// Control characters are removed, and everything after 80 characters.
        name: String,
    },
    /// Edits a clip.
    EditClip {
        /// One of the model's.
        clip: ClipId,
        /// The edit.
        edit: ClipEdit,
    },
    /// Sets the layers over the active clip, the lowest first. Numbers out of range are clamped.
    SetLayers(Vec<LayeredClip>),
    /// Sets what is drawn.
    SetShow(super::Show),
    /// Sets what surfaces show.
    SetChannel(Channel),
    /// Sets what the viewport explains about the model.
    SetInspect(super::Inspect),
    /// Selects a joint by index in the file; `None` deselects.
    SelectJoint(Option<usize>),
    /// Selects the vertex whose skinning is explained; `None` deselects.
    SelectVertex(Option<super::VertexChoice>),
    /// Chooses the camera.
    SetCamera(CameraChoice),
    /// Orbits the target.
    Orbit {
        /// Positive moves the camera to its right.
        yaw_radians: f32,
        /// Positive moves the camera up, to just short of the pole.
        pitch_radians: f32,
    },
    /// Moves the target parallel to the viewport, in fractions of its height.
    Pan {
        /// Positive moves the target to the camera's right.
        right: f32,
        /// Positive moves the target up.
        up: f32,
    },
    /// Multiplies the distance. The point at this offset from the viewport's centre, in fractions of its height, stays where
    /// it is; with a running turntable, the centre does.
    Zoom {
        /// Below 1 zooms in.
        factor: f32,
        /// Positive is right of the centre.
        right: f32,
        /// Positive is above the centre.
        up: f32,
    },
    /// Frames everything, keeping the direction.
    FrameAll,
    /// Sets the vertical field of view, within [`CameraOptions::FOV_DEGREES`](super::CameraOptions::FOV_DEGREES).
    SetFov(f32),
    /// Sets whether the camera travels with the character's root.
    SetFollow(bool),
    /// Degrees per second; 0 stops the turntable.
    SetTurntable(f32),
    /// Shows a material variant by name; `None` shows the file's own materials.
    SetVariant(Option<String>),
    /// Sets which nodes and materials are hidden.
    SetHidden(Hidden),
    /// Sets which axis of the file points up.
    SetUp(UpAxis),
    /// Sets the exposure in stops, within [`Display::EXPOSURE`](super::Display::EXPOSURE).
    SetExposure(f32),
    /// Sets the tone mapping.
    SetToneMap(ToneMap),
    /// Rotates the lighting about the vertical axis, in degrees.
    SetEnvironment(f32),
    /// Sets the light from all around.
    SetLight(EnvironmentChoice),
    /// Sets the key light; `None` leaves it to the environment. Values out of range are clamped.
    SetKeyLight(Option<KeyLight>),
    /// Sets what is behind the scene.
    SetBackground(Background),
    /// Sets how much of the page is shown.
    SetEmbed(Embed),
    /// Replaces the joint map of a motion in the library, and of all that share its skeleton; `None` restores the proposed map.
    SetMap {
        /// One of the library's.
        motion: MotionId,
        /// In joint numbers of the two files.
        map: Option<Box<JointMap>>,
    },
    /// Maps a joint of the model to a joint of a motion, or to none; both by index in their files.
    SetSource {
        /// One of the library's.
        motion: MotionId,
        /// Joint of the model.
        target: usize,
        /// Joint of the motion; `None` leaves the target without a source.
        source: Option<usize>,
    },
    /// Edits the map of a motion in another way.
    EditMap {
        /// One of the library's.
        motion: MotionId,
        /// The edit.
        edit: MapEdit,
    },
    /// Overrides what joints without a source do; `None` leaves it to each map.
    SetUnmapped(Option<Unmapped>),
    /// Overrides the root options; `None` leaves them to each map.
    SetRoot(Option<RootOptions>),
    /// Overrides what feet do; `None` leaves it to each map.
    SetFeet(Option<Feet>),
    /// Overrides what contacts do; `None` leaves it to each map.
    SetContacts(Option<Contacts>),
    /// Replaces the maps by what is left of them once they are reconciled with the loaded files; not an edit of the user's.
    ReconcileMaps(Vec<MotionMap>),
}
