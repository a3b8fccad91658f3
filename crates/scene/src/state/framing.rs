//! Automatic camera framing: the whole clip in view, from the front, slightly from the side and above.

use std::f32::consts::{FRAC_PI_2, PI};

use gaitway_character::anim::{Pose, model_from_single_joint};
use gaitway_character::mesh::Bounds;
use glam::{Affine3A, Mat3A, Vec2, Vec3};

use super::comparison::{comparison, pane_aspect};
use super::playhead::world_from_model;
use super::stage::source_on_stage;
use super::{CameraChoice, OrbitCamera, ViewerState, active_take};
use crate::library::{Library, Model};

const AUTO_YAW_RADIANS: f32 = 0.44;
const AUTO_PITCH_RADIANS: f32 = 0.17;
/// Margin around the framed bounds.
const MARGIN: f32 = 1.08;

/// Returns the world-space bounds of what plays for the camera, the grid and the shadow: without root travel while the camera
/// follows, and with the source if that is visible too. A unit box if there is nothing.
pub fn resolved_bounds(library: &Library, state: &ViewerState) -> Bounds {
    let follows = state.camera_options.follow;
    let bounds = library.active().map_or(Bounds::EMPTY, |model| {
        library.bounds(&active_take(model, state), state.character.sources.scene, follows)
    });
    let source = source_on_stage(library, state);
    let source = source.map_or(Bounds::EMPTY, |source| library.bounds(&source.take(), None, follows));
    let bounds = bounds.union(source);
    if bounds.is_empty() || !bounds.size().is_finite() {
        Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) }
    } else {
        bounds
    }
}

/// Aspect ratio where the viewport is unknown; suits most windows. [`apply`](fn@super::apply) resolves the automatic camera with
/// it, so callers that know the viewport send `SetCamera` with [`resolve_camera`] first.
pub const DEFAULT_ASPECT: f32 = 1.6;

/// Returns the orbit camera for the state in a viewport of this aspect ratio (width over height). For a camera of the
/// file, whose position depends on the pose, that is the automatic one; `frame::current_orbit` evaluates the pose.
pub fn resolve_camera(library: &Library, state: &ViewerState, aspect: f32) -> OrbitCamera {
    if let CameraChoice::Orbit(orbit) = state.camera { orbit } else { automatic_camera(library, state, aspect) }
}

/// Returns the automatic camera for the state, whatever camera it has.
pub fn automatic_camera(library: &Library, state: &ViewerState, aspect: f32) -> OrbitCamera {
    let aspect = pane_aspect(comparison(library, state), aspect);
    let (yaw_radians, pitch_radians) = (front_yaw_radians(library, state) + AUTO_YAW_RADIANS, AUTO_PITCH_RADIANS);
    match library.active() {
        Some(_) => {
            fit(resolved_bounds(library, state), yaw_radians, pitch_radians, state.camera_options.fov_degrees, aspect)
        }
        None => OrbitCamera { yaw_radians, pitch_radians, distance: 3.0, target: Vec3::ZERO },
    }
}

/// Returns the yaw from which the model is seen from the front. glTF 2.0 §3.4 has it face +Z; for a body that clearly faces
/// another way at rest, this is the nearest quarter turn.
pub fn front_yaw_radians(library: &Library, state: &ViewerState) -> f32 {
    let forward = library.active().and_then(Model::forward);
    let Some(forward) = forward.map(|forward| world_from_model(state.character.edits.up).transform_vector3(forward))
    else {
        return 0.0;
    };
    let level = Vec2::new(forward.x, forward.z);
    if level.length() < 0.7 * forward.length() {
        return 0.0;
    }
    let quarters = (level.x.atan2(level.y) / FRAC_PI_2).round();
    // −180° is 180°, and −0 is 0.
    if quarters == -2.0 { PI } else { quarters * FRAC_PI_2 + 0.0 }
}

/// Returns [`resolved_bounds`] without the model's hidden nodes, unless nothing would be left or a source stands beside it.
fn shown_bounds(library: &Library, state: &ViewerState) -> Bounds {
    let all = resolved_bounds(library, state);
    let nodes = &state.character.edits.hidden.nodes;
    let is_whole = nodes.is_empty() || source_on_stage(library, state).is_some();
    let Some(model) = library.active().filter(|_| !is_whole) else { return all };
    let hidden = nodes.iter().filter_map(|&node| model.asset.skeleton.joint_of_source(node));
    let (scene, in_place) = (state.character.sources.scene, state.camera_options.follow);
    let shown = active_take(model, state).bounds(scene, in_place, &hidden.collect::<Vec<_>>());
    if shown.is_empty() || !shown.size().is_finite() { all } else { shown }
}

