//! The inspector's tabs except for Motion.

use gaitway_character::mesh::{Geometry, SkinningMode};
use gaitway_scene::editor::ValidatorReport;
use gaitway_scene::library::Model;
use gaitway_scene::state::Channel;

use super::{counted, grouped, labelled};

// Scene tab
/// Hint in the search field of the node tree.
pub const SEARCH_NODES: &str = "Search nodes";
/// Card of a joint whose mesh or light is not shown.
pub const NODE_HIDDEN: &str =
    "Not shown: it is in something hidden, hidden by the file or by the clip, or part of another scene.";
/// Button of the selected joint's card that hides all other meshes, or shows them again.
pub const SOLO: &str = "Solo";
/// What that button does.
pub const SOLO_HINT: &str = "Hides all other meshes. Press again to show them.";
/// Button of the selected joint's card that hides the meshes and lights of the node and below.
pub const HIDE: &str = "Hide";
/// The same button once they are hidden.
pub const SHOW: &str = "Show";
/// Description of a hidden node's row.
pub const HIDDEN_NODE: &str = "Hidden";
/// Button that shows all hidden nodes and materials.
pub const SHOW_ALL: &str = "Show all";
/// Tooltip of an eye.
pub const SOLO_ALTERNATIVES: &str = "Alt-click or right-click to solo";
/// Close button of the selected node's card.
pub const DESELECT: &str = "Deselect";
/// Shown in the viewport while joints are posed manually.
pub const POSING: &str = "Posing manually";
/// Button beside it that stops that.
pub const DONE_POSING: &str = "Done posing";
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

/// Returns the accessible name of the button that hides something or, once it is hidden, shows it again.
pub fn eye(name: &str, is_shown: bool) -> String {
    format!("{} {name}", if is_shown { HIDE } else { SHOW })
}

/// Returns the name of a collapsed tree row's triangle.
pub fn expand(name: &str) -> String {
    format!("Expand {name}")
}

/// Returns the name of an expanded tree row's triangle.
pub fn collapse(name: &str) -> String {
    format!("Collapse {name}")
}

/// Button that returns all manually posed joints to the clip; their number follows.
pub const RESET_ALL: &str = "Reset all";

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
    /// The vertex as another method draws it beside the linear one, in world space.
    DrawnBy(SkinningMode),
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
            Self::DrawnBy(method) => (skinning_method(method), "drawn by this skinning method"),
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
pub const NO_VARIANT: &str = "The file's own materials";
/// Skinning method: each vertex follows its strongest joint.
pub const RIGID: &str = "Rigid";
/// Skinning method: dual quaternions, abbreviated to fit.
pub const DUAL_QUATERNION: &str = "Dual quat.";

/// Returns the short name of a skinning method.
pub fn skinning_method(mode: SkinningMode) -> &'static str {
    match mode {
        SkinningMode::Linear => "Linear",
        SkinningMode::Rigid => RIGID,
        SkinningMode::DualQuaternion => DUAL_QUATERNION,
    }
}

/// Choice of the skinning method.
pub const SKINNING: &str = "Skinning";
/// Choice of where the motion's own character is shown.
pub const MOTION_SOURCE: &str = "Motion source";
/// Switch that shows the three skinning methods side by side.
pub const COMPARE_SKINNING: &str = "Compare all three";
/// Switch in the Motion tab that shows the motion in its different rest poses side by side.
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
/// Below the scale of the numbers of influences, in the viewport.
pub const INFLUENCES_LEGEND: &str = "influences per vertex (grey: none)";
/// The choice of what surfaces show.
pub const CHANNEL: &str = "Surface";
/// Help for the keys that cycle through channels.
pub const CYCLE_CHANNELS: &str = "Next surface channel, previous surface channel";

/// Returns the name of a channel, in its choice and in the viewport.
pub fn channel(channel: Channel) -> &'static str {
    match channel {
        Channel::Shaded => "Shaded",
        Channel::BaseColor => "Base colour",
        Channel::Normal => "Normals (world)",
        Channel::Tangent => "Tangents (world)",
        Channel::Roughness => "Roughness",
        Channel::Metallic => "Metallic",
        Channel::Occlusion => "Occlusion",
        Channel::Emissive => "Emissive",
        Channel::Uv => "UV checker (set 0)",
        Channel::VertexColor => "Vertex colours",
        Channel::Influences => "Number of influences",
        Channel::Wireframe => "Wireframe",
    }
}

