//! Node constraints: rotation, roll and aim, and the order in which they apply.

use gaitway_scene::library::Library;
use gaitway_scene::state::ViewerState;
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{frame, is_near, joint, library, model, position, rotation};
use crate::build_gltf::Build;

/// Nodes `source` and `follower`, each with a rotated rest and a rotated parent.
pub fn constrained(constraint: Value) -> Build {
    let mut build = Build::new();
    let extension = json!({ "VRMC_node_constraint": { "specVersion": "1.0", "constraint": constraint } });
    build.json["nodes"] = json!([
        { "name": "left", "rotation": [0.0, 0.6, 0.0, 0.8], "translation": [1.0, 0.0, 0.0], "children": [2] },
        { "name": "right", "rotation": [0.6, 0.0, 0.0, 0.8], "translation": [-1.0, 0.5, 0.0], "children": [3] },
        { "name": "source", "rotation": [0.0, 0.0, 0.6, 0.8], "translation": [0.2, 0.3, 0.4] },
        { "name": "follower", "rotation": [0.28, 0.0, 0.0, 0.96], "extensions": extension },
    ]);
    build.json["extensionsUsed"] = json!(["VRMC_node_constraint"]);
    build
}

/// The index of the node `source` in [`constrained`].
pub const SOURCE: usize = 2;

/// The source posed manually.
fn turned_source() -> ViewerState {
    let mut state = ViewerState::default();
    state.character.edits.pose.insert(SOURCE, [40.0, -25.0, 60.0]);
    state
}

/// The source's rotation relative to its rest, in its local space.
fn turn(library: &Library, state: &ViewerState) -> Quat {
    let rest = model(library).asset.skeleton.rest().local(joint(library, "source")).rotation;
    rest.inverse() * rotation(library, &frame(library, state), "source")
}

#[test]
fn a_rotation_constraint_copies_the_rotation_of_its_source() {
    let rest = Quat::from_xyzw(0.28, 0.0, 0.0, 0.96);
    for weight in [0.0, 0.3, 1.0] {
        let library = library(constrained(json!({ "rotation": { "source": SOURCE, "weight": weight } })));
        let state = turned_source();
        let (axis, angle) = turn(&library, &state).to_axis_angle();
        let expected = rest * Quat::from_axis_angle(axis, angle * weight);
        let found = rotation(&library, &frame(&library, &state), "follower");
        assert!(is_near(found, expected), "{weight}: {found}, expected {expected}");
        assert!(is_near(rotation(&library, &frame(&library, &ViewerState::default()), "follower"), rest));
    }
}

/// The twist is that of a swing-twist decomposition.
#[test]
fn a_roll_constraint_takes_the_twist_about_its_axis() {
    let (rest, source_rest) = (Quat::from_xyzw(0.28, 0.0, 0.0, 0.96), Quat::from_xyzw(0.0, 0.0, 0.6, 0.8));
    for (name, axis) in [("X", Vec3::X), ("Y", Vec3::Y), ("Z", Vec3::Z)] {
        let library = library(constrained(json!({ "roll": { "source": SOURCE, "rollAxis": name } })));
        let state = turned_source();
        // In the follower's space; VRM ignores that the two parents differ.
        let in_parent = source_rest * turn(&library, &state) * source_rest.inverse();
        let delta = rest.inverse() * in_parent * rest;
        let along = axis * Vec3::new(delta.x, delta.y, delta.z).dot(axis);
        let twist = Quat::from_xyzw(along.x, along.y, along.z, delta.w).normalize();
        let found = rotation(&library, &frame(&library, &state), "follower");
        assert!(is_near(found, rest * twist), "{name}: {found}, expected {}", rest * twist);
    }
}

#[test]
fn an_aim_constraint_points_at_its_source() {
    let axes = [("PositiveX", Vec3::X), ("NegativeY", Vec3::NEG_Y), ("PositiveZ", Vec3::Z)];
    for (name, axis) in axes {
        let angle_at = |weight: f32| {
            let library =
                library(constrained(json!({ "aim": { "source": SOURCE, "aimAxis": name, "weight": weight } })));
            let frame = frame(&library, &turned_source());
            let world = frame.characters[0].world_from_joint[joint(&library, "follower").get()];
            let to_source = position(&library, &frame, "source") - position(&library, &frame, "follower");
            world.transform_vector3(axis).angle_between(to_source)
        };
        assert!(angle_at(1.0) < 1e-3, "{name}: {}", angle_at(1.0));
        assert!((angle_at(0.5) - 0.5 * angle_at(0.0)).abs() < 1e-3, "{name}: {}, {}", angle_at(0.5), angle_at(0.0));
    }
}

/// A rotation constraint, as a node's extensions.
fn rotation_of(source: usize) -> Value {
    json!({ "VRMC_node_constraint": { "specVersion": "1.0", "constraint": { "rotation": { "source": source } } } })
}

#[test]
fn constraints_apply_in_the_order_of_their_dependencies() {
    let mut build = Build::new();
    // The third follows the second, which follows the first, whatever their order in the file.
    build.json["nodes"] = json!([
        { "name": "third", "extensions": rotation_of(2) },
        { "name": "first" },
        { "name": "second", "extensions": rotation_of(1) },
    ]);
    let library = library(build);
    let mut state = ViewerState::default();
    state.character.edits.pose.insert(1, [30.0, 0.0, 0.0]);
    let turned = Quat::from_rotation_x(30.0_f32.to_radians());
    assert!(is_near(rotation(&library, &frame(&library, &state), "third"), turned));
}

#[test]
fn constraints_in_a_cycle_are_left_out() {
    let mut build = Build::new();
    build.json["nodes"] = json!([
        { "name": "a", "extensions": rotation_of(1) },
        { "name": "b", "extensions": rotation_of(0) },
        { "name": "c", "extensions": rotation_of(9) },
        { "name": "d", "extensions": { "VRMC_node_constraint": { "constraint": { "roll": { "rollAxis": "W" } } } } },
        { "name": "e", "extensions": rotation_of(3) },
    ]);
    let asset = build.loaded();
    assert_eq!(asset.avatar.constraints.len(), 1);
    assert_eq!(asset.warnings.iter().filter(|warning| warning.code() == "vrm-ignored").count(), 4);
}
