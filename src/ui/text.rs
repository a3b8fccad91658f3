//! Texts of controls that tests look for, so that each can change in one place.

use crate::retarget::RestChoice;

// Viewport and layout
/// Accessible name of the 3D view.
pub const VIEWPORT: &str = "Viewport";
/// Narrow screens: button that opens the clips sheet. Also the number of clips in the Info tab.
pub const CLIPS: &str = "Clips";
/// Narrow screens: button that opens the inspector sheet.
pub const INSPECTOR: &str = "Inspector";
/// Wide screens: button that closes the clips panel.
pub const HIDE_CLIPS: &str = "Hide clips";
/// Wide screens: button that opens the clips panel.
pub const SHOW_CLIPS: &str = "Show clips";
/// Wide screens: button that closes the inspector.
pub const HIDE_INSPECTOR: &str = "Hide inspector";
/// Wide screens: button that opens the inspector.
pub const SHOW_INSPECTOR: &str = "Show inspector";
/// Close button of a sheet.
pub const CLOSE_SHEET: &str = "Close panel";
/// Fitting everything into the viewport, as the help describes it.
pub const FRAME_ALL: &str = "Fit everything in view";
/// Button that fits everything into the viewport, with its key.
pub const FRAME_ALL_KEY: &str = "Fit everything in view (F)";

// Header and menu
/// The program's name.
pub const NAME: &str = "Gaitway";
/// What the program does.
pub const TAGLINE: &str = "Watch a 3D character move, and give it the motion of another.";
/// Button that opens files.
pub const OPEN: &str = "Open…";
/// Button that borrows motion from another file, or loads a joint map.
pub const BORROW_MOTION: &str = "Borrow motion…";
/// Button that opens the gallery of samples.
pub const SAMPLES: &str = "Samples";
/// Menu of what can be saved.
pub const EXPORT: &str = "Export";
/// Entry of the export menu that shows the settings of images and videos.
pub const PICTURE_SETTINGS: &str = "Image and video settings…";
/// Button that shares a link to the view.
pub const SHARE: &str = "Share…";
/// Menu of everything else.
pub const MENU: &str = "Menu";
/// Entry of the menu that enters and leaves full screen.
pub const FULL_SCREEN: &str = "Full screen";
/// The choice of the panels' theme.
pub const THEME: &str = "Theme";
/// Entry of the menu that opens the help, with its key.
pub const HELP: &str = "Keys and gestures (?)";
/// Entry of the menu that opens the box about the program.
pub const ABOUT: &str = "About Gaitway";
/// The version, in that box.
pub const VERSION: &str = concat!("Version ", env!("CARGO_PKG_VERSION"));
/// The licence, in that box.
pub const LICENCE: &str = "Free and open source: MIT or Apache 2.0, at your option. Your files stay on your computer.";
/// Link in that box.
pub const DOCUMENTATION: &str = "Documentation";
/// Link in that box.
pub const SOURCE_CODE: &str = "Source code";
/// Button that closes that box.
pub const CLOSE_ABOUT: &str = "Close";
/// Button that undoes the last step, whatever it was, with its key.
pub const UNDO_STEP: &str = "Undo last step (Ctrl+Z)";
/// Button that redoes the last undone step, with its key.
pub const REDO_STEP: &str = "Redo step (Ctrl+Y)";
/// Button of an embedded view.
pub const OPEN_PAGE: &str = "Open in Gaitway";

/// Returns the name of the button that borrows the clips of an open model.
pub fn borrow_from(model: &str) -> String {
    format!("Borrow the motion of {model}")
}

// Help
/// Title of the help.
pub const HELP_TITLE: &str = "Keys and gestures";
/// Close button of the help.
pub const CLOSE_HELP: &str = "Close help";
/// What dragging a ring of the rotation gizmo does, in the help.
pub const HELP_RING: &str = "Rotate the selected joint, with “Pose manually” on in the Scene tab";
/// Keys that step by a frame, spelled out for the help.
pub const STEP_KEYS: &str = "Comma, period";
/// What [`STEP_KEYS`] do, in the help.
pub const STEP_FRAMES: &str = "Previous frame, next frame";

