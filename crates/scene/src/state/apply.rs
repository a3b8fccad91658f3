//! Applies commands to the view state.

use std::ops::RangeInclusive;

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_retarget::{JointMap, Pin};

use super::camera_moves::{advance_turntable, frame, orbit, pan, set_camera, zoom};
use super::clip_names::resolved;
use super::clips;
use super::maps;
use super::playhead::{active_clip, chosen_clip, clip_secs, play_range};
use super::take::{active_take, crossfade_secs};
use super::{
    CameraChoice, CameraOptions, Channel, ClipChoice, Command, Display, Edits, Fade, Hidden, KeyLight, Playback,
    Selection, VertexChoice, ViewerState,
};
use crate::library::{LayeredClip, Library, LookTarget, Model, ModelClip, MotionId};

/// Maximum length of a name that the user gives to a joint or a clip.
pub const MAX_NAME_CHARS: usize = 80;

/// Differences of times that rounding explains.
const ROUNDING_SECS: f64 = 1e-9;

/// Applies a command; nothing else changes a view state. Values out of range are clamped; numbers that aren't finite and
/// indices that the model doesn't have are ignored.
pub fn apply(state: &mut ViewerState, library: &Library, command: Command) {
    let model = library.active();
    match command {
        Command::Replace(new) => replace(state, *new),
        Command::SetScene(scene) => set_scene(state, model, scene),
        Command::SetClip(clip) => set_clip(state, model, clip),
        Command::SetPlaying(playing) => set_playing(state, model, playing),
        Command::TogglePlaying => set_playing(state, model, !state.playback.playing),
        Command::Seek(time_secs) => seek(state, model, time_secs),
        Command::Advance(clock_secs) => advance_clock(state, library, clock_secs),
        Command::StepFrames(frames) => step(state, model, frames),
        Command::SetSpeed(speed) => set_speed(state, speed),
        Command::SetLoopMode(mode) => set_loop_mode(state, model, mode),
        Command::SetRange(range) => set_range(state, model, range),
        Command::SetSkinning(mode) => state.display.skinning = mode,
        Command::SetMorph { index, weight } => set_morph(state, model, index, weight),
        Command::ClearMorphs => state.character.edits.morph.clear(),
        Command::SetExpression { name, weight } => set_expression(state, model, &name, weight),
        Command::ClearExpressions => state.character.edits.expressions.clear(),
        Command::SetLookAt(target) => set_look_at(state, target),
        Command::SetSprings(on) => state.display.springs = on,
        Command::SetPose { joint, degrees } => set_pose(state, model, joint, degrees),
        Command::ClearPose => state.character.edits.pose.clear(),
        Command::SetPin { joint, pin } => set_pin(state, model, joint, pin),
        Command::RenameJoint { joint, name } => rename(state, model, joint, &name),
        Command::EditClip { clip, edit } => clips::edit_clip(state, model, &clip, edit),
        Command::SetLayers(layers) => set_layers(state, model, layers),
        Command::SetShow(show) => state.display.show = show,
        Command::SetChannel(channel) => set_channel(state, channel),
        Command::SetInspect(inspect) => state.inspect = inspect,
        Command::SelectJoint(joint) => select_joint(state, model, joint),
        Command::SelectVertex(vertex) => select_vertex(state, model, vertex),
        Command::SetCamera(choice) => set_camera(state, model, choice),
        Command::Orbit { yaw_radians, pitch_radians } => orbit(state, library, yaw_radians, pitch_radians),
        Command::Pan { right, up } => pan(state, library, right, up),
        Command::Zoom { factor, right, up } => zoom(state, library, factor, right, up),
        Command::FrameAll => frame(state, library),
        Command::SetFov(degrees) => set_fov(state, degrees),
        Command::SetFollow(follow) => state.camera_options.follow = follow,
        Command::SetTurntable(speed) => set_turntable(state, speed),
        Command::SetVariant(variant) => set_variant(state, model, variant),
        Command::SetHidden(hidden) => set_hidden(state, model, hidden),
        Command::SetUp(up) => state.character.edits.up = up,
        Command::SetExposure(stops) => set_exposure(state, stops),
        Command::SetToneMap(tone_map) => state.display.tone_map = tone_map,
        Command::SetEnvironment(degrees) => set_rotation(&mut state.display.environment_degrees, degrees),
        Command::SetLight(environment) => state.lighting.environment = environment,
        Command::SetKeyLight(key) => set_key_light(state, key),
        Command::SetBackground(background) => state.display.background = background,
        Command::SetEmbed(embed) => state.page.embed = embed,
        Command::SetMap { motion, map } => set_map(state, library, &motion, map.map(|map| *map)),
        Command::SetSource { motion, target, source } => set_source(state, library, &motion, target, source),
        Command::EditMap { motion, edit } => super::map_edit::edit_map(state, library, &motion, edit),
        Command::SetUnmapped(unmapped) => state.character.retarget.unmapped = unmapped,
        Command::SetRoot(root) => state.character.retarget.root = root,
        Command::SetFeet(feet) => state.character.retarget.set_feet(feet),
        Command::SetContacts(contacts) => state.character.retarget.contacts = contacts,
        Command::ReconcileMaps(maps) => state.character.retarget.map = maps,
    }
}

