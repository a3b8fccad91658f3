//! Texts of controls that tests look for, so that each can change in one place.

// Viewport and layout
pub const VIEWPORT: &str = "Viewport";
pub const CLIPS: &str = "Clips";
pub const INSPECTOR: &str = "Inspector";
pub const HIDE_CLIPS: &str = "Hide clips";
pub const SHOW_CLIPS: &str = "Show clips";
pub const HIDE_INSPECTOR: &str = "Hide inspector";
pub const SHOW_INSPECTOR: &str = "Show inspector";
pub const CLOSE_SHEET: &str = "Close panel";
pub const OPEN_FILES: &str = "Open files";
pub const SAMPLES: &str = "Samples";
pub const FRAME_ALL: &str = "Fit everything in view";
pub const FRAME_ALL_KEY: &str = "Fit everything in view (F)";

// Help
pub const HELP: &str = "Keys (?)";
pub const HELP_TITLE: &str = "Keys and gestures";
pub const CLOSE_HELP: &str = "Close help";
pub const HELP_RING: &str = "Rotate the selected joint, with “Pose manually” on in the Scene tab";
pub const STEP_KEYS: &str = "Comma, period";
pub const STEP_FRAMES: &str = "Previous frame, next frame";

// Messages
pub const ERROR_TITLE: &str = "Something went wrong";
pub const REFUSED_TITLE: &str = "Couldn't borrow the motion";
pub const DISMISS_ERROR: &str = "Dismiss error";
pub const SHOW_REFUSED_ALONE: &str = "Show its skeleton";
pub const MAP_REFUSED_MANUALLY: &str = "Map joints manually";
pub const UNDO: &str = "Undo";
pub const PATH: &str = "Path";
pub const PROMPT_OPEN: &str = "Open";
pub const PROMPT_SAVE: &str = "Save";
pub const CANCEL: &str = "Cancel";

pub fn opening(name: &str) -> String {
    format!("Opening {name}")
}

pub fn couldnt_open(name: &str) -> String {
    format!("Couldn't open {name}")
}

// Clips
pub const OPEN: &str = "Open…";
pub const BORROW_MOTION: &str = "Motion…";
pub const SHARE: &str = "Share…";
pub const CLIPS_SECTION: &str = "CLIPS";
pub const REST_POSE: &str = "Rest pose";
pub const CLEAR_SEARCH: &str = "Clear search";

pub fn search_clips(count: usize) -> String {
    format!("Search {count} clips")
}

pub fn no_clip_found(search: &str) -> String {
    format!("No clip matches “{search}”.")
}

pub fn close_model(name: &str) -> String {
    format!("Close {name}")
}

pub fn from_motion(name: &str) -> String {
    format!("From {name}")
}

// Transport
pub const PLAY: &str = "Play";
pub const PAUSE: &str = "Pause";
pub const PREVIOUS_FRAME: &str = "Previous frame (,)";
pub const NEXT_FRAME: &str = "Next frame (.)";
pub const TIME: &str = "Time";
pub const IN_POINT: &str = "In point";
pub const OUT_POINT: &str = "Out point";
pub const SET_IN_POINT: &str = "Set in point (I)";
pub const SET_OUT_POINT: &str = "Set out point (O)";
pub const CLEAR_RANGE: &str = "Clear in and out points";
pub const PLAY_ONCE: &str = "Play once";
pub const LOOP: &str = "Loop";
pub const PING_PONG: &str = "Ping-pong";
pub const SPEED: &str = "Speed";
pub const SPEED_VALUE: &str = "Speed value";

pub fn speed(factor: f64) -> String {
    format!("{factor}×")
}

pub fn seconds(time_secs: f64, duration_secs: f64) -> String {
    format!("{time_secs:.2} / {duration_secs:.2} s")
}

pub fn frames(frame: f64, count: f64) -> String {
    format!("Frame {frame:.0} / {count:.0}")
}

pub fn foot_contacts(joint: &str) -> String {
    format!("{joint}: foot contacts")
}

// Sliders
pub fn value_of(label: &str) -> String {
    format!("{label} value")
}

// Scene tab
pub const SEARCH_NODES: &str = "Search nodes";
pub const DESELECT_JOINT: &str = "Deselect joint";
pub const RENAME: &str = "Rename";
pub const JOINT_NAME: &str = "Joint name";
pub const POSE_MANUALLY: &str = "Pose manually";
pub const POSE_HINT: &str = "From the rest pose: about X, then Y, then Z. Or drag the rings in the viewport.";
pub const POSE_ANGLES: [&str; 3] = ["Rotation X", "Rotation Y", "Rotation Z"];
pub const RESET_JOINT: &str = "Reset joint";
pub const MATRICES: &str = "Matrices";
pub const VERTEX_PROBE: &str = "Vertex under the pointer";
pub const VERTEX_HINT: &str = "Point at the mesh to see which joints move a vertex. Click to pin it.";
pub const UNPIN_VERTEX: &str = "Unpin";

