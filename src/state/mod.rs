//! What a person has set, as plain data, and the one way to change it. Knows no user interface, GPU or clock.

mod apply;
mod camera;
mod command;
mod framing;
mod history;
mod link;
mod map_code;
mod map_edit;
mod maps;
mod names;
mod playhead;
mod stage;
mod view;

pub use apply::apply;
pub use camera::{CameraChoice, OrbitCamera};
pub use command::Command;
pub use framing::{
    frame_all, front_yaw_radians, pane_aspect, panes, resolve_camera, resolved_bounds, split_ratio,
    world_from_file_camera,
};
pub use history::History;
pub use link::{LinkError, from_link, from_object, to_link, to_object};
pub use map_edit::{MapEdit, muted_properties};
pub use maps::{MapProblem, MotionMap, NumberedMap, active_map, active_maps, proposed, reconciled_maps};
pub use names::{title, written_skeleton};
pub use playhead::{
    PoseSampler, active_clip, choice_of_clip, clip_secs, degrees_by_hand, play_range, rotation_by_hand,
    world_from_model,
};
pub use stage::{SourceOnStage, source_on_stage};
pub use view::{
    Background, CameraOptions, ClipChoice, Display, Edits, Fade, Inspect, PageOptions, Playback, Playhead,
    RetargetEdits, Selection, Show, Sources, UpAxis, VertexChoice, ViewerState,
};