fn advance_clock(state: &mut ViewerState, library: &Library, clock_secs: f64) {
    advance_turntable(state, library, clock_secs);
    advance(state, library.active(), clock_secs);
}

/// Returns what is used of a view, whatever model it is for.
pub(super) fn checked(view: &ViewerState) -> ViewerState {
    let mut state = ViewerState::default();
    replace(&mut state, view.clone());
    state
}

/// Returns what is used of a checked view with this model, except for what has a name.
pub(super) fn checked_for(view: &ViewerState, model: &Model) -> ViewerState {
    let mut state = view.clone();
    let has_joint = |joint: &usize| model.asset.skeleton.joint_of_source(*joint).is_some();
    state.character.edits.names.retain(|joint, _| has_joint(joint));
    state.character.edits.pose.retain(|joint, _| has_joint(joint));
    state.character.edits.layers.iter_mut().for_each(|over| over.layer.mask.joints.retain(has_joint));
    state.character.edits.hidden.retain_known(&model.asset);
    state.character.edits.morph.clear();
    for (&index, &weight) in &view.character.edits.morph {
        set_morph(&mut state, Some(model), index, Some(weight));
    }
    state.character.edits.pins.clear();
    for (&joint, &pin) in &view.character.edits.pins {
        set_pin(&mut state, Some(model), joint, Some(pin));
    }
    (state.selection, state.character.sources.scene, state.camera) = (Selection::default(), None, CameraChoice::Auto);
    select_joint(&mut state, Some(model), view.selection.joint);
    select_vertex(&mut state, Some(model), view.selection.vertex);
    set_scene(&mut state, Some(model), view.character.sources.scene);
    set_camera(&mut state, Some(model), view.camera);
    state
}