pub fn no_node_found(search: &str) -> String {
    format!("No node matches “{search}”.")
}

pub fn expand(name: &str) -> String {
    format!("Expand {name}")
}

pub fn collapse(name: &str) -> String {
    format!("Collapse {name}")
}

pub fn reset_all_joints(count: usize) -> String {
    format!("Reset all {count}")
}

pub fn local_transform(parent: &str) -> String {
    format!("Local, in {parent}")
}

pub fn vertex(number: usize) -> String {
    format!("Vertex {number}")
}

pub fn joint_weight(joint: &str, weight: f32) -> String {
    format!("{joint}, weight {weight:.4}")
}

/// A row of the skinning equation.
#[derive(Debug, Clone, Copy)]
pub enum FormulaRow {
    Bound,
    Alone,
    Share,
    Sum,
    Drawn,
}

impl FormulaRow {
    /// What the row shows, and its tooltip.
    pub fn name_and_meaning(self) -> (&'static str, &'static str) {
        match self {
            Self::Bound => ("p", "position in the bind pose"),
            Self::Alone => ("alone", "T · inv(B) · p"),
            Self::Share => ("share", "w · T · inv(B) · p"),
            Self::Sum => ("p'", "sum of the shares"),
            Self::Drawn => ("drawn", "result of the current skinning method"),
        }
    }

    /// The accessible name, which the numbers follow.
    pub fn label(self) -> String {
        let (name, meaning) = self.name_and_meaning();
        format!("{name}, {meaning}:")
    }
}

// Display tab
pub const RIGID: &str = "Rigid";
pub const DUAL_QUATERNION: &str = "Dual quat.";
pub const COMPARE_SKINNING: &str = "Compare all three";
pub const SKELETON: &str = "Skeleton";
pub const SKELETON_BOXES: &str = "Skeleton as spheres and boxes";
pub const JOINT_WEIGHTS: &str = "Weights of the selected joint";
pub const JOINT_WEIGHTS_HINT: &str = "Select a joint in the viewport or in the Scene tab to see its influence.";
pub const SMOOTH_SURFACE: &str = "Smooth surface";
pub const RESET_MORPHS: &str = "Reset to clip";

// View tab
pub const FRONT: &str = "Front";
pub const SIDE: &str = "Side";
pub const TOP: &str = "Top";
pub const FOLLOW: &str = "Follow character";
pub const UP_Z: &str = "Z";
pub const EXPOSURE: &str = "Exposure";
pub const STUDIO: &str = "Studio";
pub const COLOR: &str = "Colour";
pub const NO_BACKGROUND: &str = "None";
pub const SQUARE: &str = "Square";
pub const TRANSPARENT_BACKGROUND: &str = "Transparent background";
pub const SAVE_IMAGE: &str = "Save image (PNG)";
pub const RECORD: &str = "Record one loop (WebM)";

// File tab
pub const FORMAT: &str = "Format";
pub const NODES: &str = "Nodes";
pub const SAVE_REST_POSE: &str = "Save in rest pose";
pub const SAVE_CURRENT_POSE: &str = "Save in current pose";

/// A line of the file report as a screen reader reads it.
pub fn fact(name: &str, value: &str) -> String {
    format!("{name} {value}")
}

// Motion
pub const PICK_IN_VIEWPORT: &str = "Pick in viewport";
pub const STOP_PICKING: &str = "Stop picking";
pub const DONE_PICKING: &str = "Done";
pub const REMATCH: &str = "Re-match";
pub const SWAP_SIDES: &str = "Swap sides";
pub const CLEAR_MAP: &str = "Clear all";
pub const ROOT_HORIZONTAL: &str = "Root motion: horizontal";
pub const ROOT_VERTICAL: &str = "Root motion: vertical";
pub const ROOT_TURN: &str = "Root motion: turn";
pub const EXTRACT_ROOT_MOTION: &str = "Extract root motion";
pub const UNMAPPED_JOINTS: &str = "Unmapped joints";
pub const ROTATION_OFFSET: &str = "Rotation offset";

pub fn rotation_offset_about(axis: &str) -> String {
    format!("{ROTATION_OFFSET} about {axis}")
}

pub fn joints_mapped(count: usize, sources: usize) -> String {
    match count {
        0 => "No joints mapped yet.".to_owned(),
        1 => format!("1 joint mapped ({sources} in the motion)."),
        _ => format!("{count} joints mapped ({sources} in the motion)."),
    }
}