// Messages
/// Title of an error without a more specific one.
pub const ERROR_TITLE: &str = "Something went wrong";
/// Title of the error for refused motions.
pub const REFUSED_TITLE: &str = "Couldn't borrow the motion";
/// Close button of an error.
pub const DISMISS_ERROR: &str = "Dismiss error";
/// Button on a refused motion: shows its skeleton instead of the model.
pub const SHOW_REFUSED_ALONE: &str = "Show its skeleton";
/// Button on a refused motion: borrows from it with an empty joint map.
pub const MAP_REFUSED_MANUALLY: &str = "Map joints manually";
/// Button on a toast that reports an undoable step.
pub const UNDO: &str = "Undo";
/// Button that closes a list, or ends a recording.
pub const CANCEL: &str = "Cancel";

/// Returns the label of the progress bar while a file loads.
pub fn opening(name: &str) -> String {
    format!("Opening {name}")
}

/// Returns the title of the error for a file that failed to open.
pub fn couldnt_open(name: &str) -> String {
    format!("Couldn't open {name}")
}

/// Returns what stands on the stage in place of a model that the user has yet to supply.
pub fn waiting_for(name: &str) -> String {
    format!("Waiting for {name}")
}

/// Returns what stands on the stage in place of a model that couldn't be loaded.
pub fn couldnt_load(name: &str) -> String {
    format!("Couldn't load {name}")
}

// Clips
/// Heading of the clip list.
pub const CLIPS_SECTION: &str = "CLIPS";
/// Row of the clip list for no clip. The transport shows it in place of the time.
pub const REST_POSE: &str = "Rest pose";
/// Shown for a model without clips.
pub const NO_CLIPS: &str = "This model has no animations. To borrow one, drop a motion (.bvh, .vrma, or an .fbx, .x or .glb without meshes), or use \
    “Borrow motion…” to take another model's clips.";
/// Shown for a model without clips that cannot borrow any.
pub const NO_SKELETON: &str = "This model has no animations and no skeleton, so it can't borrow any. Skin its mesh to a skeleton and export it \
    again; for an .obj of the exercise, open its .skel and .attach as well.";
/// Button that opens the awaited model.
pub const BRING: &str = "Choose files…";
/// What to do if a link's model couldn't be loaded.
pub const NOT_LOADED: &str =
    "Try the link again later, or drop a copy of the file: the rest of the link is applied to it.";
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

// Avatar
/// Switch for spring bones.
pub const SPRINGS: &str = "Spring bones";
/// Accessible name and label of the choice of where the eyes look.
pub const EYES: &str = "Eyes look";
/// Choice: wherever the clip turns the eyes.
pub const LOOK_OFF: &str = "As animated";
/// Choice: the eyes look into the camera.
pub const LOOK_AT_CAMERA: &str = "At the camera";
/// Choice: the eyes look at a point.
pub const LOOK_AT_POINT: &str = "At a point";
/// Button that returns all expressions to the clip.
pub const RESET_EXPRESSIONS: &str = "Reset expressions";

/// Returns the name of a mesh's first-person flag in the Info tab.
pub fn first_person(mesh: &str) -> String {
    format!("First person: {mesh}")
}

/// Writes a key of VRM's metadata as words: `commercialUsage` becomes “Commercial usage”. Text with spaces, and URLs, stay.
pub fn words(key: &str) -> String {
    if !key.bytes().all(|byte| byte.is_ascii_alphabetic()) {
        return key.to_owned();
    }
    let mut words = String::new();
    let mut before = ' ';
    for letter in key.chars() {
        if letter.is_uppercase() && before.is_lowercase() {
            words.push(' ');
        }
        match words.is_empty() {
            true => words.push(letter.to_ascii_uppercase()),
            false => words.push(letter.to_ascii_lowercase()),
        }
        before = letter;
    }
    // VRM 0.x misspells it.
    words.replace("ussage", "usage")
}

