//! The humanoid bones that a file declares: `VRM` (0.x), `VRMC_vrm` (1.0) and `VRMC_vrm_animation`. VRM 0.x models face −Z and
//! 1.0 models +Z; the facing is found from the joints, not here.

use gaitway_character::anim::Skeleton;
use gaitway_character::asset::{Humanoid, Slot, Warning, Warnings};
use gltf::json::Root;
use serde_json::Value;

use super::loosen::whole;

/// `None` if the file declares no bones. A bone that is unknown or has no node is skipped with a warning.
pub fn humanoid(root: &Root, skeleton: &Skeleton, warnings: &mut Warnings) -> Option<Humanoid> {
    let mut humanoid = Humanoid::default();
    let mut add = |place: String, slot: Option<Slot>, bone: &str, node: Option<&Value>| {
        let joint = node.and_then(whole).and_then(|node| skeleton.joint_of_source(usize::try_from(node).ok()?));
        let problem = match (slot, joint) {
            (Some(slot), Some(joint)) => match humanoid.0.entry(slot) {
                std::collections::btree_map::Entry::Vacant(entry) => {
                    entry.insert(joint);
                    return;
                }
                std::collections::btree_map::Entry::Occupied(_) => format!("bone “{bone}” appears twice"),
            },
            (None, _) => format!("there is no humanoid bone “{bone}”"),
            (_, None) => format!("bone “{bone}” has no node of this file"),
        };
        warnings.push(Warning::Other { code: "humanoid-bone-ignored", place, problem });
    };
    for extension in ["VRMC_vrm", "VRMC_vrm_animation"] {
        let Some(bones) = human_bones(root, extension).and_then(Value::as_object) else { continue };
        for (bone, value) in bones {
            let place = format!("extensions.{extension}.humanoid.humanBones.{bone}");
            add(place, Slot::from_name(bone), bone, value.get("node"));
        }
    }
    if let Some(bones) = human_bones(root, "VRM").and_then(Value::as_array) {
        for (index, value) in bones.iter().enumerate() {
            let bone = value.get("bone").and_then(Value::as_str).unwrap_or_default();
            // Exporters write −1 for a bone that the model does not have.
            if value.get("node").and_then(Value::as_i64) == Some(-1) {
                continue;
            }
            let place = format!("extensions.VRM.humanoid.humanBones[{index}]");
            add(place, slot_of_vrm0(bone), bone, value.get("node"));
        }
    }
    (!humanoid.0.is_empty()).then_some(humanoid)
}

fn human_bones<'a>(root: &'a Root, name: &str) -> Option<&'a Value> {
    root.extensions.as_ref()?.others.get(name)?.get("humanoid")?.get("humanBones")
}

/// In VRM 0.x the first bone of a thumb is Proximal, in 1.0 it is Metacarpal.
fn slot_of_vrm0(bone: &str) -> Option<Slot> {
    Slot::from_name(match bone {
        "leftThumbProximal" => "leftThumbMetacarpal",
        "leftThumbIntermediate" => "leftThumbProximal",
        "rightThumbProximal" => "rightThumbMetacarpal",
        "rightThumbIntermediate" => "rightThumbProximal",
        same => same,
    })
}
