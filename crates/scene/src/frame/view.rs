//! The frame's camera: view and projection, with near and far planes that keep depth precise at any scale.
//!
//! A camera of the file hangs on a joint, so only a frame knows where it is. `state`, which has no frame, treats it as the
//! automatic one; [`current_orbit`] makes an orbit camera of it when the view is moved.

// WebGPU's conventions: right-handed, Y up, depth from 0 to 1.
use gaitway_character::asset::{Camera, CameraProjection};
use glam::camera::rh::proj::directx::{orthographic, perspective};
use glam::camera::rh::view::look_at_mat4;
use glam::{Affine3A, Mat4, Vec3};

use super::{Frame, View, evaluate};
use crate::library::Library;
use crate::state::{CameraChoice, OrbitCamera, ViewerState, pane_aspect, resolve_camera, world_from_file_camera};

/// Smallest ratio of the near to the far plane that 24 bits of depth resolve.
const MIN_NEAR_RATIO: f32 = 1e-4;

/// Expects the frame's comparison, bounds, ground and joints. `travel` moves an orbit camera that follows the character.
pub(super) fn place_camera(library: &Library, state: &ViewerState, aspect: f32, travel: Vec3, frame: &mut Frame) {
    let pane_aspect = pane_aspect(frame.comparison, aspect);
    if let CameraChoice::File(index) = state.camera
        && let Some(view) = file_view(library, index, pane_aspect, frame)
    {
        frame.view = view;
        return;
    }
    let mut orbit = resolve_camera(library, state, aspect);
    orbit.target += travel;
    let eye = orbit.eye();
    let (near, far) = planes(frame, eye, orbit.target - eye, orbit.distance);
    let projection_from_view = perspective(state.camera_options.fov_degrees.to_radians(), pane_aspect, near, far);
    frame.view = View { view_from_world: look_at_mat4(eye, orbit.target, Vec3::Y), projection_from_view, eye };
}

/// Returns near and far distances along `ahead` that enclose the model and the ground around it.
fn planes(frame: &Frame, eye: Vec3, ahead: Vec3, distance: f32) -> (f32, f32) {
    let bounds = frame.bounds;
    if bounds.is_empty() {
        return (0.01 * distance, 100.0 * distance);
    }
    let ahead = ahead.normalize_or(Vec3::NEG_Z);
    // Margin for overlays and for poses between those the bounds were sampled from.
    let radius = 0.6 * bounds.diagonal().max(1e-6);
    let middle = (bounds.center() - eye).dot(ahead);
    let ground = frame.look.grid.map_or(0.0, |grid| grid.radius);
    let far = (middle + radius + ground).max(2.0 * radius);
    let ground_near = if ground > 0.0 { 0.02 * distance } else { f32::INFINITY };
    let near = (middle - radius).min(ground_near.max(0.0)).max(0.001 * distance.min(radius)).max(MIN_NEAR_RATIO * far);
    (near, far.max(2.0 * near))
}

fn file_view(library: &Library, index: usize, aspect: f32, frame: &Frame) -> Option<View> {
    let camera = library.active()?.asset.cameras.get(index)?;
    let world_from_camera = world_from_camera(camera, frame)?;
    let eye = Vec3::from(world_from_camera.translation);
    let ahead = Vec3::from(-world_from_camera.matrix3.z_axis);
    let distance = (frame.bounds.center() - eye).length().max(1e-6);
    let (_, reach) = planes(frame, eye, ahead, distance);
    let projection_from_view = match camera.animated(frame.properties()) {
        CameraProjection::Perspective { y_fov_radians, near, far, .. } => {
            let near = near.max(1e-6);
            let far = far.unwrap_or(reach).max(2.0 * near);
            perspective(y_fov_radians.clamp(0.01, 3.1), aspect, near, far)
        }
        CameraProjection::Orthographic { y_mag, near, far, .. } => {
            let up = y_mag.abs().max(1e-6);
            orthographic(-up * aspect, up * aspect, -up, up, near, far.max(near + 1e-6))
        }
    };
    Some(View { view_from_world: Mat4::from(world_from_camera.inverse()), projection_from_view, eye })
}

/// Returns a camera's position and axes without scale, in the pose of the frame.
fn world_from_camera(camera: &Camera, frame: &Frame) -> Option<Affine3A> {
    let world_from_joint = &frame.characters.first()?.world_from_joint;
    world_from_file_camera(world_from_joint.get(camera.joint.get())?)
}

/// Returns the orbit camera that camera commands start from, in a viewport of this aspect ratio (width over height). A
/// camera of the file becomes the closest orbit camera in the current pose: same position and direction, no roll.
pub fn current_orbit(library: &Library, state: &ViewerState, aspect: f32) -> OrbitCamera {
    file_orbit(library, state, aspect).unwrap_or_else(|| resolve_camera(library, state, aspect))
}

fn file_orbit(library: &Library, state: &ViewerState, aspect: f32) -> Option<OrbitCamera> {
    let CameraChoice::File(index) = state.camera else { return None };
    let camera = library.active()?.asset.cameras.get(index)?;
    let mut frame = Frame::default();
    evaluate(library, state, aspect, &mut frame);
    let world_from_camera = world_from_camera(camera, &frame)?;
    let (eye, towards_eye) = (Vec3::from(world_from_camera.translation), Vec3::from(world_from_camera.matrix3.z_axis));
    let to_center = (eye - frame.bounds.center()).dot(towards_eye);
    let distance = to_center.max(0.1 * frame.bounds.diagonal()).max(1e-4);
    Some(OrbitCamera {
        yaw_radians: towards_eye.x.atan2(towards_eye.z),
        pitch_radians: towards_eye.y.clamp(-1.0, 1.0).asin(),
        distance,
        // An orbit camera that follows the character is moved by its travel.
        target: eye - distance * towards_eye - frame.scratch.travel,
    })
}
