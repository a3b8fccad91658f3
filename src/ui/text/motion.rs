//! The Motion tab.

use gaitway_retarget::{RestChoice, Verdict};
use gaitway_scene::editor::ClipFormat;

use super::labelled;

// Parts of the tab
/// Choice of the part.
pub const MOTION_PART: &str = "Part of the Motion tab";
/// Part of the tab: the joint table.
pub const JOINTS: &str = "Joints";
/// The joint table.
pub const JOINTS_AND_SOURCES: &str = "Joints and their sources";
/// Part of the tab: the retargeting options.
pub const OPTIONS: &str = "Options";
/// Part of the tab: edits of the clip, and layers over it.
pub const CLIP: &str = "Clip";
/// Shown below the edits of a model's own clip.
pub const WHAT_A_MOTION_ADDS: &str =
    "A borrowed motion also shows here which joint follows which, and how well it fits.";
/// Part of the tab: how well the clip fits.
pub const FIT: &str = "Fit";
/// Part of the tab: opening, saving and removing files.
pub const FILES: &str = "Files";
/// Said while a clip plays to which the options don't apply.
pub const OWN_CLIP_PLAYS: &str =
    "The clip that plays is the model's own. The options are those of the borrowed motion.";
/// Accessible name of the choice of one of several motions.
pub const MOTION_FILE: &str = "Motion file";

// The joint table
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
pub const JOINT_FILTER: &str = "Joint filter";
/// Filter: every joint.
pub const ALL_JOINTS: &str = "All joints";
/// Filter: joints for the user to check.
pub const NEEDS_REVIEW: &str = "Needs review";
/// Filter: joints whose source something contradicts.
pub const CONFLICTS: &str = "Conflicts";
/// Filter: joints without a source.
pub const UNMAPPED: &str = "Unmapped";
/// Filter: joints that ignore channels of their source.
pub const MUTED: &str = "Muted";
/// Shown if [`NEEDS_REVIEW`] lets no joint through.
pub const NOTHING_TO_REVIEW: &str = "No joints need review.";
/// Shown if another filter lets no joint through.
pub const NO_SUCH_JOINTS: &str = "No joints match the filter.";
/// State of a joint whose source is certain.
pub const IS_SURE: &str = "sure";
/// State of a joint whose source is uncertain.
pub const IS_GUESS: &str = "guess";
/// State of a joint whose source something contradicts.
pub const IS_CONFLICT: &str = "conflict";
/// State and source of an unmapped joint.
pub const NO_SOURCE: &str = "none";
/// Reason in the table: the user removed the source.
pub const DELIBERATELY_NONE: &str = "unmapped manually";
/// Reason in the table: the joint has a [`ROTATION_OFFSET`].
pub const HAS_OFFSET: &str = "rotation offset";

/// Returns a joint as lists show it: its number in the file and its name.
pub fn joint(number: usize, name: &str) -> String {
    format!("{number}  {name}")
}

/// Returns what a joint of the model follows: a [`joint`] of the motion, or [`NO_SOURCE`]. [`row`] begins with it.
pub fn follows(target: &str, source: &str) -> String {
    format!("{target} follows {source}")
}

/// Tells screen readers which joint of the motion a joint of the model follows now, if any.
pub fn source_set(target: &str, source: Option<&str>) -> String {
    source.map_or_else(|| format!("{target} has no source."), |source| format!("{}.", follows(target, source)))
}

/// Returns a row of the table: the joint, its source and its state. In the accessible name, the reasons follow.
pub fn row(target: &str, source: &str, state: &str) -> String {
    format!("{} ({state})", follows(target, source))
}

/// Returns the accessible name of the half of a row that selects the joint.
pub fn edit_joint(target: &str) -> String {
    format!("Edit {target}")
}

/// Returns a reason in the table: an unmapped joint holds the first key of a clip.
pub fn holds_first_key(clip: &str) -> String {
    format!("holds the first key of {clip}")
}

/// Returns a reason in the table: these channels of the source are ignored.
pub fn ignored(channels: &str) -> String {
    format!("{channels} ignored")
}

// Choosing a source
/// Accessible name of the search field in the list of sources.
pub const SEARCH_SOURCES: &str = "Name or number of a joint of the motion";
/// Row of the list that unmaps the joint.
pub const FOLLOW_NOTHING: &str = "No source";
/// Button that opens the list of sources.
pub const LIST_SOURCES: &str = "List…";
/// Button that picks the source in the viewport.
pub const CLICK_SOURCE: &str = "Pick source";
/// Button that removes the source.
pub const CLEAR_SOURCE: &str = "Clear";
/// Asks for a joint of the model in the viewport.
pub const PICK_TARGET: &str = "Click a joint of the model";
/// Button on the viewport that opens the list of sources instead.
pub const CHOOSE_FROM_LIST: &str = "Choose from the list";