/// Replaces the whole state, checking each number as if it had been set alone. Indices are not checked against the model, which
/// may still be loading; those out of range have no effect.
fn replace(state: &mut ViewerState, new: ViewerState) {
    let default = ViewerState::default();
    let wanted = new.clone();
    *state = new;
    state.character.playhead.time_secs = default.character.playhead.time_secs;
    seek(state, None, wanted.character.playhead.time_secs);
    let finite = |fade: &Fade| fade.time_secs.is_finite() && fade.elapsed_secs.is_finite();
    state.character.playhead.fade = wanted.character.playhead.fade.filter(finite);
    state.playback.speed = default.playback.speed;
    set_speed(state, wanted.playback.speed);
    state.camera_options.fov_degrees = default.camera_options.fov_degrees;
    set_fov(state, wanted.camera_options.fov_degrees);
    state.display.exposure = default.display.exposure;
    set_exposure(state, wanted.display.exposure);
    state.display.environment_degrees = default.display.environment_degrees;
    set_rotation(&mut state.display.environment_degrees, wanted.display.environment_degrees);
    state.lighting.key = None;
    set_key_light(state, wanted.lighting.key);
    state.character.playhead.range = None;
    set_range(state, None, wanted.character.playhead.range);
    state.character.edits.morph.clear();
    for (index, weight) in wanted.character.edits.morph {
        set_morph(state, None, index, Some(weight));
    }
    state.character.edits.expressions.clear();
    for (name, weight) in wanted.character.edits.expressions {
        set_expression(state, None, &name, Some(weight));
    }
    state.display.look_at = LookTarget::Off;
    set_look_at(state, wanted.display.look_at);
    state.character.edits.pose.clear();
    for (joint, degrees) in wanted.character.edits.pose {
        set_pose(state, None, joint, Some(degrees));
    }
    state.character.edits.pins.clear();
    for (joint, pin) in wanted.character.edits.pins {
        set_pin(state, None, joint, Some(pin));
    }
    state.character.edits.names.clear();
    for (joint, name) in wanted.character.edits.names {
        rename(state, None, joint, &name);
    }
    clips::check(&mut state.character.edits.clips);
    set_layers(state, None, wanted.character.edits.layers);
    state.camera_options.turntable = default.camera_options.turntable;
    set_turntable(state, wanted.camera_options.turntable);
    state.camera = CameraChoice::Auto;
    set_camera(state, None, wanted.camera);
}

fn active<'a>(state: &ViewerState, model: Option<&'a Model>) -> Option<&'a ModelClip> {
    active_clip(model?, state)
}

fn set_scene(state: &mut ViewerState, model: Option<&Model>, scene: Option<usize>) {
    let exists = |scene: usize| model.is_none_or(|model| scene < model.asset.scenes.len());
    if scene.is_none_or(exists) {
        state.character.sources.scene = scene;
    }
}

fn set_variant(state: &mut ViewerState, model: Option<&Model>, variant: Option<String>) {
    let exists = |name: &String| model.is_none_or(|model| model.asset.variants.contains(name));
    if variant.as_ref().is_none_or(exists) {
        state.character.edits.variant = variant;
    }
}

fn set_hidden(state: &mut ViewerState, model: Option<&Model>, mut hidden: Hidden) {
    if let Some(model) = model {
        hidden.retain_known(&model.asset);
    }
    state.character.edits.hidden = hidden;
}

fn set_key_light(state: &mut ViewerState, key: Option<KeyLight>) {
    let Some(wanted) = key else {
        state.lighting.key = None;
        return;
    };
    if wanted.strength.is_finite() && wanted.yaw_degrees.is_finite() && wanted.pitch_degrees.is_finite() {
        let mut key = wanted;
        key.strength = clamped(wanted.strength, &KeyLight::STRENGTH);
        set_rotation(&mut key.yaw_degrees, wanted.yaw_degrees);
        key.pitch_degrees = clamped(wanted.pitch_degrees, &KeyLight::PITCH_DEGREES);
        state.lighting.key = Some(key);
    }
}

/// Starts a clip from its beginning, with a crossfade if the current one is playing.
pub(super) fn set_clip(state: &mut ViewerState, model: Option<&Model>, clip: ClipChoice) {
    let from = active(state, model);
    let time_secs = state.character.playhead.time_secs;
    state.character.playhead.clip = match (clip, model) {
        (ClipChoice::Clip(clip), Some(model)) => ClipChoice::Clip(resolved(model, clip)),
        (clip, _) => clip,
    };
    let fades = state.playback.playing && crossfade_secs(from, active(state, model)) > 0.0;
    let clip = from.map_or(ClipChoice::RestPose, |from| ClipChoice::Clip(from.id().clone()));
    state.character.playhead.fade = fades.then_some(Fade { clip, time_secs, elapsed_secs: 0.0 });
    state.character.playhead.time_secs = 0.0;
    state.character.playhead.range = None;
}

/// Keeps the current pose: the new mode would fold a playhead beyond the range differently.
fn set_loop_mode(state: &mut ViewerState, model: Option<&Model>, mode: LoopMode) {
    if let Some(clip) = active(state, model) {
        state.character.playhead.time_secs = clip_secs(clip, state);
    }
    state.playback.loop_mode = mode;
}