/// Returns what a model lacks that a channel shows, beside the channel or in place of its name.
pub fn absent(channel: Channel, model: &Model) -> Option<&'static str> {
    let none_has = |has: fn(&Geometry) -> bool| !model.asset.meshes.iter().flat_map(|mesh| &mesh.primitives).any(has);
    match channel {
        Channel::VertexColor if none_has(|geometry| !geometry.colors.is_empty()) => Some("No vertex colours"),
        Channel::Uv if none_has(|geometry| !geometry.uvs[0].is_empty()) => Some("No texture coordinates"),
        _ => None,
    }
}

/// Switch that computes normals for meshes without any.
pub const SMOOTH_SURFACE: &str = "Smooth surface";
/// Button that undoes all edits of the morph sliders.
pub const RESET_MORPHS: &str = "Reset to clip";

// Avatar, in the Display and Info tabs
/// Switch for spring bones.
pub const SPRINGS: &str = "Spring bones";
/// Label of the choice of what the eyes look at.
pub const EYES: &str = "Eyes look";
/// Choice: the gaze that the clip animates.
pub const LOOK_OFF: &str = "As animated";
/// Choice: the eyes follow the camera.
pub const LOOK_AT_CAMERA: &str = "At the camera";
/// Choice: the eyes look at a fixed point.
pub const LOOK_AT_POINT: &str = "At a point";
/// Button that returns all expressions to the clip.
pub const RESET_EXPRESSIONS: &str = "Reset expressions";

/// Returns the name of a mesh's first-person flag in the Info tab.
pub fn first_person(mesh: &str) -> String {
    format!("First person: {mesh}")
}

/// Splits a camel-case key of VRM's metadata into words: `commercialUsage` becomes “Commercial usage”. Other text stays as it
/// is.
pub fn split_words(key: &str) -> String {
    if !key.bytes().all(|byte| byte.is_ascii_alphabetic()) {
        return key.to_owned();
    }
    let mut words = String::new();
    let mut previous = ' ';
    for letter in key.chars() {
        if letter.is_uppercase() && previous.is_lowercase() {
            words.push(' ');
        }
        match words.is_empty() {
            true => words.push(letter.to_ascii_uppercase()),
            false => words.push(letter.to_ascii_lowercase()),
        }
        previous = letter;
    }
    // VRM 0.x misspells it, and ends many keys with “Name” for the name of a choice.
    words
        .replace("ussage", "usage")
        .replace(" url", " URL")
        .replace("icense", "icence")
        .trim_end_matches(" name")
        .to_owned()
}

// Camera tab
/// Button that looks at the model's front.
pub const FRONT: &str = "Front";
/// Button that looks at the model from its left.
pub const SIDE: &str = "Side";
/// Button that looks down on the model.
pub const TOP: &str = "Top";
/// Switch that moves the camera along with the character.
pub const FOLLOW: &str = "Follow character";
/// Choice of the file's up axis.
pub const UP_AXIS: &str = "Up axis of the file";
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
/// Choice of what is behind the model.
pub const BACKGROUND: &str = "Background";
/// A transparent background, in the choice of background.
pub const NO_BACKGROUND: &str = "None";
/// Choice of the size of saved images and videos.
pub const PICTURE_SIZE: &str = "Image size";
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
/// Why a clip that lasts too long isn't recorded.
pub const TOO_MANY_FRAMES: &str = "it would have more than a million frames; choose in and out points first";
/// Button that records an animated GIF.
pub const RECORD_GIF: &str = "Record one loop as a GIF";
/// Tooltip of the button.
pub const ABOUT_GIF: &str =
    "Renders the played range once, frame by frame, as an animated GIF, reduced so that it stays small enough to send.";
/// Button that saves the frames of such a video as images.
pub const RECORD_IMAGES: &str = "Save one loop as images";
/// Title of the progress of a video, or of images, being recorded.
pub const RECORDING: &str = "Rendering one loop";

