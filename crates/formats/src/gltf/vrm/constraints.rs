//! `VRMC_node_constraint`, a node extension.

use gaitway_character::avatar::{Constraint, ConstraintKind, sort_constraints};
use glam::Vec3;
use serde_json::Value;

use super::{NODE_CONSTRAINT, Reader, number, text};

/// Further constraints are skipped: sorting them takes quadratic time or more.
const MAX_CONSTRAINTS: usize = 512;

pub fn read(reader: &mut Reader) -> Vec<Constraint> {
    let mut constraints = Vec::new();
    for (node, value) in reader.context.root.nodes.iter().enumerate() {
        let extension = value.extensions.as_ref().and_then(|all| all.others.get(NODE_CONSTRAINT));
        let Some(value) = extension.map(|extension| &extension["constraint"]) else { continue };
        let place = || format!("nodes[{node}].extensions.{NODE_CONSTRAINT}.constraint");
        let Some(joint) = reader.context.skeleton.joint_of_source(node) else { continue };
        let Some((value, kind)) = kind(value) else {
            reader.ignore(place(), "expected roll, aim or rotation; it is left out".to_owned());
            continue;
        };
        let source = reader.joint(&value["source"]).filter(|&source| source != joint);
        let Some(source) = source.filter(|_| constraints.len() < MAX_CONSTRAINTS) else {
            let problem =
                format!("expected the index of another node as source, found {}; it is left out", value["source"]);
            reader.ignore(place(), problem);
            continue;
        };
        let weight = number(value, "weight", 1.0).clamp(0.0, 1.0);
        constraints.push(Constraint { joint, source, weight, kind });
    }
    let (sorted, cyclic) = sort_constraints(reader.context.skeleton, constraints);
    for constraint in cyclic {
        let node = reader.context.skeleton.source_index(constraint.joint);
        let problem = "the constraint depends on a cycle of constraints; it is left out".to_owned();
        reader.ignore(format!("nodes[{node}].extensions.{NODE_CONSTRAINT}"), problem);
    }
    sorted
}

fn kind(value: &Value) -> Option<(&Value, ConstraintKind)> {
    if let Some(roll) = value.get("roll") {
        let axis = match text(roll, "rollAxis") {
            "X" => Vec3::X,
            "Y" => Vec3::Y,
            "Z" => Vec3::Z,
            _ => return None,
        };
        Some((roll, ConstraintKind::Roll(axis)))
    } else if let Some(aim) = value.get("aim") {
        let axis = match text(aim, "aimAxis") {
            "PositiveX" => Vec3::X,
            "NegativeX" => Vec3::NEG_X,
            "PositiveY" => Vec3::Y,
            "NegativeY" => Vec3::NEG_Y,
            "PositiveZ" => Vec3::Z,
            "NegativeZ" => Vec3::NEG_Z,
            _ => return None,
        };
        Some((aim, ConstraintKind::Aim(axis)))
    } else {
        Some((value.get("rotation")?, ConstraintKind::Rotation))
    }
}