fn select_joint(state: &mut ViewerState, model: Option<&Model>, joint: Option<usize>) {
    let exists = |joint: usize| model.is_none_or(|model| joint < model.asset.skeleton.len());
    if joint.is_none_or(exists) {
        state.selection.joint = joint;
    }
}

fn select_vertex(state: &mut ViewerState, model: Option<&Model>, vertex: Option<VertexChoice>) {
    let exists = |choice: VertexChoice| {
        model.is_none_or(|model| model.has_vertex(choice.instance, choice.primitive, choice.vertex))
    };
    if vertex.is_none_or(exists) {
        state.selection.vertex = vertex;
    }
}

/// Sets the map of a motion; `None` sets the proposed one, if there is one.
fn set_map(state: &mut ViewerState, library: &Library, motion: &MotionId, map: Option<JointMap>) {
    if let Some(map) = map.or_else(|| maps::proposed_map(library, motion)) {
        maps::set_map(state, library, motion, Some(map));
    }
}

/// Ignores joints that the files don't have.
fn set_source(state: &mut ViewerState, library: &Library, motion: &MotionId, target: usize, source: Option<usize>) {
    let (Some(model), Some(about)) = (library.active(), library.motion(motion)) else { return };
    let has_target = model.asset.skeleton.joint_of_source(target).is_some();
    if has_target && source.is_none_or(|source| about.asset.skeleton.joint_of_source(source).is_some()) {
        // The overrides in `retarget` stay out of the map.
        let mut map = maps::own_map(library, state, motion).cloned().unwrap_or_default();
        maps::set_source(&mut map, target, source);
        maps::set_map(state, library, motion, Some(map));
    }
}

fn set_speed(state: &mut ViewerState, speed: f64) {
    set_f64(&mut state.playback.speed, speed, &Playback::SPEED);
}

fn set_fov(state: &mut ViewerState, degrees: f32) {
    set_f32(&mut state.camera_options.fov_degrees, degrees, &CameraOptions::FOV_DEGREES);
}

fn set_turntable(state: &mut ViewerState, speed: f32) {
    set_f32(&mut state.camera_options.turntable, speed, &CameraOptions::TURNTABLE);
}

fn set_exposure(state: &mut ViewerState, stops: f32) {
    set_f32(&mut state.display.exposure, stops, &Display::EXPOSURE);
}

fn set_f64(slot: &mut f64, value: f64, range: &RangeInclusive<f64>) {
    if value.is_finite() {
        *slot = value.clamp(*range.start(), *range.end());
    }
}

fn set_f32(slot: &mut f32, value: f32, range: &RangeInclusive<f32>) {
    if value.is_finite() {
        *slot = clamped(value, range);
    }
}

fn clamped(value: f32, range: &RangeInclusive<f32>) -> f32 {
    value.clamp(*range.start(), *range.end())
}

fn set_rotation(slot: &mut f32, degrees: f32) {
    if degrees.is_finite() {
        *slot = if (-360.0..=360.0).contains(&degrees) { degrees } else { degrees.rem_euclid(360.0) };
    }
}

/// Restarts a clip that plays once and has ended.
fn set_playing(state: &mut ViewerState, model: Option<&Model>, playing: bool) {
    state.playback.playing = playing;
    if playing
        && state.playback.loop_mode == LoopMode::Once
        && let Some(clip) = active(state, model)
    {
        let range = play_range(clip, state);
        if state.character.playhead.time_secs >= range.end_secs {
            state.character.playhead.time_secs = range.start_secs;
        }
    }
}

fn seek(state: &mut ViewerState, model: Option<&Model>, time_secs: f64) {
    if time_secs.is_finite() {
        let duration_secs = |model| active_clip(model, state).map_or(0.0, ModelClip::duration_secs);
        let end = model.map_or(f64::INFINITY, duration_secs);
        state.character.playhead.time_secs = time_secs.clamp(0.0, end);
    }
}

