//! The only way to change a view state.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::framing::{frame_all, resolve_camera, resolved_bounds};
use super::maps::{self, reconciled_maps};
use super::playhead::{active_clip, choice_of_clip, clip_of, clip_secs, play_range};
use super::{CameraChoice, ClipChoice, Command, Fade, OrbitCamera, VertexChoice, ViewerState};
use crate::anim::{LoopMode, TimeRange};
use crate::library::{Library, Model};

/// For commands that need the automatic camera without knowing the picture: wide enough for most windows. Who knows the
/// real shape sends `SetCamera` with [`resolve_camera`] first.
const USUAL_ASPECT: f32 = 16.0 / 9.0;

const MOST_NAME_LETTERS: usize = 80;

const MOST_PITCH_RADIANS: f32 = 89.9 * PI / 180.0;

/// The only way to change a view state. Values out of range are clamped, numbers that are not finite are ignored.
pub fn apply(state: &mut ViewerState, library: &Library, command: Command) {
    let model = library.active();
    match command {
        Command::Replace(new) => replace(state, *new),
        Command::SetScene(scene) => {
            let known = |scene: usize| model.is_none_or(|model| scene < model.asset.scenes.len());
            if scene.is_none_or(known) {
                state.sources.scene = scene;
            }
        }
        Command::SetClip(clip) => {
            let before = model.map(|model| (model, active_clip(model, state)));
            let time_secs = state.playhead.time_secs;
            state.playhead.clip = clip;
            state.playhead.fade = before.filter(|_| state.playback.playing).and_then(|(model, from)| {
                let fades = model.crossfade_secs(from, active_clip(model, state)) > 0.0;
                let clip = from.map_or(ClipChoice::RestPose, |from| choice_of_clip(model, from));
                fades.then_some(Fade { clip, time_secs, elapsed_secs: 0.0 })
            });
            state.playhead.time_secs = 0.0;
            state.playhead.range = None;
        }
        Command::SetPlaying(playing) => set_playing(state, model, playing),
        Command::TogglePlaying => set_playing(state, model, !state.playback.playing),
        Command::Seek(time_secs) => seek(state, model, time_secs),
        Command::Advance(clock_secs) => {
            turn(state, library, clock_secs);
            advance(state, model, clock_secs);
        }
        Command::StepFrames(frames) => step(state, model, frames),
        Command::SetSpeed(speed) => set_f64(&mut state.playback.speed, speed, 0.1, 4.0),
        Command::SetLoopMode(mode) => {
            // What is on the screen stays: the new mode would fold a playhead that has run on in its own way.
            if let Some((model, clip)) = active(state, model) {
                state.playhead.time_secs = clip_secs(model, clip, state);
            }
            state.playback.loop_mode = mode;
        }
        Command::SetRange(range) => set_range(state, model, range),
        Command::SetSkinning(mode) => state.display.skinning = mode,
        Command::SetMorph { index, weight } => set_morph(state, model, index, weight),
        Command::ClearMorphs => state.edits.morph.clear(),
        Command::SetPose { joint, degrees } => set_pose(state, model, joint, degrees),
        Command::ClearPose => state.edits.pose.clear(),
        Command::RenameJoint { joint, name } => rename(state, model, joint, &name),
        Command::SetShow(show) => state.display.show = show,
        Command::SetInspect(inspect) => state.inspect = inspect,
        Command::SelectJoint(joint) => {
            let known = |joint: usize| model.is_none_or(|model| joint < model.asset.skeleton.len());
            if joint.is_none_or(known) {
                state.selection.joint = joint;
            }
        }
        Command::SelectVertex(vertex) => {
            let known = |choice: VertexChoice| {
                model.is_none_or(|model| model.has_vertex(choice.instance, choice.primitive, choice.vertex))
            };
            if vertex.is_none_or(known) {
                state.selection.vertex = vertex;
            }
        }
        Command::SetCamera(choice) => set_camera(state, model, choice),
        Command::Orbit { yaw_radians, pitch_radians } => {
            let mut orbit = resolve_camera(library, state, USUAL_ASPECT);
            orbit.yaw_radians += yaw_radians;
            orbit.pitch_radians += pitch_radians;
            set_camera(state, model, CameraChoice::Orbit(orbit));
        }
        Command::Pan { right, up } => {
            let mut orbit = resolve_camera(library, state, USUAL_ASPECT);
            orbit.target += in_picture(&orbit, state.camera_options.fov_degrees, right, up);
            set_camera(state, model, CameraChoice::Orbit(orbit));
        }
        Command::Zoom { factor, right, up } => {
            let mut orbit = resolve_camera(library, state, USUAL_ASPECT);
            let size = model.map_or(1.0, |_| resolved_bounds(library, state).diagonal().max(1e-6));
            if factor > 0.0 {
                let distance = (orbit.distance * factor).clamp(0.01 * size, 100.0 * size);
                if state.camera_options.turntable == 0.0 {
                    let part = 1.0 - distance / orbit.distance;
                    orbit.target += in_picture(&orbit, state.camera_options.fov_degrees, part * right, part * up);
                }
                orbit.distance = distance;
                set_camera(state, model, CameraChoice::Orbit(orbit));
            }
        }
        Command::FrameAll => {
            if state.camera != CameraChoice::Auto {
                let orbit = frame_all(library, state, 1.0);
                set_camera(state, model, CameraChoice::Orbit(orbit));
            }
        }
        Command::SetFov(degrees) => set_f32(&mut state.camera_options.fov_degrees, degrees, 5.0, 120.0),
        Command::SetFollow(follow) => state.camera_options.follow = follow,
        Command::SetTurntable(speed) => set_f32(&mut state.camera_options.turntable, speed, -360.0, 360.0),
        Command::SetUp(up) => state.edits.up = up,
        Command::SetExposure(stops) => set_f32(&mut state.display.exposure, stops, -10.0, 10.0),
        Command::SetEnvironment(degrees) => set_turn(&mut state.display.environment_degrees, degrees),
        Command::SetBackground(background) => state.display.background = background,
        Command::SetEmbed(embed) => state.page.embed = embed,
        Command::SetMap { motion, map } => {
            let map = map.map(|map| *map).or_else(|| maps::proposed(library, motion));
            maps::set_map(state, library, motion, map);
        }
        Command::SetSource { motion, target, source } => set_source(state, library, motion, target, source),
        Command::EditMap { motion, edit } => super::map_edit::edit_map(state, library, motion, edit),
        Command::SetUnmapped(unmapped) => state.retarget.unmapped = unmapped,
        Command::SetRoot(root) => state.retarget.root = root,
        Command::SetFeet(feet) => state.retarget.feet = feet,
        Command::ReconcileMaps => state.retarget.map = reconciled_maps(library, state).0,
    }
}