// Transport
/// Accessible name of the play button while stopped.
pub const PLAY: &str = "Play";
/// Accessible name of the play button while playing.
pub const PAUSE: &str = "Pause";
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
/// Name of the speed slider; on narrow screens, tooltip of the speed menu.
pub const SPEED: &str = "Speed";
/// Accessible name of the number field beside the speed slider.
pub const SPEED_VALUE: &str = "Speed value";

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

/// Returns the time and the frame under the pointer.
pub fn time_and_frame(secs: f64, per_sec: f64) -> String {
    format!("{secs:.2} s · frame {:.0}", (secs * per_sec + 1e-4).floor())
}

/// Returns the accessible name of a foot's contact track.
pub fn foot_contacts(joint: &str) -> String {
    format!("{joint}: foot contacts")
}

// Undo and redo
/// Button that undoes an edit of the map, with its key.
pub const UNDO_KEY: &str = "Undo (Ctrl+Z)";
/// Button that redoes an edit of the map, with its key.
pub const REDO_KEY: &str = "Redo (Ctrl+Y)";

// Sliders and choices
/// Returns the accessible name of an option in the choice of `about`.
pub fn option_of(about: &str, option: &str) -> String {
    format!("{about}: {option}")
}

/// Returns an option or a heading with the number of things it stands for.
pub fn counted(what: &str, count: usize) -> String {
    format!("{what} ({count})")
}

/// Returns the accessible name of the number field beside the slider `label`.
pub fn value_of(label: &str) -> String {
    format!("{label} value")
}

// Scene tab
/// Hint in the search field of the node tree.
pub const SEARCH_NODES: &str = "Search nodes";
/// Card of a joint whose mesh or light is not shown.
pub const NODE_HIDDEN: &str = "Not shown: hidden by the file or the clip, or part of another scene.";
/// Close button of the selected joint's card.
pub const DESELECT_JOINT: &str = "Deselect joint";
/// Button that starts renaming the selected joint.
pub const RENAME: &str = "Rename";
/// Accessible name of the field for the joint's new name.
pub const JOINT_NAME: &str = "Joint name";
/// Switch for the pose sliders and the rotation gizmo.
pub const POSE_MANUALLY: &str = "Pose manually";
/// How the three angles combine.
pub const POSE_HINT: &str = "From the rest pose: about X, then Y, then Z. Or drag the rings in the viewport.";
/// The pose sliders, in degrees. They apply in this order.
pub const POSE_ANGLES: [&str; 3] = ["Rotation X", "Rotation Y", "Rotation Z"];
/// Button that returns the selected joint to the clip.
pub const RESET_JOINT: &str = "Reset joint";
/// Switch between the joint's transforms and its skinning matrices.
pub const MATRICES: &str = "Matrices";
/// Switch for the skinning equation of a vertex.
pub const VERTEX_PROBE: &str = "Vertex under the pointer";
/// Shown while the probe is on and no vertex has been found.
pub const VERTEX_HINT: &str = "Point at the mesh to see which joints move a vertex. Click to pin it.";
/// Button that unpins the vertex, so that the probe follows the pointer again.
pub const UNPIN_VERTEX: &str = "Unpin";

/// Returns the note shown when the search matches no node.
pub fn no_node_found(search: &str) -> String {
    format!("No node matches “{search}”.")
}

/// Returns the name of a collapsed tree row's triangle.
pub fn expand(name: &str) -> String {
    format!("Expand {name}")
}

/// Returns the name of an expanded tree row's triangle.
pub fn collapse(name: &str) -> String {
    format!("Collapse {name}")
}

/// Returns the label of the button that returns all `count` manually posed joints to the clip.
pub fn reset_all_joints(count: usize) -> String {
    format!("Reset all {count}")
}

/// Returns the heading of a joint's transform relative to its parent; a root has none.
pub fn local_transform(parent: Option<&str>) -> String {
    parent.map_or_else(|| "Local, no parent".to_owned(), |parent| format!("Local, in {parent}"))
}