fn advance(state: &mut ViewerState, model: Option<&Model>, clock_secs: f64) {
    if !state.playback.playing || !clock_secs.is_finite() {
        return;
    }
    let secs = clock_secs * state.playback.speed;
    advance_fade(state, model, secs);
    let Some(clip) = active(state, model) else { return };
    let range = play_range(clip, state);
    let length = range.length_secs();
    state.character.playhead.time_secs = whole_microseconds(state.character.playhead.time_secs + secs);
    match state.playback.loop_mode {
        LoopMode::Once if state.character.playhead.time_secs >= range.end_secs => {
            state.character.playhead.time_secs = range.end_secs;
            // The last pose is the clip's own.
            state.character.playhead.fade = None;
            state.playback.playing = false;
        }
        // Whole loops are subtracted to keep the playhead small, however long it runs. Not with layers: they loop with
        // durations of their own and would jump.
        _ if !clip.layers().is_empty() || !state.character.edits.layers.is_empty() => {}
        LoopMode::Loop if length > 0.0 && state.character.playhead.time_secs > range.end_secs => {
            state.character.playhead.time_secs = range.start_secs
                + whole_microseconds((state.character.playhead.time_secs - range.start_secs).rem_euclid(length));
        }
        LoopMode::PingPong if length > 0.0 && state.character.playhead.time_secs > range.start_secs + 2.0 * length => {
            state.character.playhead.time_secs = range.start_secs
                + whole_microseconds((state.character.playhead.time_secs - range.start_secs).rem_euclid(2.0 * length));
        }
        _ => {}
    }
    if length <= 0.0 {
        state.character.playhead.time_secs = range.start_secs;
    }
}

/// Advances the crossfade, also one into the rest pose, which has no time of its own.
fn advance_fade(state: &mut ViewerState, model: Option<&Model>, secs: f64) {
    let (Some(model), Some(mut fade)) = (model, state.character.playhead.fade.take()) else { return };
    fade.elapsed_secs = whole_microseconds(fade.elapsed_secs + secs);
    let length_secs = crossfade_secs(chosen_clip(model, &fade.clip), active_clip(model, state));
    state.character.playhead.fade = (fade.elapsed_secs < length_secs).then_some(fade);
}

/// Keeps the running playhead short in links. Times that are set are not rounded, so that they hit keys exactly.
fn whole_microseconds(secs: f64) -> f64 {
    (secs * 1e6).round() / 1e6
}

fn step(state: &mut ViewerState, model: Option<&Model>, frames: i32) {
    state.playback.playing = false;
    let Some(clip) = active(state, model) else { return };
    let range = play_range(clip, state);
    let rate = clip.frames_per_sec();
    let stepped = ((clip_secs(clip, state) * rate).round() + f64::from(frames)) / rate;
    // Half a frame of tolerance: rounding may put the last frame slightly past the end.
    let tolerance = 0.5 / rate;
    state.character.playhead.time_secs =
        if state.playback.loop_mode == LoopMode::Loop && stepped > range.end_secs + tolerance {
            range.start_secs
        } else if state.playback.loop_mode == LoopMode::Loop && stepped < range.start_secs - tolerance {
            range.end_secs
        } else {
            stepped.clamp(range.start_secs, range.end_secs)
        };
}

fn set_range(state: &mut ViewerState, model: Option<&Model>, range: Option<TimeRange>) {
    let Some(range) = range else {
        state.character.playhead.range = None;
        return;
    };
    if !range.start_secs.is_finite() || !range.end_secs.is_finite() {
        return;
    }
    let (end, frame_secs) = model.map_or((f64::INFINITY, 0.0), |model| {
        let clip = active_clip(model, state);
        clip.map_or((0.0, 0.0), |clip| (clip.duration_secs(), 1.0 / clip.frames_per_sec()))
    });
    let (first, second) = (range.start_secs.clamp(0.0, end), range.end_secs.clamp(0.0, end));
    let (mut start_secs, mut end_secs) = (first.min(second), first.max(second));
    // Of less than a frame, nothing would play.
    if end_secs - start_secs < frame_secs - ROUNDING_SECS {
        end_secs = (start_secs + frame_secs).min(end);
        start_secs = start_secs.min((end_secs - frame_secs).max(0.0));
    }
    state.character.playhead.range = Some(TimeRange { start_secs, end_secs });
}

