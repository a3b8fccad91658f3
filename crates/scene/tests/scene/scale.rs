//! Models of 2 mm and of 200 m look the same.

use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::Library;
use gaitway_scene::state::ViewerState;
use glam::{Mat4, Vec3};

use crate::data::moving_box;

fn of_size(size: f32) -> Library {
    moving_box(0.5 * size, &[0.0, 1.0], &[Vec3::ZERO, Vec3::Y * size])
}

fn projected(library: &Library, size: f32) -> Vec<Vec3> {
    let mut frame = Frame::default();
    evaluate(library, &ViewerState::default(), 1.5, &mut frame);
    let projection_from_world: Mat4 = frame.view.projection_from_view * frame.view.view_from_world;
    frame
        .bounds
        .corners()
        .map(|corner| projection_from_world.project_point3(corner))
        .into_iter()
        .chain([
            // Points on the ground, from under the model towards the horizon.
            projection_from_world.project_point3(frame.look.grid.expect("a grid").center),
            Vec3::new(0.0, frame.look.grid.expect("a grid").radius / size, 0.0),
        ])
        .collect()
}

#[test]
fn the_image_does_not_depend_on_size() {
    let expected = projected(&of_size(2.0), 2.0);
    for size in [0.002, 200.0] {
        for (point, expected) in projected(&of_size(size), size).into_iter().zip(&expected) {
            assert!(point.distance(*expected) < 1e-4, "{size} m: {point} instead of {expected}");
        }
    }
}

#[test]
fn depth_resolves_a_thousandth_of_the_model() {
    for size in [0.002, 2.0, 200.0] {
        let library = of_size(size);
        let mut frame = Frame::default();
        evaluate(&library, &ViewerState::default(), 1.5, &mut frame);
        let view = frame.view;
        let middle = (view.view_from_world * frame.bounds.center().extend(1.0)).truncate();
        let depth = |point: Vec3| view.projection_from_view.project_point3(point).z;
        let step = (depth(middle - Vec3::Z * 1e-3 * size) - depth(middle)).abs();
        // A 24-bit depth buffer has steps of 6e-8.
        assert!(step > 1e-6, "{size} m: {step}");
    }
}

#[test]
fn grid_lines_are_a_power_of_ten_apart() {
    for (size, expected) in [(0.002, 1e-3), (2.0, 1.0), (200.0, 100.0)] {
        let mut frame = Frame::default();
        evaluate(&of_size(size), &ViewerState::default(), 1.0, &mut frame);
        let spacing = frame.look.grid.expect("a grid").spacing;
        assert!((spacing / expected - 1.0).abs() < 1e-5, "{size} m: {spacing}");
    }
}