/// Returns the title of a vertex; `number` is the one in the file.
pub fn vertex(number: usize) -> String {
    format!("Vertex {number}")
}

/// Returns the accessible name of a joint's row in the skinning equation.
pub fn joint_weight(joint: &str, weight: f32) -> String {
    format!("{joint}, weight {weight:.4}")
}

/// A row of the skinning equation.
#[derive(Debug, Clone, Copy)]
pub enum FormulaRow {
    /// `p`: the morphed bind position, in mesh space.
    Bound,
    /// Where one joint alone would move the vertex, in world space.
    Alone,
    /// `Alone` times the joint's weight, `w`.
    Share,
    /// `p'`: the result of linear skinning, in world space.
    Sum,
    /// The vertex as drawn, in world space. Shown unless the skinning method is linear.
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

/// Row of a joint's transform: the translation.
pub const POSITION: &str = "Position";
/// Row of a joint's transform: the scale.
pub const SCALE: &str = "Scale";
/// A joint's inverse bind matrix.
pub const INVERSE_BIND: &str = "inv(B)";
/// A joint's world matrix.
pub const WORLD_MATRIX: &str = "T";
/// The product of the two, by which a joint moves the mesh.
pub const SKINNING_MATRIX: &str = "T · inv(B)";

// Display tab
/// Section with the material variants of the file.
pub const VARIANTS: &str = "MATERIAL VARIANT";
/// Row for the file's own materials.
pub const NO_VARIANT: &str = "Default materials";
/// Skinning method: each vertex follows its strongest joint.
pub const RIGID: &str = "Rigid";
/// Skinning method: dual quaternions, abbreviated to fit.
pub const DUAL_QUATERNION: &str = "Dual quat.";
/// Switch that shows the three skinning methods side by side.
pub const COMPARE_SKINNING: &str = "Compare all three";
/// In the Motion tab.
pub const COMPARE_RESTS: &str = "Compare rest poses";
/// Switch for the skeleton.
pub const SKELETON: &str = "Skeleton";
/// Switch that replaces the octahedral bones; turning it on also shows the skeleton.
pub const SKELETON_BOXES: &str = "Skeleton as spheres and boxes";
/// Switch that adds bones without influence on a mesh; turning it on also shows the skeleton.
pub const CONTROL_BONES: &str = "Control bones";
/// Switch that colours the mesh by the selected joint's influence.
pub const JOINT_WEIGHTS: &str = "Weights of the selected joint";
/// Shown while the weights are on and no joint is selected.
pub const JOINT_WEIGHTS_HINT: &str = "Select a joint in the viewport or in the Scene tab to see its influence.";
/// Below the scale of the weights, in the viewport.
pub const WEIGHT_LEGEND: &str = "weight (grey: none)";
/// Switch that computes normals for meshes without any.
pub const SMOOTH_SURFACE: &str = "Smooth surface";
/// Button that undoes all edits of the morph sliders.
pub const RESET_MORPHS: &str = "Reset to clip";

// Camera tab
/// Button that looks at the model's front.
pub const FRONT: &str = "Front";
/// Button that looks at the model from its left.
pub const SIDE: &str = "Side";
/// Button that looks down on the model.
pub const TOP: &str = "Top";
/// Switch that moves the camera along with the character.
pub const FOLLOW: &str = "Follow character";
/// The Z axis, in the choice of the file's up axis.
pub const UP_Z: &str = "Z";
/// Exposure slider, in stops.
pub const EXPOSURE: &str = "Exposure";
/// The choice of tone mapping.
pub const TONE_MAP: &str = "Tone mapping";
/// Khronos PBR Neutral, in the choice of tone mapping.
pub const TONE_NEUTRAL: &str = "Neutral";
/// ACES, in the choice of tone mapping.
pub const TONE_ACES: &str = "ACES";
/// AgX, in the choice of tone mapping.
pub const TONE_AGX: &str = "AgX";
/// No tone mapping.
pub const NO_TONE_MAP: &str = "Off";
/// The choice of light from all around.
pub const LIGHT: &str = "Light";
/// A tent of large boxes, in the choice of light.
pub const SOFT_LIGHT: &str = "Soft";
/// A small strong lamp, in the choice of light.
pub const HARD_LIGHT: &str = "Hard";
/// Sky and sun, in the choice of light.
pub const OUTDOOR_LIGHT: &str = "Outdoor";
/// The same from all directions, in the choice of light.
pub const WHITE_LIGHT: &str = "White";
/// Switch that replaces the key light.
pub const OWN_KEY_LIGHT: &str = "Custom key light";
/// Slider of the custom key light.
pub const KEY_STRENGTH: &str = "Key light strength";
/// Slider of the custom key light.
pub const KEY_AZIMUTH: &str = "Key light azimuth";
/// Slider of the custom key light.
pub const KEY_ELEVATION: &str = "Key light elevation";
/// The light, in the choice of background.
pub const ENVIRONMENT: &str = "Environment";
/// The light out of focus, in the choice of background.
pub const BLURRED: &str = "Blurred";
/// The studio, in the choices of light and background.
pub const STUDIO: &str = "Studio";
/// A single colour, in the choice of background.
pub const COLOR: &str = "Colour";
/// A transparent background, in the choice of background.
pub const NO_BACKGROUND: &str = "None";
/// Preset of 1080 × 1080 pixels, in the choice of image size.
pub const SQUARE: &str = "Square";
/// Switch that saves images without the background.
pub const TRANSPARENT_BACKGROUND: &str = "Transparent background";
/// Button that saves an image.
pub const SAVE_IMAGE: &str = "Save image (PNG)";
/// Names the choice of a video's frame rate.
pub const FRAME_RATE: &str = "Frame rate";
/// Button that records a video.
pub const RECORD: &str = "Record one loop";
/// Title of the progress of a video that is being recorded.
pub const RECORDING: &str = "Recording one loop";

/// Returns a frame rate.
pub fn frames_per_sec(rate: u32) -> String {
    format!("{rate} fps")
}

/// Returns how many frames of a video have been drawn.
pub fn frames_done(done: u32, count: u32) -> String {
    format!("{done} of {count} frames")
}

// Info tab
/// Row of the file report: the format of the file.
pub const FORMAT: &str = "Format";
/// Row of the file report: the number of nodes.
pub const NODES: &str = "Nodes";
/// Value of an animated visibility.
pub const SHOWN: &str = "shown";
/// Value of an animated visibility.
pub const HIDDEN: &str = "hidden";
/// OBJ models: button that saves a GLB in the rest pose.
pub const SAVE_REST_POSE: &str = "Save in rest pose";
/// OBJ models: button that saves a GLB in the current pose.
pub const SAVE_CURRENT_POSE: &str = "Save in current pose";

/// Property of a material that a clip can animate.
pub const BASE_COLOR: &str = "base colour";
/// Property of a node that a clip can animate.
pub const VISIBILITY: &str = "visibility";

/// Returns a name and its value as a screen reader reads them: in the file report, and of a joint's transform.
pub fn fact(name: &str, value: &str) -> String {
    format!("{name} {value}")
}

// Motion tab
/// Part of the tab: the joint table.
pub const JOINTS: &str = "Joints";
/// Part of the tab: the retargeting options.
pub const OPTIONS: &str = "Options";
/// Part of the tab: how well the clip fits.
pub const FIT: &str = "Fit";
/// Part of the tab: opening, saving and removing files.
pub const FILES: &str = "Files";
/// Accessible name of the choice of one of several motions.
pub const MOTION_FILE: &str = "Motion file";

// Motion tab: the joint table
/// Hint and accessible name of the table's search field.
pub const SEARCH_JOINTS: &str = "Search joints of the model";
/// The choice of the table's order.
pub const ORDER: &str = "Order";
/// By parts of the body, in the choice of order.
pub const BY_BODY: &str = "Body";
/// By hierarchy, in the choice of order.
pub const BY_TREE: &str = "Tree";
/// Heading of a part of the body.
pub const LEFT_ARM: &str = "Left arm";
/// Heading of a part of the body.
pub const RIGHT_ARM: &str = "Right arm";
/// Accessible name of the table's filter.
pub const JOINT_FILTER: &str = "Which joints are shown";
/// A filter of the table.
pub const ALL_JOINTS: &str = "All joints";
/// A filter of the table.
pub const NEEDS_REVIEW: &str = "Needs review";
/// A filter of the table.
pub const CONFLICTS: &str = "Conflicts";
/// A filter of the table.
pub const UNMAPPED: &str = "Follow nothing";
/// A filter of the table.
pub const MUTED: &str = "Muted";
/// Shown if [`NEEDS_REVIEW`] lets no joint through.
pub const NOTHING_TO_REVIEW: &str = "No joints need review.";
/// Shown if another filter lets no joint through.
pub const NO_SUCH_JOINTS: &str = "There are no such joints.";
/// State of a joint whose source is certain.
pub const IS_SURE: &str = "sure";
/// State of a joint whose source is uncertain.
pub const IS_GUESS: &str = "guess";
/// State of a joint whose source something contradicts.
pub const IS_CONFLICT: &str = "conflict";
/// State and source of a joint that follows nothing.
pub const NO_SOURCE: &str = "none";
/// Reason in the table: the user chose no source.
pub const DELIBERATELY_NONE: &str = "deliberately none";
/// Reason in the table: the joint has a [`ROTATION_OFFSET`].
pub const HAS_OFFSET: &str = "rotation offset";

/// Returns a joint as lists show it: its number in the file and its name.
pub fn joint(number: usize, name: &str) -> String {
    format!("{number}  {name}")
}

/// Returns what a joint of the model follows: the [`joint`] of the motion, or [`NO_SOURCE`]. The accessible name of its row
/// begins so.
pub fn follows(target: &str, source: &str) -> String {
    format!("{target} follows {source}")
}

/// Returns the accessible name of a row of the table as far as the reasons.
pub fn row(target: &str, source: &str, state: &str) -> String {
    format!("{} ({state}: ", follows(target, source))
}

/// Returns the accessible name of the half of a row that selects the joint.
pub fn edit_joint(target: &str) -> String {
    format!("Edit {target}")
}

/// Returns a reason in the table: a joint without a source holds the first key of a clip.
pub fn holds_first_key(clip: &str) -> String {
    format!("first key of {clip}")
}

/// Returns a reason in the table: these channels of the source are ignored.
pub fn left_out(channels: &str) -> String {
    format!("{channels} left out")
}

// Motion tab: choosing a source
/// Accessible name of the search field in the list of sources.
pub const SEARCH_SOURCES: &str = "Name or number of a joint of the motion";
/// Row of the list that leaves the joint without a source.
pub const FOLLOW_NOTHING: &str = "Nothing";
/// Button that opens the list of sources.
pub const LIST_SOURCES: &str = "List…";
/// Button that picks the source in the viewport.
pub const CLICK_SOURCE: &str = "Click its source";
/// Button that removes the source.
pub const CLEAR_SOURCE: &str = "Clear";
/// Says that a joint of the model is to be picked in the viewport.
pub const PICK_TARGET: &str = "Click a joint of the model";
/// Button on the viewport that opens the list of sources instead.
pub const CHOOSE_FROM_LIST: &str = "Choose from the list";

/// Returns the heading of the list of sources.
pub fn what_follows(target: &str) -> String {
    format!("What does {target} follow?")
}

/// Says that a joint's source is to be picked in the viewport.
pub fn pick_source_of(target: &str) -> String {
    format!("Click the joint of the motion that {target} is to follow")
}

/// Returns the accessible name of the field for a joint's source.
pub fn source_of(target: &str) -> String {
    format!("Source of {target}")
}

/// Returns the error for a typed name that no joint of the motion has.
pub fn no_source_called(typed: &str) -> String {
    format!("No joint of the motion is called “{typed}”.")
}

// Motion tab: editing the map
/// Button that starts mapping joints by clicking them.
pub const PICK_IN_VIEWPORT: &str = "Pick in viewport";
/// The same button while picking.
pub const STOP_PICKING: &str = "Stop picking";
/// Button on the viewport that ends picking.
pub const DONE_PICKING: &str = "Done";
/// A motion whose rest is not certain.
pub const DOUBTFUL_REST: &str = "The motion's rest looks like a pose in motion. If feet, hands or hips are turned, compare the rest poses in Options and choose another.";
/// Button that returns to the proposed map.
pub const REMATCH: &str = "Re-match";
/// Button that exchanges the sources of left and right joints.
pub const SWAP_SIDES: &str = "Swap sides";
/// The same button where positions contradict the names and were followed.
pub const MATCH_SIDES_BY_NAME: &str = "Match sides by name";
/// The same button once names are followed.
pub const MATCH_SIDES_BY_POSITION: &str = "Match sides by position";
/// Button that leaves all joints unmapped.
pub const CLEAR_MAP: &str = "Clear all";

// Motion tab: options
/// Switch that plants the feet.
pub const PLANT_FEET: &str = "Hold feet on the ground";
/// In several choices.
pub const AUTOMATIC: &str = "Automatic";
/// Keeps translations, scales or a part of the root motion.
pub const KEEP: &str = "Keep";
/// Drops translations or scales.
pub const DROP: &str = "Drop";
/// Removes the travel from a part of the root motion.
pub const IN_PLACE: &str = "In place";
/// Holds a part of the root motion.
pub const FREEZE: &str = "Freeze";
/// Slider of the seconds that a change of clips takes.
pub const CROSSFADE: &str = "Crossfade";
/// Choice of what happens to the root's horizontal travel.
pub const ROOT_HORIZONTAL: &str = "Root motion: horizontal";
/// Choice of what happens to the root's vertical travel.
pub const ROOT_VERTICAL: &str = "Root motion: vertical";
/// Choice of what happens to the root's yaw.
pub const ROOT_TURN: &str = "Root motion: turn";
/// Switch that moves the kept travel to the model's root joint.
pub const EXTRACT_ROOT_MOTION: &str = "Extract root motion";
/// Accessible name of the choice of what unmapped joints do.
pub const UNMAPPED_JOINTS: &str = "Unmapped joints";
/// Switch that freezes the clip of joints without a source.
pub const HOLD_FIRST_KEY: &str = "Stand still at the clip's first key";
/// In the choice of what joints without a source do.
pub const REST: &str = "Rest";
/// Accessible name of the choice of what one joint does without a source.
pub const OWN_POLICY: &str = "What it does instead";

/// Returns the option of following the policy of the whole map.
pub fn as_all(policy: &str) -> String {
    format!("As all ({})", policy.to_lowercase())
}

/// Returns the option of holding the first key of a clip.
pub fn first_key_of(clip: &str) -> String {
    format!("First key of {clip}")
}

/// Returns what a choice of rest pose is called.
pub fn rest_choice(choice: RestChoice) -> &'static str {
    match choice {
        RestChoice::Auto => AUTOMATIC,
        RestChoice::Node => "As the file's nodes stand",
        RestChoice::Bind => "As the mesh was bound",
        RestChoice::FirstFrame => "The clip's first frame",
    }
}