fn set_morph(state: &mut ViewerState, model: Option<&Model>, index: usize, weight: Option<f32>) {
    let exists = model.is_none_or(|model| index < model.asset.skeleton.rest().morph_weights.len());
    match weight {
        None => {
            state.character.edits.morph.remove(&index);
        }
        Some(weight) if exists && weight.is_finite() => {
            state.character.edits.morph.insert(index, clamped(weight, &Edits::MORPH_WEIGHT));
        }
        Some(_) => {}
    }
}

fn set_expression(state: &mut ViewerState, model: Option<&Model>, name: &str, weight: Option<f32>) {
    let exists = model.is_none_or(|model| model.asset.avatar.expression(name).is_some());
    match weight {
        None => {
            state.character.edits.expressions.remove(name);
        }
        Some(weight) if exists && weight.is_finite() => {
            state.character.edits.expressions.insert(name.to_owned(), clamped(weight, &Edits::EXPRESSION_WEIGHT));
        }
        Some(_) => {}
    }
}

fn set_look_at(state: &mut ViewerState, target: LookTarget) {
    if !matches!(target, LookTarget::Point(point) if !point.is_finite()) {
        state.display.look_at = target;
    }
}

fn set_pose(state: &mut ViewerState, model: Option<&Model>, joint: usize, degrees: Option<[f32; 3]>) {
    let exists = model.is_none_or(|model| model.asset.skeleton.joint_of_source(joint).is_some());
    match degrees {
        None => {
            state.character.edits.pose.remove(&joint);
        }
        Some(degrees) if exists && degrees.iter().all(|angle| angle.is_finite()) => {
            state.character.edits.pose.insert(joint, degrees.map(wrap_degrees));
        }
        Some(_) => {}
    }
}

/// Returns a name without control characters and spaces around it, cut after [`MAX_NAME_CHARS`].
pub fn one_line(name: &str) -> String {
    let line: String = name.chars().filter(|char| !char.is_control()).take(MAX_NAME_CHARS).collect();
    line.trim().to_owned()
}

/// Keeps [`one_line`]. An empty name, or the file's own, removes the custom one.
fn rename(state: &mut ViewerState, model: Option<&Model>, joint: usize, name: &str) {
    let name = &one_line(name);
    let in_file = model.map(|model| {
        let skeleton = &model.asset.skeleton;
        skeleton.joint_of_source(joint).map(|joint| skeleton.name(joint))
    });
    match in_file {
        Some(None) => {}
        _ if name.is_empty() || in_file == Some(Some(name.as_str())) => {
            state.character.edits.names.remove(&joint);
        }
        _ => {
            state.character.edits.names.insert(joint, name.clone());
        }
    }
}

/// Weights would be shown in its place, so they go.
fn set_channel(state: &mut ViewerState, channel: Channel) {
    state.display.channel = channel;
    state.inspect.weights &= channel == Channel::Shaded;
}

/// Ignores joints that the model can't pin this way.
fn set_pin(state: &mut ViewerState, model: Option<&Model>, joint: usize, pin: Option<Pin>) {
    let Some(pin) = pin else {
        state.character.edits.pins.remove(&joint);
        return;
    };
    let is_allowed = model.is_none_or(|model| active_take(model, state).pinning(None).allows(joint, pin.goal));
    if let Some(pin) = pin.checked().filter(|_| is_allowed) {
        state.character.edits.pins.insert(joint, pin);
    }
}

fn set_layers(state: &mut ViewerState, model: Option<&Model>, layers: Vec<LayeredClip>) {
    let checked = |LayeredClip { clip, layer }| {
        let clip = match model {
            Some(model) => resolved(model, clip),
            None => clip,
        };
        LayeredClip { clip, layer: layer.clamped() }
    };
    state.character.edits.layers = layers.into_iter().map(checked).collect();
}

/// Wraps an angle to −180°…180°.
fn wrap_degrees(degrees: f32) -> f32 {
    if (-180.0..=180.0).contains(&degrees) { degrees } else { (degrees + 180.0).rem_euclid(360.0) - 180.0 }
}