/// Takes over a whole state, each number checked as if it had been set by itself. What depends on a model is left: the
/// model may still be on its way, and an index that it does not have is shown as if it were not set.
fn replace(state: &mut ViewerState, new: ViewerState) {
    let default = ViewerState::default();
    let wanted = new.clone();
    *state = new;
    if !wanted.playhead.time_secs.is_finite() {
        state.playhead.time_secs = default.playhead.time_secs;
    }
    let finite = |fade: &Fade| fade.time_secs.is_finite() && fade.elapsed_secs.is_finite();
    state.playhead.fade = wanted.playhead.fade.filter(finite);
    state.playback.speed = default.playback.speed;
    set_f64(&mut state.playback.speed, wanted.playback.speed, 0.1, 4.0);
    state.camera_options.fov_degrees = default.camera_options.fov_degrees;
    set_f32(&mut state.camera_options.fov_degrees, wanted.camera_options.fov_degrees, 5.0, 120.0);
    state.display.exposure = default.display.exposure;
    set_f32(&mut state.display.exposure, wanted.display.exposure, -10.0, 10.0);
    state.display.environment_degrees = default.display.environment_degrees;
    set_turn(&mut state.display.environment_degrees, wanted.display.environment_degrees);
    state.playhead.range = None;
    set_range(state, None, wanted.playhead.range);
    state.edits.morph.clear();
    for (index, weight) in wanted.edits.morph {
        set_morph(state, None, index, Some(weight));
    }
    state.edits.pose.clear();
    for (joint, degrees) in wanted.edits.pose {
        set_pose(state, None, joint, Some(degrees));
    }
    state.edits.names.clear();
    for (joint, name) in wanted.edits.names {
        rename(state, None, joint, &name);
    }
    state.camera_options.turntable = default.camera_options.turntable;
    set_f32(&mut state.camera_options.turntable, wanted.camera_options.turntable, -360.0, 360.0);
    state.camera = CameraChoice::Auto;
    set_camera(state, None, wanted.camera);
}

fn active<'a>(state: &ViewerState, model: Option<&'a Model>) -> Option<(&'a Model, usize)> {
    let model = model?;
    Some((model, active_clip(model, state)?))
}

/// Numbers that the files do not have are left alone.
fn set_source(state: &mut ViewerState, library: &Library, motion: usize, target: usize, source: Option<usize>) {
    let (Some(model), Some(about)) = (library.active(), library.motions().get(motion)) else { return };
    let has_target = model.asset.skeleton.joint_of_source(target).is_some();
    if has_target && source.is_none_or(|source| about.asset.skeleton.joint_of_source(source).is_some()) {
        let mut map = maps::own_map(library, state, motion).cloned().unwrap_or_default();
        maps::set_source(&mut map, target, source);
        maps::set_map(state, library, motion, Some(map));
    }
}