/// Returns a frame rate.
pub fn frames_per_sec(rate: u32) -> String {
    format!("{rate} fps")
}

/// Returns how many frames of a video have been drawn.
pub fn frames_done(done: u32, count: u32) -> String {
    format!("{done} of {count} frames")
}

// Info tab
/// Section with the file's warnings and the lints.
pub const WARNINGS: &str = "WARNINGS";
/// Shown if there are none.
pub const NO_WARNINGS: &str = "Gaitway's own checks found no problems.";

/// Returns the title of the warnings with one code, such as `loop-open`: “Loop open”.
pub fn warning_title(code: &str, count: usize) -> String {
    let mut words = code.replace('-', " ");
    if let Some(first) = words.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    if count == 1 { words } else { counted(&words, count) }
}

/// Returns what the dot on the Info tab means.
pub fn file_warnings(count: usize) -> String {
    format!("{} about this file", warnings(count))
}

/// Returns what the dot on a node's row in the tree means.
pub fn node_warnings(count: usize) -> String {
    format!("{} in the Info tab", warnings(count))
}

fn warnings(count: usize) -> String {
    if count == 1 { "1 warning".to_owned() } else { format!("{count} warnings") }
}

/// Returns the accessible name of the button beside a warning that selects the node it is about.
pub fn go_to(node: &str) -> String {
    format!("Go to {node}")
}

/// Name of the validator: the heading of its section, and in front of its notices.
pub const KHRONOS_VALIDATOR: &str = "Khronos validator";
/// Shown for models whose file has not arrived completely.
pub const NO_GLTF_YET: &str = "Checks the file once its images have arrived.";
/// Shown for models of other formats, and for those without a file.
pub const NO_GLTF: &str = "Checks only glTF files: .gltf, .glb, .vrm and .vrma.";
/// Button that starts it.
pub const VALIDATE: &str = "Check with the Khronos validator";
/// The same button while the validator runs.
pub const VALIDATING: &str = "Checking…";
/// The same button afterwards.
pub const VALIDATE_AGAIN: &str = "Check again";
/// How severe its findings are, in front of what they mean.
pub const SEVERITIES: [&str; 4] = ["Error", "Warning", "Info", "Hint"];

/// Returns the title of the findings of one kind: `what` is wrong, and how often.
pub fn finding_title(severity: usize, what: &str, count: u64) -> String {
    let title = labelled(SEVERITIES[severity], what);
    if count == 1 { title } else { format!("{title} ({} places)", grouped(count as usize)) }
}

/// Its summary without findings.
pub const NO_FINDINGS: &str = "No findings";

/// Returns how many kinds of findings it has, by severity: one mistake of an exporter is often in a thousand places.
pub fn validator_summary(report: &ValidatorReport) -> String {
    let counted = |(severity, name): (usize, &str)| {
        let places = report.counts[severity] as usize;
        let kinds = report.groups.iter().filter(|group| group.severity == severity).count();
        let s = if kinds == 1 { "" } else { "s" };
        match places {
            0 => None,
            _ if places <= kinds => Some(format!("{places} {name}{s}")),
            _ => Some(format!("{kinds} kind{s} of {name} in {} places", grouped(places))),
        }
    };
    let counts: Vec<String> =
        ["error", "warning", "info", "hint"].into_iter().enumerate().filter_map(counted).collect();
    match (counts.is_empty(), report.is_truncated) {
        (true, _) => NO_FINDINGS.to_owned(),
        (false, true) => format!("{}; the validator stopped there", counts.join(", ")),
        (false, false) => counts.join(", "),
    }
}

/// Returns why there is no report.
pub fn validator_failed(error: &str) -> String {
    format!("Couldn't check the file: {error}")
}

/// Returns how many findings are not listed.
pub fn more_findings(count: u64) -> String {
    format!("and {} more", grouped(count as usize))
}

