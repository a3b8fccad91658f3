//! VRM 0.x and 1.0 except for the humanoid bones: `VRM`, `VRMC_vrm`, `VRMC_springBone`, `VRMC_node_constraint` and
//! `VRMC_vrm_animation`. An entry that refers to something missing is skipped with a warning; the model still loads.

mod constraints;
mod expressions;
mod look_at;
mod meta;
pub mod mtoon;
mod springs;

use gaitway_character::anim::{JointIndex, Keys, PropertyTarget, Skeleton};
use gaitway_character::asset::{Humanoid, MeshInstance, Warning, Warnings};
use gaitway_character::avatar::Avatar;
use gaitway_character::mesh::Material;
use glam::{EulerRot, Quat, Vec3};
use gltf::json::Root;
use serde_json::Value;

use super::loosen::whole;

/// Node constraints of glTF nodes, with or without a humanoid.
pub const NODE_CONSTRAINT: &str = "VRMC_node_constraint";
/// Spring bones of VRM 1.0.
pub const SPRING_BONE: &str = "VRMC_springBone";
/// Colliders that keep tails inside, and planes.
pub const EXTENDED_COLLIDER: &str = "VRMC_springBone_extended_collider";

/// The parts of the asset that the extensions refer to.
pub struct Context<'a> {
    pub root: &'a Root,
    pub skeleton: &'a Skeleton,
    pub instances: &'a [MeshInstance],
    pub materials: &'a [Material],
    pub humanoid: Option<&'a Humanoid>,
}

/// Nodes of a .vrma whose channels animate something other than joints.
#[derive(Default)]
pub struct AnimatedNodes {
    /// Nodes whose X translation is the weight of an expression, and its index.
    pub expressions: Vec<(JointIndex, usize)>,
    /// The node whose rotation is the gaze direction.
    pub look_at: Option<JointIndex>,
}

impl AnimatedNodes {
    /// Returns the property that a joint's keys animate, if any, and its values.
    pub fn property(&self, joint: JointIndex, keys: &Keys) -> Option<(PropertyTarget, Vec<f32>)> {
        match keys {
            Keys::Translation(values) => {
                let &(_, index) = self.expressions.iter().find(|(node, _)| *node == joint)?;
                Some((PropertyTarget::Expression(index), values.iter().map(|value| value.x).collect()))
            }
            Keys::Rotation(values) if self.look_at == Some(joint) => {
                let angles = |rotation: &Quat| {
                    let (yaw, pitch, _) = rotation.normalize().to_euler(EulerRot::YXZ);
                    [yaw.to_degrees(), pitch.to_degrees()]
                };
                Some((PropertyTarget::LookAt, values.iter().flat_map(angles).collect()))
            }
            _ => None,
        }
    }
}

/// Reads the avatar, and the nodes that animate it. Both are empty without VRM extensions.
pub fn read(context: &Context, warnings: &mut Warnings) -> (Avatar, AnimatedNodes) {
    let mut reader = Reader { context, warnings };
    let (mut avatar, mut animated) = (Avatar::default(), AnimatedNodes::default());
    if let Some(vrm) = reader.extension("VRMC_vrm") {
        expressions::read_1(&mut reader, vrm, &mut avatar.expressions);
        avatar.look_at = look_at::read_1(&mut reader, vrm, &avatar);
        meta::read(&mut reader, vrm, &mut avatar);
    }
    if let Some(vrm) = reader.extension("VRM") {
        expressions::read_0(&mut reader, vrm, &mut avatar.expressions);
        avatar.look_at = look_at::read_0(&mut reader, vrm, &avatar);
        meta::read(&mut reader, vrm, &mut avatar);
        avatar.springs = springs::read_0(&mut reader, vrm);
    }
    if let Some(vrma) = reader.extension("VRMC_vrm_animation") {
        animated.expressions = expressions::read_animated(&mut reader, vrma, &mut avatar.expressions);
        animated.look_at = reader.joint(&vrma["lookAt"]["node"]);
    }
    if let Some(springs) = reader.extension(SPRING_BONE) {
        avatar.springs = springs::read_1(&mut reader, springs);
    }
    avatar.constraints = constraints::read(&mut reader);
    (avatar, animated)
}

struct Reader<'a> {
    context: &'a Context<'a>,
    warnings: &'a mut Warnings,
}

impl<'a> Reader<'a> {
    fn extension(&self, name: &str) -> Option<&'a Value> {
        self.context.root.extensions.as_ref()?.others.get(name)
    }

    fn joint(&self, node: &Value) -> Option<JointIndex> {
        self.context.skeleton.joint_of_source(index(node)?)
    }

    /// Returns the joint of an entry's `node`; warns if there is none.
    fn joint_at(&mut self, place: &str, node: &Value) -> Option<JointIndex> {
        let joint = self.joint(node);
        if joint.is_none() {
            self.ignore(format!("{place}.node"), format!("expected the index of a node, found {node}; it is left out"));
        }
        joint
    }

    /// Returns the elements of an array, at most `max` of them; warns if there are more.
    fn list<'v>(&mut self, place: &str, value: &'v Value, max: usize) -> &'v [Value] {
        let all = list(value);
        if all.len() > max {
            self.ignore(
                place.to_owned(),
                format!("expected at most {max}, found {}; the others are left out", all.len()),
            );
        }
        &all[..all.len().min(max)]
    }

    fn ignore(&mut self, place: String, problem: String) {
        self.warnings.push(Warning::Other { code: "vrm-ignored", place, problem });
    }
}

fn index(value: &Value) -> Option<usize> {
    usize::try_from(whole(value)?).ok()
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

/// Returns the elements of an array; empty for any other value.
fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], |list| list)
}

/// Returns a member, or the default if it is missing or not a finite number.
fn number(value: &Value, key: &str, default: f32) -> f32 {
    let number = value[key].as_f64().map(|number| number as f32);
    number.filter(|number| number.is_finite()).unwrap_or(default)
}

/// Reads `[x, y, z]` or VRM 0.x's `{x, y, z}`; the default replaces missing components.
fn vector(value: &Value, default: Vec3) -> Vec3 {
    let component = |index: usize, name: &str| {
        let number = value.get(index).or_else(|| value.get(name)).and_then(Value::as_f64);
        number.map(|number| number as f32).filter(|number| number.is_finite()).unwrap_or(default[index])
    };
    Vec3::new(component(0, "x"), component(1, "y"), component(2, "z"))
}
