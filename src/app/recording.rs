//! What a recording remembers from its first frame to its last.

use gaitway_scene::library::ModelId;
use gaitway_scene::state::LoopFrames;

use crate::ui::RecordingFormat;

/// One loop of the clip, being recorded.
pub(super) struct Recording {
    pub frames: LoopFrames,
    pub model: ModelId,
    pub size: [u32; 2],
    pub transparent: bool,
    pub format: RecordingFormat,
    /// Says if the size differs from the requested one.
    pub remark: Option<String>,
}
