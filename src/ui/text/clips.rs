//! The clips panel and the transport.

// Clips
/// Heading of the clip list.
pub const CLIPS_SECTION: &str = "CLIPS";
/// Row of the clip list for no clip. The transport shows it in place of the time.
pub use gaitway_scene::library::REST_POSE;
/// Shown for a model without clips.
pub const NO_CLIPS: &str = "This model has no animations. To borrow one, drop a motion (.bvh, .vrma, .npy, .npz, or an .fbx, .x or .glb without meshes), or use \
    “Borrow motion…” to take another model's clips.";
/// Shown for a model without clips that cannot borrow any.
pub const NO_SKELETON: &str = "This model has no animations and no skeleton, so it can't borrow any. Skin its mesh to a skeleton and export it \
    again.";
/// The same for an .obj.
pub const NO_SKELETON_OF_OBJ: &str = "An .obj has no skeleton by itself, so it can't borrow animations. If it has a .skel and an .attach, open them as well.";
/// Button that opens the awaited model.
pub const BRING: &str = "Choose files…";
/// Stands below the name of a model without a path.
pub const LOCAL: &str = "Opened from this computer";
/// Stands there while the model is awaited.
pub const NOT_OPENED: &str = "Not opened yet";
/// What to do if a link's model couldn't be loaded.
pub const NOT_LOADED: &str =
    "Try the link again later, or drop a copy of the file, under the same name: the rest of the link is applied to it.";
/// What to do while a model is awaited.
pub const BRING_HERE: &str = "Drop the file anywhere, or open it. The rest of the link is kept and applied to it.";
/// Button that empties a search field.
pub const CLEAR_SEARCH: &str = "Clear search";

/// Returns the hint in the search field of a list of `count` clips.
pub fn search_clips(count: usize) -> String {
    format!("Search {count} clips")
}

/// Returns the note shown when the search matches no clip.
pub fn no_clip_found(search: &str) -> String {
    format!("No clip matches “{search}”.")
}

/// Returns the name of the button that closes a model.
pub fn close_model(name: &str) -> String {
    format!("Close {name}")
}

/// Returns the heading above the clips borrowed from a motion.
pub fn from_motion(name: &str) -> String {
    format!("From {name}")
}

// Transport
/// Accessible name of the play button while stopped.
pub const PLAY: &str = "Play";
/// Accessible name of the play button while playing.
pub const PAUSE: &str = "Pause";
/// Tooltip of the play button while stopped, with its key.
pub const PLAY_KEY: &str = "Play (Space)";
/// Tooltip of the play button while playing, with its key.
pub const PAUSE_KEY: &str = "Pause (Space)";
/// Button that steps back one frame, with its key.
pub const PREVIOUS_FRAME: &str = "Previous frame (,)";
/// Button that steps forward one frame, with its key.
pub const NEXT_FRAME: &str = "Next frame (.)";
/// Accessible name of the timeline, a slider in seconds.
pub const TIME: &str = "Time";
/// Accessible name of the timeline handle at the start of the played range.
pub const IN_POINT: &str = "In point";
/// Accessible name of the timeline handle at the end of the played range.
pub const OUT_POINT: &str = "Out point";
/// Button that moves the in point to the playhead, with its key.
pub const SET_IN_POINT: &str = "Set in point (I)";
/// Button that moves the out point to the playhead, with its key.
pub const SET_OUT_POINT: &str = "Set out point (O)";
/// Button that plays the whole clip again.
pub const CLEAR_RANGE: &str = "Clear in and out points";
/// Loop mode: stops at the end.
pub const PLAY_ONCE: &str = "Play once";
/// Loop mode: starts over at the end.
pub const LOOP: &str = "Loop";
/// Loop mode: plays forwards and backwards in turn.
pub const PING_PONG: &str = "Ping-pong";
/// Name of the speed slider; on small screens, tooltip of the speed menu.
pub const SPEED: &str = "Speed";
/// Accessible name of the number field beside the speed slider.
pub const SPEED_VALUE: &str = "Speed value";
/// Legend of the foot-contact tracks: the tint.
pub const FOOT_CONTACT: &str = "contact";
/// Legend of the foot-contact tracks: the bars and their scale.
pub const FOOT_SLIDE: &str = "slide (full height 50 cm/s, line 25 cm/s)";

/// Returns a playback speed as a multiple of normal speed.
pub fn speed(factor: f64) -> String {
    format!("{factor}×")
}

/// Returns the playhead position and the duration of the clip.
pub fn seconds(time_secs: f64, duration_secs: f64) -> String {
    format!("{time_secs:.2} / {duration_secs:.2} s")
}

/// Returns the numbers of the current and the last frame, counted from 0, and their rate.
pub fn frames(frame: f64, last: f64, per_sec: f64) -> String {
    format!("Frame {frame:.0} / {last:.0} at {} fps", (10.0 * per_sec).round() / 10.0)
}

/// Returns the numbers of the current and the last frame, where there is no room for [`frames`].
pub fn frame(frame: f64, last: f64) -> String {
    format!("Frame {frame:.0} / {last:.0}")
}

/// Returns the time and the frame under the pointer.
pub fn time_and_frame(secs: f64, per_sec: f64) -> String {
    format!("{secs:.2} s · frame {:.0}", (secs * per_sec + 1e-4).floor())
}

/// Returns the accessible name of a foot's contact track.
pub fn foot_contacts(joint: &str) -> String {
    format!("{joint}: foot contacts")
}
