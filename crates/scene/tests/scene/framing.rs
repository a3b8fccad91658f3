//! The camera frames the whole clip in viewports of any size and shape.

use gaitway_retarget::RestChoice;
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::state::{
    CameraChoice, CameraOptions, CharacterView, Command, Comparison, Edits, OrbitCamera, Playback, Playhead, UpAxis,
    ViewerState, apply, comparison_ratio, resolve_camera, resolved_bounds,
};
use glam::{Vec2, Vec3, Vec4Swizzles};

use crate::data::{moving_box, walker};

/// Returns how far the clip's bounds extend from the centre of the viewport; 1 is the edge.
fn reach(library: &gaitway_scene::library::Library, state: &ViewerState, aspect: f32) -> f32 {
    let mut frame = Frame::default();
    evaluate(library, state, aspect, &mut frame);
    let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
    let corners = resolved_bounds(library, state).corners();
    let clip_corners = corners.map(|corner| projection_from_world * corner.extend(1.0));
    assert!(clip_corners.iter().all(|corner| (0.0..=corner.w).contains(&corner.z)), "out of the depth range");
    clip_corners.iter().map(|corner| (corner.xy() / corner.w).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn the_whole_clip_is_in_view() {
    let far = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X * 10.0]);
    for library in [walker(), far] {
        for aspect in [0.4, 1.0, 16.0 / 9.0, 3.0] {
            for up in [UpAxis::Y, UpAxis::Z, UpAxis::MinusX] {
                let reach = reach(
                    &library,
                    &ViewerState {
                        character: CharacterView {
                            edits: Edits { up, ..Edits::default() },
                            ..CharacterView::default()
                        },
                        ..ViewerState::default()
                    },
                    aspect,
                );
                assert!((0.85..=1.0).contains(&reach), "aspect {aspect}, {up:?}: {reach}");
            }
        }
    }
}

#[test]
fn framing_keeps_the_direction() {
    let library = walker();
    let away = OrbitCamera { yaw_radians: 2.0, pitch_radians: 0.6, distance: 40.0, target: Vec3::splat(9.0) };
    let mut state = ViewerState { camera: CameraChoice::Orbit(away), ..ViewerState::default() };
    apply(&mut state, &library, Command::FrameAll);
    let CameraChoice::Orbit(framed) = state.camera else { panic!("{:?}", state.camera) };
    assert_eq!((framed.yaw_radians, framed.pitch_radians), (2.0, 0.6));
    assert!(reach(&library, &state, 1.0) <= 1.0);
}

#[test]
fn a_following_camera_stays_with_the_character() {
    let library = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::new(10.0, 2.0, -5.0)]);
    let follow = |time_secs| ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs, ..Playhead::default() },
            ..CharacterView::default()
        },
        camera_options: CameraOptions { follow: true, ..CameraOptions::default() },
        ..ViewerState::default()
    };
    let (mut start, mut end) = (Frame::default(), Frame::default());
    evaluate(&library, &follow(0.0), 1.0, &mut start);
    evaluate(&library, &follow(1.0), 1.0, &mut end);
    // Only horizontally: a jump stays visible.
    assert!((end.view.eye - start.view.eye).distance(Vec3::new(10.0, 0.0, -5.0)) < 1e-4);
    assert!((end.bounds.min - start.bounds.min).distance(Vec3::new(10.0, 0.0, -5.0)) < 1e-4);
    // Without root travel, the bounds are smaller.
    let near = resolve_camera(&library, &follow(0.0), 1.0).distance;
    let far = resolve_camera(&library, &ViewerState::default(), 1.0).distance;
    assert!(near < 0.6 * far, "{near} {far}");
}

#[test]
fn the_chosen_axis_points_up() {
    let library = moving_box(0.5, &[0.0], &[Vec3::new(1.0, 2.0, 3.0)]);
    for (up, expected) in [
        (UpAxis::X, 1.0),
        (UpAxis::Y, 2.0),
        (UpAxis::Z, 3.0),
        (UpAxis::MinusX, -1.0),
        (UpAxis::MinusY, -2.0),
        (UpAxis::MinusZ, -3.0),
    ] {
        let mut frame = Frame::default();
        evaluate(
            &library,
            &ViewerState {
                character: CharacterView { edits: Edits { up, ..Edits::default() }, ..CharacterView::default() },
                ..ViewerState::default()
            },
            1.0,
            &mut frame,
        );
        let world_from_joint = frame.characters[0].world_from_joint[0];
        assert!((world_from_joint.translation.y - expected).abs() < 1e-6, "{up:?}");
        assert!((world_from_joint.matrix3.determinant() - 1.0).abs() < 1e-6, "{up:?}");
    }
}

#[test]
fn zooming_keeps_the_point_under_the_pointer() {
    let library = walker();
    // Offset from the viewport's centre, in fractions of its height.
    let (pointer, aspect) = (Vec2::new(0.31, -0.22), 1.6);
    let mut state =
        ViewerState { playback: Playback { playing: false, ..Playback::default() }, ..ViewerState::default() };
    state.camera = CameraChoice::Orbit(resolve_camera(&library, &state, aspect));
    let view = |state: &ViewerState| {
        let mut frame = Frame::default();
        evaluate(&library, state, aspect, &mut frame);
        frame.view
    };
    let before = view(&state);
    let ndc = Vec2::new(2.0 * pointer.x / aspect, 2.0 * pointer.y);
    // The point in the plane of the target.
    let target = resolve_camera(&library, &state, aspect).target;
    let depth = (before.projection_from_view * before.view_from_world * target.extend(1.0)).xyzw();
    let projection_from_world = before.projection_from_view * before.view_from_world;
    let clip = glam::Vec4::new(ndc.x * depth.w, ndc.y * depth.w, depth.z, depth.w);
    let point = (projection_from_world.inverse() * clip).xyz();
    for factor in [0.5, 0.7, 2.5] {
        apply(&mut state, &library, Command::Zoom { factor, right: pointer.x, up: pointer.y });
        let now = view(&state);
        let seen = now.projection_from_view * now.view_from_world * point.extend(1.0);
        assert!((seen.xy() / seen.w).distance(ndc) < 1e-3, "{factor}: {:?} {ndc:?}", seen.xy() / seen.w);
    }
    // With a running turntable, the target is kept.
    state.camera_options.turntable = 6.0;
    let target = resolve_camera(&library, &state, aspect).target;
    apply(&mut state, &library, Command::Zoom { factor: 0.5, right: pointer.x, up: pointer.y });
    assert_eq!(resolve_camera(&library, &state, aspect).target, target);
}

#[test]
fn a_pane_shows_what_was_in_the_centre_of_the_viewport() {
    for aspect in [0.5, 1.0, 1.6] {
        let there = comparison_ratio(None, Some(Comparison::Skinning), aspect);
        let back = comparison_ratio(Some(Comparison::Skinning), None, aspect);
        assert!(there >= 1.0 && (there * back - 1.0).abs() < 1e-6, "{aspect}: {there} {back}");
        assert_eq!(comparison_ratio(None, Some(Comparison::Rests(RestChoice::Auto)), aspect), 1.0);
    }
    let ratio = comparison_ratio(None, Some(Comparison::Skinning), 1.5);
    assert!((ratio - 2.0).abs() < 1e-6, "panes are half as wide as high");
}