fn set_f64(slot: &mut f64, value: f64, least: f64, most: f64) {
    if value.is_finite() {
        *slot = value.clamp(least, most);
    }
}

fn set_f32(slot: &mut f32, value: f32, least: f32, most: f32) {
    if value.is_finite() {
        *slot = value.clamp(least, most);
    }
}

fn set_turn(slot: &mut f32, degrees: f32) {
    if degrees.is_finite() {
        *slot = if (-360.0..=360.0).contains(&degrees) { degrees } else { degrees.rem_euclid(360.0) };
    }
}

/// Starting again at the end of a clip that plays once starts it over.
fn set_playing(state: &mut ViewerState, model: Option<&Model>, playing: bool) {
    state.playback.playing = playing;
    if playing
        && state.playback.loop_mode == LoopMode::Once
        && let Some((model, clip)) = active(state, model)
    {
        let range = play_range(model, clip, state);
        if state.playhead.time_secs >= range.end_secs {
            state.playhead.time_secs = range.start_secs;
        }
    }
}

fn seek(state: &mut ViewerState, model: Option<&Model>, time_secs: f64) {
    if time_secs.is_finite() {
        let end = model.map_or(f64::INFINITY, |model| {
            let clip = active_clip(model, state).and_then(|clip| model.clip(clip));
            clip.map_or(0.0, |clip| f64::from(clip.duration_secs()))
        });
        state.playhead.time_secs = time_secs.clamp(0.0, end);
    }
}

fn advance(state: &mut ViewerState, model: Option<&Model>, clock_secs: f64) {
    let Some((model, clip)) = active(state, model) else { return };
    if !state.playback.playing || !clock_secs.is_finite() {
        return;
    }
    let range = play_range(model, clip, state);
    let length = range.length_secs();
    let secs = clock_secs * state.playback.speed;
    state.playhead.time_secs = whole_microseconds(state.playhead.time_secs + secs);
    if let Some(fade) = &mut state.playhead.fade {
        fade.elapsed_secs = whole_microseconds(fade.elapsed_secs + secs);
        let from = clip_of(model, &fade.clip);
        if fade.elapsed_secs >= model.crossfade_secs(from, Some(clip)) {
            state.playhead.fade = None;
        }
    }
    match state.playback.loop_mode {
        LoopMode::Once if state.playhead.time_secs >= range.end_secs => {
            state.playhead.time_secs = range.end_secs;
            state.playback.playing = false;
        }
        // Whole rounds are taken off, so that the playhead stays a small number however long it runs; but not where layers
        // loop on durations of their own, which one round of the clip would cut off.
        _ if !model.layers(clip).is_empty() => {}
        LoopMode::Loop if length > 0.0 && state.playhead.time_secs > range.end_secs => {
            state.playhead.time_secs =
                range.start_secs + whole_microseconds((state.playhead.time_secs - range.start_secs).rem_euclid(length));
        }
        LoopMode::PingPong if length > 0.0 && state.playhead.time_secs > range.start_secs + 2.0 * length => {
            state.playhead.time_secs = range.start_secs
                + whole_microseconds((state.playhead.time_secs - range.start_secs).rem_euclid(2.0 * length));
        }
        _ => {}
    }
    if length <= 0.0 {
        state.playhead.time_secs = range.start_secs;
    }
}

/// Where the playhead happens to be has few digits in a link. What is set is not touched: a key's own time is met exactly.
fn whole_microseconds(secs: f64) -> f64 {
    (secs * 1e6).round() / 1e6
}

fn step(state: &mut ViewerState, model: Option<&Model>, frames: i32) {
    state.playback.playing = false;
    let Some((model, clip)) = active(state, model) else { return };
    let range = play_range(model, clip, state);
    let rate = model.frames_per_sec(clip);
    let stepped = ((clip_secs(model, clip, state) * rate).round() + f64::from(frames)) / rate;
    // Half a frame of slack: the last frame may lie a rounding error past the end.
    let slack = 0.5 / rate;
    state.playhead.time_secs = if state.playback.loop_mode == LoopMode::Loop && stepped > range.end_secs + slack {
        range.start_secs
    } else if state.playback.loop_mode == LoopMode::Loop && stepped < range.start_secs - slack {
        range.end_secs
    } else {
        stepped.clamp(range.start_secs, range.end_secs)
    };
}