// Motion tab: fit
/// Shown instead of the figures while one of the model's own clips is active.
pub const NOTHING_TO_MEASURE: &str = "Choose a borrowed clip to see how well it fits.";
/// Figure: the mean of a group.
pub const MEAN: &str = "Mean";
/// Figure: the mapped share of the body parts.
pub const COVERAGE: &str = "Mapped";
/// What planting the feet did.
pub const PLANTING: &str = "Planting";

/// Returns a figure as a screen reader reads it.
pub fn figure(name: &str, value: &str) -> String {
    format!("{name}: {value}")
}

// Motion tab: files
/// Button that saves the joint map.
pub const SAVE_MAP: &str = "Save map";
/// Button that loads a joint map.
pub const LOAD_MAP: &str = "Load map";
/// Button that removes the motion.
pub const REMOVE_MOTION: &str = "Remove motion";
/// Button that saves the model's file with the current clip.
pub const SAVE_GLB: &str = "Save GLB";
/// Button that saves the current clip with its skeleton, without the meshes.
pub const SAVE_CLIP: &str = "Save the clip alone";
/// Button that shows the motion's skeleton.
pub const SHOW_SOURCE: &str = "Show it beside the model";
/// The same button while the skeleton is shown.
pub const HIDE_SOURCE: &str = "Hide it";
/// Why those buttons are disabled while one of the model's own clips is active.
pub const NEEDS_BORROWED_CLIP: &str = "Choose a borrowed clip in the clip list first.";
/// Button that opens the motion's skeleton as the model.
pub const OPEN_INSTEAD: &str = "Open it instead of the model";

