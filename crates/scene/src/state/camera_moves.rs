//! Commands that move the camera.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::framing::{DEFAULT_ASPECT, frame_all, resolve_camera, resolved_bounds};
use super::{CameraChoice, OrbitCamera, ViewerState};
use crate::library::{Library, Model};

const MAX_PITCH_RADIANS: f32 = 89.9 * PI / 180.0;

/// Turns the turntable. A file's own camera stays where it is.
pub(super) fn advance_turntable(state: &mut ViewerState, library: &Library, clock_secs: f64) {
    let radians = f64::from(state.camera_options.turntable).to_radians() * clock_secs;
    if radians != 0.0 && radians.is_finite() && !matches!(state.camera, CameraChoice::File(_)) {
        orbit(state, library, radians as f32, 0.0);
    }
}

pub(super) fn orbit(state: &mut ViewerState, library: &Library, yaw_radians: f32, pitch_radians: f32) {
    let mut orbit = resolve_camera(library, state, DEFAULT_ASPECT);
    orbit.yaw_radians += yaw_radians;
    orbit.pitch_radians += pitch_radians;
    set_camera(state, library.active(), CameraChoice::Orbit(orbit));
}

pub(super) fn pan(state: &mut ViewerState, library: &Library, right: f32, up: f32) {
    let mut orbit = resolve_camera(library, state, DEFAULT_ASPECT);
    orbit.target += world_from_viewport(&orbit, state.camera_options.fov_degrees, right, up);
    set_camera(state, library.active(), CameraChoice::Orbit(orbit));
}

pub(super) fn zoom(state: &mut ViewerState, library: &Library, factor: f32, right: f32, up: f32) {
    let model = library.active();
    let mut orbit = resolve_camera(library, state, DEFAULT_ASPECT);
    let size = model.map_or(1.0, |_| resolved_bounds(library, state).diagonal().max(1e-6));
    if factor > 0.0 {
        let distance = (orbit.distance * factor).clamp(0.01 * size, 100.0 * size);
        if state.camera_options.turntable == 0.0 {
            let part = 1.0 - distance / orbit.distance;
            orbit.target += world_from_viewport(&orbit, state.camera_options.fov_degrees, part * right, part * up);
        }
        orbit.distance = distance;
        set_camera(state, model, CameraChoice::Orbit(orbit));
    }
}

pub(super) fn frame(state: &mut ViewerState, library: &Library) {
    if state.camera != CameraChoice::Auto {
        let orbit = frame_all(library, state, 1.0);
        set_camera(state, library.active(), CameraChoice::Orbit(orbit));
    }
}

/// Converts an offset in the plane through the target, in fractions of the viewport's height, to world space.
fn world_from_viewport(orbit: &OrbitCamera, fov_degrees: f32, right: f32, up: f32) -> Vec3 {
    let height = 2.0 * orbit.distance * (0.5 * fov_degrees.to_radians()).tan();
    let back = orbit.direction();
    let to_right = Vec3::Y.cross(back).normalize_or(Vec3::X);
    height * (right * to_right + up * back.cross(to_right))
}

/// Wraps an angle to −π…π.
fn wrap_radians(radians: f32) -> f32 {
    if (-PI..=PI).contains(&radians) { radians } else { (radians + PI).rem_euclid(TAU) - PI }
}

pub(super) fn set_camera(state: &mut ViewerState, model: Option<&Model>, choice: CameraChoice) {
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
                state.camera = CameraChoice::Orbit(OrbitCamera {
                    yaw_radians: wrap_radians(yaw_radians),
                    pitch_radians: pitch_radians.clamp(-MAX_PITCH_RADIANS, MAX_PITCH_RADIANS),
                    distance: distance.clamp(1e-6, 1e7),
                    target,
                });
            }
        }
    }
}