fn set_range(state: &mut ViewerState, model: Option<&Model>, range: Option<TimeRange>) {
    let Some(range) = range else {
        state.playhead.range = None;
        return;
    };
    if !range.start_secs.is_finite() || !range.end_secs.is_finite() {
        return;
    }
    let end = model.map_or(f64::INFINITY, |model| {
        let clip = active_clip(model, state).and_then(|clip| model.clip(clip));
        clip.map_or(0.0, |clip| f64::from(clip.duration_secs()))
    });
    let (first, second) = (range.start_secs.clamp(0.0, end), range.end_secs.clamp(0.0, end));
    state.playhead.range = Some(TimeRange { start_secs: first.min(second), end_secs: first.max(second) });
}

fn set_morph(state: &mut ViewerState, model: Option<&Model>, index: usize, weight: Option<f32>) {
    let known = model.is_none_or(|model| index < model.asset.skeleton.rest().morph_weights.len());
    match weight {
        None => {
            state.edits.morph.remove(&index);
        }
        Some(weight) if known && weight.is_finite() => {
            state.edits.morph.insert(index, weight.clamp(-10.0, 10.0));
        }
        Some(_) => {}
    }
}

fn set_pose(state: &mut ViewerState, model: Option<&Model>, joint: usize, degrees: Option<[f32; 3]>) {
    let known = model.is_none_or(|model| model.asset.skeleton.joint_of_source(joint).is_some());
    match degrees {
        None => {
            state.edits.pose.remove(&joint);
        }
        Some(degrees) if known && degrees.iter().all(|angle| angle.is_finite()) => {
            state.edits.pose.insert(joint, degrees.map(half_turn));
        }
        Some(_) => {}
    }
}

/// A name is a line of at most [`MOST_NAME_LETTERS`]; nothing, or what the file says, is no name of its own.
fn rename(state: &mut ViewerState, model: Option<&Model>, joint: usize, name: &str) {
    let line: String = name.chars().filter(|letter| !letter.is_control()).take(MOST_NAME_LETTERS).collect();
    let name = line.trim();
    let in_file = model.map(|model| {
        let skeleton = &model.asset.skeleton;
        skeleton.joint_of_source(joint).map(|joint| skeleton.name(joint))
    });
    match in_file {
        Some(None) => {}
        _ if name.is_empty() || in_file == Some(Some(name)) => {
            state.edits.names.remove(&joint);
        }
        _ => {
            state.edits.names.insert(joint, name.to_owned());
        }
    }
}

/// From −180° to 180°.
fn half_turn(degrees: f32) -> f32 {
    if (-180.0..=180.0).contains(&degrees) { degrees } else { (degrees + 180.0).rem_euclid(360.0) - 180.0 }
}

/// The turntable. A file's own camera stays where it is.
fn turn(state: &mut ViewerState, library: &Library, clock_secs: f64) {
    let radians = f64::from(state.camera_options.turntable).to_radians() * clock_secs;
    if radians != 0.0 && radians.is_finite() && !matches!(state.camera, CameraChoice::File(_)) {
        let mut orbit = resolve_camera(library, state, USUAL_ASPECT);
        orbit.yaw_radians += radians as f32;
        set_camera(state, library.active(), CameraChoice::Orbit(orbit));
    }
}

/// A way in the plane of the target, in fractions of the picture's height.
fn in_picture(orbit: &OrbitCamera, fov_degrees: f32, right: f32, up: f32) -> Vec3 {
    let picture_height = 2.0 * orbit.distance * (0.5 * fov_degrees.to_radians()).tan();
    let back = orbit.direction();
    let to_right = Vec3::Y.cross(back).normalize_or(Vec3::X);
    picture_height * (right * to_right + up * back.cross(to_right))
}

fn set_camera(state: &mut ViewerState, model: Option<&Model>, choice: CameraChoice) {
    match choice {
        CameraChoice::Auto => state.camera = CameraChoice::Auto,
        CameraChoice::File(index) => {
            if model.is_none_or(|model| index < model.asset.cameras.len()) {
                state.camera = choice;
            }
        }
        CameraChoice::Orbit(orbit) => {
            let OrbitCamera { yaw_radians, pitch_radians, distance, target } = orbit;
            let finite = yaw_radians.is_finite() && pitch_radians.is_finite() && distance.is_finite();
            if finite && target.is_finite() && distance > 0.0 {
                let turn = if (-PI..=PI).contains(&yaw_radians) {
                    yaw_radians
                } else {
                    (yaw_radians + PI).rem_euclid(TAU) - PI
                };
                state.camera = CameraChoice::Orbit(OrbitCamera {
                    yaw_radians: turn,
                    pitch_radians: pitch_radians.clamp(-MOST_PITCH_RADIANS, MOST_PITCH_RADIANS),
                    distance: distance.clamp(1e-6, 1e7),
                    target,
                });
            }
        }
    }
}