/// Fits everything that is shown into the viewport, keeping the current direction.
pub fn frame_all(library: &Library, state: &ViewerState, aspect: f32) -> OrbitCamera {
    let now = resolve_camera(library, state, aspect);
    match library.active() {
        Some(_) => {
            let aspect = pane_aspect(comparison(library, state), aspect);
            fit(
                shown_bounds(library, state),
                now.yaw_radians,
                now.pitch_radians,
                state.camera_options.fov_degrees,
                aspect,
            )
        }
        None => now,
    }
}

/// Whether a camera set by hand looks past everything: all corners of [`resolved_bounds`] are behind it or beyond the same edge of
/// the picture.
pub fn looks_past(library: &Library, state: &ViewerState, aspect: f32) -> bool {
    let CameraChoice::Orbit(orbit) = state.camera else { return false };
    let corners = corners_from(&orbit, library, state);
    outwards(&orbit, library, state, aspect)
        .iter()
        .any(|outward| corners.iter().all(|corner| corner.dot(*outward) > 0.0))
}

/// Whether a camera sees all corners of [`resolved_bounds`].
pub fn sees_all(orbit: &OrbitCamera, library: &Library, state: &ViewerState, aspect: f32) -> bool {
    let corners = corners_from(orbit, library, state);
    outwards(orbit, library, state, aspect)
        .iter()
        .all(|outward| corners.iter().all(|corner| corner.dot(*outward) <= 0.0))
}

/// Returns the corners of [`resolved_bounds`] as seen from the camera's eye.
fn corners_from(orbit: &OrbitCamera, library: &Library, state: &ViewerState) -> [Vec3; 8] {
    resolved_bounds(library, state).corners().map(|corner| corner - orbit.eye())
}

/// Returns the outward normals of the planes through the eye that bound what a camera sees: those of the picture's edges, and the
/// one that separates what is behind it.
fn outwards(orbit: &OrbitCamera, library: &Library, state: &ViewerState, aspect: f32) -> [Vec3; 5] {
    let (towards_eye, right, up) = axes(orbit);
    let tan_up = (0.5 * state.camera_options.fov_degrees.to_radians()).tan();
    let tan_right = tan_up * pane_aspect(comparison(library, state), aspect);
    let (across, along) = (tan_right * towards_eye, tan_up * towards_eye);
    [towards_eye, right + across, across - right, up + along, along - up]
}

/// Returns the unit vectors from the target towards the eye, to the right and up.
fn axes(orbit: &OrbitCamera) -> (Vec3, Vec3, Vec3) {
    let towards_eye = orbit.direction();
    let right = Vec3::Y.cross(towards_eye).normalize_or(Vec3::X);
    (towards_eye, right, towards_eye.cross(right))
}

/// Returns the closest camera that sees all corners of a box.
fn fit(bounds: Bounds, yaw_radians: f32, pitch_radians: f32, fov_degrees: f32, aspect: f32) -> OrbitCamera {
    let mut orbit = OrbitCamera { yaw_radians, pitch_radians, distance: 1.0, target: bounds.center() };
    let (towards_eye, right, up) = axes(&orbit);
    let tan_up = (0.5 * fov_degrees.to_radians()).tan();
    let tan_right = tan_up * aspect.clamp(0.05, 20.0);
    let mut distance: f32 = 0.0;
    for corner in bounds.corners() {
        let corner = MARGIN * (corner - orbit.target);
        let across = (corner.dot(right).abs() / tan_right).max(corner.dot(up).abs() / tan_up);
        distance = distance.max(corner.dot(towards_eye) + across);
    }
    // A single point has no size to fit: view it from one metre.
    orbit.distance = if distance > 0.0 && distance.is_finite() { distance } else { 1.0 };
    orbit
}

/// Returns a camera's position and axes without scale: −Z is forward, Y is up. `None` if its matrix is singular.
pub fn world_from_file_camera(world_from_joint: &Affine3A) -> Option<Affine3A> {
    let back = world_from_joint.matrix3.z_axis.try_normalize()?;
    let right = world_from_joint.matrix3.y_axis.cross(back).try_normalize()?;
    let matrix3 = Mat3A::from_cols(right, back.cross(right), back);
    world_from_joint.translation.is_finite().then_some(Affine3A { matrix3, translation: world_from_joint.translation })
}

/// Returns the camera's position in world space for a pose of the active model. `travel` is added to an orbit camera
/// that follows the character.
pub fn camera_eye(library: &Library, state: &ViewerState, aspect: f32, travel: Vec3, pose: &Pose) -> Option<Vec3> {
    let file_eye = |camera: usize| {
        let model = library.active()?;
        let joint = model.asset.cameras.get(camera)?.joint;
        let model_from_camera = model_from_single_joint(&model.asset.skeleton, pose, joint);
        Some(world_from_model(state.character.edits.up).transform_point3a(model_from_camera.translation).into())
    };
    match state.camera {
        CameraChoice::File(camera) => file_eye(camera),
        _ => Some(resolve_camera(library, state, aspect).eye() + travel),
    }
}