// Motion tab: channels and rotation offset
/// Channels of a joint, as switches and reasons name them: translation, rotation, scale.
pub const CHANNELS: [&str; 3] = ["translation", "rotation", "scale"];
/// Heading of a source's channels that the model ignores.
pub const IGNORED_CHANNELS: &str = "Ignored channels";
/// Button that ends ignoring channels.
pub const USE_ALL_CHANNELS: &str = "Use all channels";
/// Heading of the choice of rest poses.
pub const REST_POSE_ALIGNMENT: &str = "Rest-pose alignment";
/// Legend of the foot-contact tracks: the tint.
pub const FOOT_CONTACT: &str = "contact";
/// Legend of the foot-contact tracks: the bars and their scale.
pub const FOOT_SLIDE: &str = "slide (full height 50 cm/s, line 25 cm/s)";
/// Accessible name of the choice of the model's rest pose.
pub const REST_OF_MODEL: &str = "Rest pose of the model";
/// Accessible name of the choice of the motion's rest pose.
pub const REST_OF_MOTION: &str = "Rest pose of the motion";
/// Choice of what happens to translations of joints other than the hips.
pub const TRANSLATIONS: &str = "Translations of joints";
/// Choice of what happens to scales of joints other than the hips.
pub const SCALES: &str = "Scales of joints";
/// Heading of the figures about rotations relative to the source.
pub const ROTATION_ERROR: &str = "Rotation error";
/// Heading of the three rotation offset fields of a mapped joint.
pub const ROTATION_OFFSET: &str = "Rotation offset";
/// Button that removes the rotation offset.
pub const RESET_OFFSET: &str = "Reset";