/// Section with counts and times of drawing.
pub const DRAWING: &str = "DRAWING";
/// Row: draw calls of the last image.
pub const DRAW_CALLS: &str = "Draw calls";
/// Row: triangles of the last image.
pub const DRAWN_TRIANGLES: &str = "Triangles drawn";
/// Row: memory of vertices, indices and morph targets.
pub const GEOMETRY_MEMORY: &str = "GPU memory, geometry";
/// Row: memory of images with their mip levels.
pub const IMAGE_MEMORY: &str = "GPU memory, images";
/// Row: the mean time between frames.
pub const FRAME_TIME: &str = "Frame time";
/// Its value until something has moved.
pub const NO_FRAMES: &str = "measured while playing";
/// Row: influences per vertex.
pub const INFLUENCES: &str = "Influences per vertex";
/// Section with the images.
pub const IMAGES: &str = "IMAGES";
/// Alpha mode of a material.
pub const OPAQUE: &str = "opaque";
/// Alpha mode of a material.
pub const MASKED: &str = "masked";
/// Alpha mode of a material.
pub const BLENDED: &str = "blended";
/// A material whose back faces are drawn.
pub const DOUBLE_SIDED: &str = "double-sided";

/// Returns an amount of memory, in kilobytes if a tenth of a megabyte would be too coarse.
pub fn megabytes(bytes: u64) -> String {
    match bytes {
        0 => "0 MB".to_owned(),
        1..100_000 => format!("{:.1} KB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// Returns a mean time between frames with its rate.
pub fn frame_time(secs: f32) -> String {
    format!("{:.1} ms ({:.0} fps)", 1000.0 * secs, 1.0 / secs.max(1e-6))
}

/// Returns what the graph of frame times shows: how many of them, the rate at its line, and the time at its full height.
pub fn frame_graph(count: usize, line_fps: f32, full_secs: f32) -> String {
    let full_ms = 1000.0 * full_secs;
    format!("The last {count} frames of playback. The line marks {line_fps} fps; the full height is {full_ms:.0} ms.")
}

/// Returns the maximum number of influences of a vertex, and how many vertices have more than the four that engines usually read.
pub fn influences(max: usize, over_four: usize) -> String {
    match (max, over_four) {
        (0, _) => "none".to_owned(),
        (_, 0) => format!("up to {max}"),
        (_, 1) => format!("up to {max}, 1 vertex over 4"),
        (_, count) => format!("up to {max}, {} vertices over 4", grouped(count)),
    }
}

/// Returns where a material is used: the first `max` nodes, and how many more there are.
pub fn used_by(nodes: &[String], max: usize) -> String {
    let mut names: Vec<&str> = nodes.iter().take(max).map(String::as_str).collect();
    let more = format!("{} more", nodes.len().saturating_sub(max));
    if nodes.len() > max {
        names.push(&more);
    }
    if names.is_empty() { "unused".to_owned() } else { format!("on {}", names.join(", ")) }
}

/// Returns what an image without a name is called.
pub fn image(index: usize) -> String {
    format!("Image {index}")
}

/// Returns an image's format, size in pixels, GPU memory and the maps it is used as.
pub fn image_facts(mime: &str, [width, height]: [u32; 2], bytes: u64, maps: &[&str]) -> String {
    let format = mime.strip_prefix("image/").map_or_else(|| "unavailable".to_owned(), str::to_uppercase);
    let maps = if maps.is_empty() { "unused".to_owned() } else { maps.join(", ") };
    match bytes {
        0 => format!("{format}, {width} × {height}, {maps}"),
        bytes => format!("{format}, {width} × {height}, {maps}, {} on the GPU", megabytes(bytes)),
    }
}

/// Section with the materials that surfaces use.
pub const MATERIALS: &str = "MATERIALS";

/// Returns what a material is called: its name, else its number in the file. `None` is glTF's default material.
pub fn material(index: Option<usize>, name: &str) -> String {
    match (index, name) {
        (None, _) => "Default material".to_owned(),
        (Some(index), "") => format!("Material {index}"),
        (Some(_), name) => name.to_owned(),
    }
}

/// Row of the file report: the format of the file.
pub const FORMAT: &str = "Format";
/// Row of the file report: the number of nodes.
pub const NODES: &str = "Nodes";
/// OBJ models: button that saves a GLB in the rest pose.
pub const SAVE_REST_POSE: &str = "Save in rest pose";
/// OBJ models: button that saves a GLB in the current pose.
pub const SAVE_CURRENT_POSE: &str = "Save in current pose";
