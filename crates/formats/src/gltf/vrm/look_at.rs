//! `lookAt` of VRM 1.0, `firstPerson` of 0.x.

use gaitway_character::asset::Slot;
use gaitway_character::avatar::{Avatar, LookAt, LookAtKind, RangeMaps};
use glam::Vec3;
use serde_json::Value;

use super::{Reader, number, text, vector};

pub fn read_1(reader: &mut Reader, vrm: &Value, avatar: &Avatar) -> Option<LookAt> {
    let value = vrm.get("lookAt")?;
    let has_bones = text(value, "type") != "expression";
    let offset = vector(&value["offsetFromHeadBone"], Vec3::new(0.0, 0.06, 0.0));
    let names = ["rangeMapHorizontalInner", "rangeMapHorizontalOuter", "rangeMapVerticalDown", "rangeMapVerticalUp"];
    let maps = range_maps(value, names, ["inputMaxValue", "outputScale"], has_bones);
    look_at(reader, avatar, has_bones, offset, maps, false)
}

/// Ignores the curves of 0.x: exporters write the default one, and 1.0 has none.
pub fn read_0(reader: &mut Reader, vrm: &Value, avatar: &Avatar) -> Option<LookAt> {
    let value = vrm.get("firstPerson")?;
    let has_bones = text(value, "lookAtTypeName") != "BlendShape";
    let mut offset = vector(&value["firstPersonBoneOffset"], Vec3::new(0.0, 0.06, 0.0));
    // Written for Unity, whose Z axis is mirrored.
    offset.z = -offset.z;
    let names = ["lookAtHorizontalInner", "lookAtHorizontalOuter", "lookAtVerticalDown", "lookAtVerticalUp"];
    let maps = range_maps(value, names, ["xRange", "yRange"], has_bones);
    look_at(reader, avatar, has_bones, offset, maps, true)
}

fn range_maps(value: &Value, names: [&str; 4], [input, output]: [&str; 2], has_bones: bool) -> RangeMaps {
    let [inner, outer, down, up] = names.map(|name| {
        let map = &value[name];
        [number(map, input, 90.0), number(map, output, if has_bones { 10.0 } else { 1.0 })]
    });
    RangeMaps { inner, outer, down, up }
}

/// Returns `None` without a head, or without any eyes or expressions to move.
fn look_at(
    reader: &Reader,
    avatar: &Avatar,
    has_bones: bool,
    offset: Vec3,
    maps: RangeMaps,
    faces_minus_z: bool,
) -> Option<LookAt> {
    let humanoid = reader.context.humanoid?;
    let head = humanoid.joint(Slot::Head)?;
    let kind = if has_bones {
        let eyes = [Slot::LeftEye, Slot::RightEye].map(|slot| humanoid.joint(slot));
        eyes.iter().any(Option::is_some).then_some(LookAtKind::Bones(eyes))?
    } else {
        let expressions = ["lookLeft", "lookRight", "lookUp", "lookDown"].map(|name| avatar.expression(name));
        expressions.iter().any(Option::is_some).then_some(LookAtKind::Expressions(expressions))?
    };
    Some(LookAt { head, offset, faces_minus_z, maps, kind })
}