/// Returns the heading of the list of sources.
pub fn what_follows(target: &str) -> String {
    format!("What should {target} follow?")
}

/// Asks for the source of a joint in the viewport.
pub fn pick_source_of(target: &str) -> String {
    format!("Click the source joint for {target}")
}

/// Returns the accessible name of the field for a joint's source.
pub fn source_of(target: &str) -> String {
    format!("Source of {target}")
}

/// Returns the error for a typed name that no joint of the motion has.
pub fn no_source_called(typed: &str) -> String {
    format!("The motion has no joint called “{typed}”.")
}

// Editing the map
/// Button that starts mapping joints by clicking them.
pub const PICK_IN_VIEWPORT: &str = "Pick in viewport";
/// The same button while picking.
pub const STOP_PICKING: &str = "Stop picking";
/// Button on the viewport that ends picking.
pub const DONE_PICKING: &str = "Done";
/// Shown if the motion's rest pose may not be one.
pub const DOUBTFUL_REST: &str = "The motion's rest pose looks like a frame of the animation. If feet, hands or hips are \
    rotated, compare the rest poses in Options and choose another.";
/// Shown if the motion's up axis may be wrong.
pub const DOUBTFUL_UP: &str = "The body lies throughout the clip, but would stand on the ground if another axis were up. If it \
    should, choose the up axis of the motion among the options.";
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

// Undo and redo
/// Button that undoes an edit of the map, with its key.
pub const UNDO_KEY: &str = "Undo map edit (Ctrl+Z)";
/// Button that redoes an edit of the map, with its key.
pub const REDO_KEY: &str = "Redo map edit (Ctrl+Y)";

// Options
/// Switch that plants the feet.
pub const PLANT_FEET: &str = "Hold feet on the ground";
/// Shown below it while the editor, not the user, has switched it on.
pub const PLANTED_AUTOMATICALLY: &str =
    "Switched on automatically: without it, the feet of the borrowed clip would slide, hover or sink in.";
/// Switch that keeps contacts of hands with the body and the ground, and of knees with the ground.
pub const KEEP_CONTACTS: &str = "Keep contacts of hands and knees";
/// Option of several choices: decides by the file.
pub const AUTOMATIC: &str = "Automatic";
/// Option: keeps translations, scales or a part of the root motion.
pub const KEEP: &str = "Keep";
/// Option: drops translations or scales.
pub const DROP: &str = "Drop";
/// Option: removes the travel from a part of the root motion.
pub const IN_PLACE: &str = "In place";
/// Option: holds a part of the root motion at its start.
pub const FREEZE: &str = "Freeze";
/// Slider for the duration of a crossfade between clips.
pub const CROSSFADE: &str = "Crossfade";
/// Choice of what happens to the root's horizontal travel.
pub const ROOT_HORIZONTAL: &str = "Root motion: horizontal";
/// Choice of where the root's path lies.
pub const ROOT_ORIGIN: &str = "Root motion: origin";
/// Option: the root's path lies where the motion's feet are.
pub const FEET: &str = "Feet";
/// Choice of what happens to the root's vertical travel.
pub const ROOT_VERTICAL: &str = "Root motion: vertical";
/// Choice of what happens to the root's yaw.
pub const ROOT_TURN: &str = "Root motion: turn";
/// Switch that moves the kept travel to the model's root joint.
pub const EXTRACT_ROOT_MOTION: &str = "Extract root motion";
/// Accessible name of the choice of what unmapped joints do.
pub const UNMAPPED_JOINTS: &str = "Unmapped joints";
/// Switch that freezes the clip of unmapped joints.
pub const HOLD_FIRST_KEY: &str = "Hold the clip's first key";
/// Option: unmapped joints stay in the rest pose.
pub const REST: &str = "Rest";
/// Accessible name of the choice of what one joint does without a source.
pub const OWN_POLICY: &str = "Without a source";
/// Heading of the choice of rest poses.
pub const REST_POSE_ALIGNMENT: &str = "Rest-pose alignment";
/// Accessible name of the choice of the model's rest pose.
pub const REST_OF_MODEL: &str = "Rest pose of the model";
/// Accessible name of the choice of the motion's rest pose.
pub const REST_OF_MOTION: &str = "Rest pose of the motion";
/// Choice of the axis that is up in the motion's data.
pub const UP_OF_MOTION: &str = "Up axis of the motion";
/// Choice of what happens to translations of joints other than the hips.
pub const TRANSLATIONS: &str = "Joint translations";
/// Choice of what happens to scales of all mapped joints, the hips included.
pub const SCALES: &str = "Joint scales";