/// Returns the accessible name of the rotation offset field for an axis.
pub fn rotation_offset_about(axis: &str) -> String {
    format!("{ROTATION_OFFSET} about {axis}")
}

/// Returns the accessible name of the switch that ignores a source's channels of one property.
pub fn ignore_channels(property: &str) -> String {
    format!("Ignore {property}")
}

/// Joints whose names say left or right but that lie on the other side, in the model or the motion; `first` is the first of
/// them.
pub fn sides_contradict(who: &str, first: &str, count: usize, by_position: bool) -> String {
    let matched = sides_matched(by_position);
    match count {
        1 => format!("{first} of the {who} has a left/right name on the opposite side; {matched}."),
        _ => format!("{count} joints of the {who} have left/right names on the opposite side; {matched}."),
    }
}

/// Returns what decided the sides of such joints.
pub fn sides_matched(by_position: bool) -> &'static str {
    if by_position { "matched by position" } else { "matched by name" }
}

/// Body parts whose joints were too uncertain to map.
pub fn joints_left_out(who: &str, count: usize) -> String {
    match count {
        1 => format!("1 body part of the {who} couldn't be located reliably and was left unmapped."),
        _ => format!("{count} body parts of the {who} couldn't be located reliably and were left unmapped."),
    }
}

/// Returns the summary of the map; `sources` counts all nodes of the motion.
pub fn joints_mapped(count: usize, sources: usize) -> String {
    match count {
        0 => "No joints mapped yet.".to_owned(),
        1 => format!("1 joint mapped ({sources} in the motion)."),
        _ => format!("{count} joints mapped ({sources} in the motion)."),
    }
}
