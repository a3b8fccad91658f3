//! The view state, everything the user can set, as plain data, and the commands that change it. No UI, GPU or clock.

mod apply;
mod camera;
mod camera_moves;
mod channel;
mod clip_names;
mod clips;
mod command;
mod comparison;
mod edited;
mod framing;
mod hidden;
mod history;
mod lighting;
mod link;
mod loop_frames;
mod map_code;
mod map_edit;
mod maps;
mod names;
mod playhead;
mod problems;
mod stage;
mod take;
mod unknown;
mod variant;
mod view;

pub use apply::{MAX_NAME_CHARS, apply, one_line};
pub use camera::{CameraChoice, OrbitCamera};
pub use channel::Channel;
pub use clip_names::{look_up_clip, resolve_clips, unknown_layers};
pub use clips::{ClipEdit, drop_orphaned_edits};
pub use command::Command;
pub use comparison::{COMPARED_SKINNING, Comparison, compared_rests, comparison, comparison_ratio, pane_aspect, panes};
pub use edited::Edited;
pub use framing::{
    DEFAULT_ASPECT, automatic_camera, camera_eye, frame_all, front_yaw_radians, looks_past, resolve_camera,
    resolved_bounds, sees_all, world_from_file_camera,
};
pub use hidden::{Hidden, joints_with_content, used_materials};
pub use history::History;
pub use lighting::{EnvironmentChoice, KeyLight, LightSetup, Lighting, ToneMap};
pub use link::{Link, MEMBER_SEPARATOR, is_to_bring, with_current_member};
pub use link::{LinkError, from_link, from_object, read_layer, read_pin, to_link, to_object};
pub use loop_frames::LoopFrames;
pub use map_edit::{MapEdit, muted_properties};
pub use maps::{MotionMap, NumberedMap, active_map, active_maps, numbered_for, proposed_map};
pub use names::{title, written_skeleton};
pub use playhead::{active_clip, clip_secs, play_range, unknown_clip, world_from_model};
pub use problems::view_problems;
pub use stage::{SourceOnStage, source_on_stage};
pub use take::{active_take, moment, take_of};
pub use unknown::{NameKind, UnknownName};
pub use variant::active_variant;
pub use view::{
    Background, CameraOptions, CharacterView, ClipChoice, Display, Edits, Embed, Fade, Inspect, PageOptions, Playback,
    Playhead, RetargetEdits, SavedMotion, Selection, Show, Sources, UpAxis, VertexChoice, ViewerState,
};