/// Returns the option of doing what the map sets for all unmapped joints.
pub fn default_policy(policy: &str) -> String {
    format!("Default ({})", policy.to_lowercase())
}

/// Returns the option of holding the first key of a clip.
pub fn first_key_of(clip: &str) -> String {
    format!("Hold the first key of {clip}")
}

/// Returns the name of a choice of rest pose.
pub fn rest_choice(choice: RestChoice) -> &'static str {
    match choice {
        RestChoice::Auto => AUTOMATIC,
        RestChoice::Node => "Node transforms",
        RestChoice::Bind => "Bind pose",
        RestChoice::FirstFrame => "First frame of the clip",
    }
}

// Fit
/// Shown instead of the figures while one of the model's own clips is active.
pub const NOTHING_TO_MEASURE: &str = "Choose a borrowed clip to see how well it fits.";

/// Returns the verdict on a figure.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "good",
        Verdict::Acceptable => "acceptable",
        Verdict::NeedsReview => "needs review",
    }
}

/// Returns the verdict on a clip, which is the worst on its figures.
pub fn overall(worst: Verdict) -> String {
    labelled("Fit", verdict(worst))
}

/// Figure: the mean of a group.
pub const MEAN: &str = "Mean";
/// Figure: the mapped fraction of the body parts.
pub const COVERAGE: &str = "Mapped body parts";
/// Note: what planting the feet changed.
pub const PLANTING: &str = "Planting";
/// Heading of the figures about rotations relative to the source.
pub const ROTATION_ERROR: &str = "Rotation error";

// Files
/// Button that saves the joint map.
pub const SAVE_MAP: &str = "Save map";
/// Button that loads a joint map.
pub const LOAD_MAP: &str = "Load map…";
/// Button that removes the motion.
pub const REMOVE_MOTION: &str = "Remove motion";
/// Button that saves the model's file with the current clip.
pub const SAVE_GLB: &str = "Save GLB";
/// Entry of the export menu that saves the model's file with all clips.
pub const SAVE_ALL_CLIPS: &str = "Save all clips (GLB)";
/// Button that shows the motion's skeleton.
pub const SHOW_SOURCE: &str = "Show source beside the model";
/// The same button while the skeleton is shown.
pub const HIDE_SOURCE: &str = "Hide source";
/// Why the button is disabled for an unchanged clip of the model's own.
pub const IS_IN_FILE: &str = "The model's file already contains this clip.";
/// Why buttons that save the current clip are disabled in the rest pose.
pub const NEEDS_CLIP: &str = "Choose a clip in the clip list first.";
/// Why the source can't be shown while one of the model's own clips is active.
pub const NEEDS_BORROWED_CLIP: &str = "Choose a borrowed clip in the clip list first.";
/// Button that opens the motion's skeleton as the model.
pub const OPEN_INSTEAD: &str = "Open source instead of the model";

// Channels and rotation offset
/// Channels of a joint, as switches and reasons name them: translation, rotation, scale.
pub const CHANNELS: [&str; 3] = ["translation", "rotation", "scale"];
/// Heading of a source's channels that the model ignores.
pub const IGNORED_CHANNELS: &str = "Ignored channels";
/// Button that ignores no channels.
pub const USE_ALL_CHANNELS: &str = "Use all channels";
/// Heading of the three rotation offset fields of a mapped joint.
pub const ROTATION_OFFSET: &str = "Rotation offset";
/// Button that removes the rotation offset.
pub const RESET_OFFSET: &str = "Reset";

/// Returns the name of the button that saves the current clip with its skeleton, without the meshes.
pub fn save_clip(format: ClipFormat) -> &'static str {
    match format {
        ClipFormat::Glb => "Save clip (GLB)",
        ClipFormat::Bvh => "Save clip (BVH)",
        ClipFormat::Vrma => "Save clip (VRMA)",
    }
}

/// Returns the accessible name of the rotation offset field for an axis.
pub fn rotation_offset_about(axis: &str) -> String {
    format!("{ROTATION_OFFSET} about {axis}")
}

/// Returns the accessible name of the switch that ignores a source's channels of one property.
pub fn ignore_channels(property: &str) -> String {
    format!("Ignore {property}")
}
