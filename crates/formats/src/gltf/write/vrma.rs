//! Writes a clip as a VRM animation (`VRMC_vrm_animation` 1.0): the humanoid bones in a T-pose that faces +Z, their rotations,
//! the position of the hips, and the weights of expressions.
//!
//! Players transfer each bone's rotation relative to this T-pose, in the axes of the model. Models that declare a humanoid rest
//! in it (VRM 0.x faces −Z). For others it is derived from their reference pose by straightening arms and legs; feet keep their
//! pitch. Bones in the file have no rest rotations, so their keys are the clip's keys, multiplied from both sides by constants.
//! Splines become linear keys: three-vrm-animation, which most players use, takes their tangents for keys. A mirrored model is
//! written as it is in the mirror.

use std::collections::BTreeMap;

use gaitway_character::anim::{
    Channel, Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Pose, Property, PropertyChannel,
    PropertyTarget, PropertyValues, SampleCursor, Skeleton, Transform, model_from_joint, model_from_single_joint,
};
use gaitway_character::asset::{Asset, Humanoid, Slot};
use gaitway_character::sort::{sort_by_key, sort_floats};
use glam::{Affine3A, DAffine3, DQuat, DVec3, EulerRot, Quat, Vec3};
use serde_json::{Map, Value, json};

use super::in_mirror::Body;
use super::motion::nodes_and_scenes;
use super::{WriteError, check_frames, clip, glb};

const EXTENSION: &str = "VRMC_vrm_animation";
/// Rate of keys where several channels move one bone, or a spline.
const RESAMPLED_PER_SEC: f32 = 60.0;
/// A recognized facing this close to an axis is snapped to it.
const FACING_TOLERANCE_RADIANS: f32 = 0.2;

/// Writes `clip` of `asset`, whose body has these `slots` and faces `forward`.
pub fn vrma(asset: &Asset, slots: &Humanoid, forward: Option<Vec3>, clip: &Clip) -> Result<Vec<u8>, WriteError> {
    let Body { skeleton, reference, clip, forward } = &Body::new(asset, clip, forward);
    let bones = bones(asset, skeleton, reference, slots, *forward);
    let bones = bones.ok_or_else(|| WriteError::NoBody { clip: clip.name().to_owned() })?;
    check_frames(clip, (clip.duration_secs() * RESAMPLED_PER_SEC) as usize, bones.len())?;
    let properties: Vec<_> =
        clip.properties().iter().filter(|channel| node_name(asset, channel.target).is_some()).collect();
    let mut joints: Vec<Joint> = bones.iter().map(|bone| bone.node(&bones)).collect();
    for channel in &properties {
        let name = node_name(asset, channel.target).unwrap_or_default();
        joints.push(Joint { name, ..Joint::default() });
    }
    let written_skeleton = Skeleton::new(joints).unwrap_or_default();
    let mut builder = ClipBuilder::new(clip.name(), &written_skeleton);
    let mut add = |node: usize, (interpolation, times, keys): NewKeys| {
        let Some(joint) = written_skeleton.joint_of_source(node) else { return };
        // Times are those of a valid clip.
        let added = builder.channel(joint, interpolation, &times, keys);
        debug_assert!(added.is_ok(), "{added:?}");
    };
    let source = Source { skeleton, clip };
    for (node, bone) in bones.iter().enumerate() {
        if let Some(keys) = source.rotations(bone, &bones) {
            add(node, keys);
        }
        if let Some(keys) = source.hips_positions(bone) {
            add(node, keys);
        }
    }
    for (at, channel) in properties.iter().enumerate() {
        add(bones.len() + at, source.property(channel));
    }
    let written = builder.build();
    let mut root = nodes_and_scenes(&Asset::default(), &written_skeleton);
    let targets = properties.iter().map(|channel| channel.target);
    root["extensionsUsed"] = json!([EXTENSION]);
    root["extensions"] = json!({ EXTENSION: extension(asset, &bones, targets) });
    let mut binary = Vec::new();
    let added = clip::add(&[&written], 1, &written_skeleton, false, clip::Counts::default(), &mut binary)?;
    root["animations"] = json!(added.animations);
    root["accessors"] = json!(added.accessors);
    root["bufferViews"] = json!(added.buffer_views);
    root["buffers"] = json!([{ "byteLength": binary.len() }]);
    glb::glb(root.to_string().into_bytes(), binary)
}

type NewKeys = (Interpolation, Vec<f32>, Keys);

/// A humanoid bone. Parents come first, the hips first of all.
struct Bone {
    slot: Slot,
    /// The joint whose rotation is written.
    joint: JointIndex,
    parent: Option<usize>,
    /// In the T-pose, in the space of the file.
    position: DVec3,
    /// The joint's rotation in the T-pose, in the space of the file.
    reference: DQuat,
    /// Turns the model until it faces +Z.
    file_from_model: DQuat,
}

impl Bone {
    fn node(&self, bones: &[Self]) -> Joint {
        let origin = self.parent.map_or(DVec3::ZERO, |parent| bones[parent].position);
        let rest = Transform::from_translation((self.position - origin).as_vec3());
        Joint { name: self.slot.name().to_owned(), parent: self.parent, rest, ..Joint::default() }
    }
}

/// Returns the bones from the hips outwards; `None` without hips. Eyes are left out: the gaze animates them.
fn bones(
    asset: &Asset,
    skeleton: &Skeleton,
    reference: &Pose,
    slots: &Humanoid,
    forward: Option<Vec3>,
) -> Option<Vec<Bone>> {
    let hips = slots.joint(Slot::Hips)?;
    let file_from_model = DQuat::from_rotation_y(-f64::from(facing_radians(asset, forward)));
    let mut world = Vec::new();
    model_from_joint(skeleton, reference, Affine3A::IDENTITY, &mut world);
    let position = |joint: JointIndex| file_from_model * world[joint.get()].translation.as_dvec3();
    let mut bones: Vec<Bone> = Vec::new();
    // Rotation of each bone from the reference pose to the T-pose, and the joint where the bone begins.
    let mut straightened: Vec<(DQuat, JointIndex)> = Vec::new();
    let written = slots.0.iter().filter(|(slot, _)| !matches!(slot, Slot::LeftEye | Slot::RightEye));
    let mut written: Vec<(Slot, JointIndex)> = written.map(|(&slot, &joint)| (slot, joint)).collect();
    let is_below_hips = |joint| chain(skeleton, joint).any(|above| above == hips);
    sort_by_key(&mut written, |&(_, joint)| (!is_below_hips(joint), joint));
    written.dedup_by_key(|&mut (_, joint)| joint);
    for (slot, joint) in written {
        let bone_of = |joint: JointIndex| bones.iter().position(|bone| bone.joint == joint);
        let above = chain(skeleton, joint).skip(1).find_map(bone_of);
        let parent = above.or_else(|| bone_of(slots.joint(limb_of(slot)?)?));
        if parent.is_none() && slot != Slot::Hips {
            continue;
        }
        let turned = parent.map_or(DQuat::IDENTITY, |parent| straightened[parent].0);
        let at = match parent {
            Some(parent) => bones[parent].position + turned * (position(joint) - position(straightened[parent].1)),
            None => position(joint),
        };
        let swing = straight(slot).filter(|_| asset.humanoid.is_none()).and_then(|(end, direction)| {
            let bone = turned * (position(slots.joint(end)?) - position(joint));
            Some(DQuat::from_rotation_arc(bone.try_normalize()?, direction))
        });
        let swung = match slot {
            Slot::LeftFoot | Slot::RightFoot => DQuat::IDENTITY,
            _ => swing.unwrap_or(DQuat::IDENTITY) * turned,
        };
        let (begin, joint) = (joint, rotating_joint(skeleton, slots, slot, joint));
        let rotation = world[joint.get()].to_scale_rotation_translation().1.as_dquat();
        // A bone that is scaled to 0 has no rotation.
        let rotation = if rotation.is_finite() { rotation } else { DQuat::IDENTITY };
        let reference = (swung * file_from_model * rotation).normalize();
        bones.push(Bone { slot, joint, parent, position: at, reference, file_from_model });
        straightened.push((swung, begin));
    }
    Some(bones)
}

/// Returns the joint whose rotation a bone gets. A neck is a single bone here: if it has several joints, it gets the rotation of the
/// last one, and so turns as far as the whole neck. Where it bends is lost.
fn rotating_joint(skeleton: &Skeleton, slots: &Humanoid, slot: Slot, joint: JointIndex) -> JointIndex {
    let below_head = slots.joint(Slot::Head).and_then(|head| skeleton.parent(head)).filter(|_| slot == Slot::Neck);
    below_head.filter(|&last| chain(skeleton, last).any(|above| above == joint)).unwrap_or(joint)
}

/// Returns the angle about Y from +Z to the direction that the model faces.
fn facing_radians(asset: &Asset, forward: Option<Vec3>) -> f32 {
    if asset.humanoid.is_some() {
        return if asset.avatar.spec_version.starts_with('0') { std::f32::consts::PI } else { 0.0 };
    }
    let angle = forward.map_or(0.0, |forward| forward.x.atan2(forward.z));
    let axis = (angle / std::f32::consts::FRAC_PI_2).round() * std::f32::consts::FRAC_PI_2;
    if (angle - axis).abs() <= FACING_TOLERANCE_RADIANS { axis } else { angle }
}

/// The joint and its ancestors.
fn chain(skeleton: &Skeleton, joint: JointIndex) -> impl Iterator<Item = JointIndex> {
    std::iter::successors(Some(joint), |&joint| skeleton.parent(joint))
}

/// Returns the bone that a foot or hand hangs on, also where the model's is beside its limb, left over from inverse kinematics.
fn limb_of(slot: Slot) -> Option<Slot> {
    use Slot::*;
    [(LeftFoot, LeftLowerLeg), (RightFoot, RightLowerLeg), (LeftHand, LeftLowerArm), (RightHand, RightLowerArm)]
        .into_iter()
        .find_map(|(end, limb)| (end == slot).then_some(limb))
}

/// Returns the end of a limb's bone, and the bone's direction in a T-pose that faces +Z.
fn straight(slot: Slot) -> Option<(Slot, DVec3)> {
    use Slot::*;
    Some(match slot {
        LeftUpperArm => (LeftLowerArm, DVec3::X),
        LeftLowerArm => (LeftHand, DVec3::X),
        RightUpperArm => (RightLowerArm, DVec3::NEG_X),
        RightLowerArm => (RightHand, DVec3::NEG_X),
        LeftUpperLeg => (LeftLowerLeg, DVec3::NEG_Y),
        LeftLowerLeg => (LeftFoot, DVec3::NEG_Y),
        RightUpperLeg => (RightLowerLeg, DVec3::NEG_Y),
        RightLowerLeg => (RightFoot, DVec3::NEG_Y),
        _ => return None,
    })
}

/// What is written.
struct Source<'a> {
    skeleton: &'a Skeleton,
    clip: &'a Clip,
}

impl Source<'_> {
    /// Returns the joints from the bone up to its parent bone, which is left out, or to the root if the parent bone is beside it.
    fn path(&self, bone: &Bone, bones: &[Bone]) -> Vec<JointIndex> {
        let end = bone.parent.map(|parent| bones[parent].joint);
        chain(self.skeleton, bone.joint).take_while(|&joint| Some(joint) != end).collect()
    }

    /// Returns the joints from the parent bone up to the root if the bone is beside it, otherwise none.
    fn path_beside(&self, bone: &Bone, bones: &[Bone]) -> Vec<JointIndex> {
        let parent = bone.parent.map(|parent| bones[parent].joint);
        let beside = parent.filter(|&parent| chain(self.skeleton, bone.joint).all(|joint| joint != parent));
        beside.map_or(Vec::new(), |parent| chain(self.skeleton, parent).collect())
    }

    /// Returns the channel in effect: the last one.
    fn channel(&self, joint: JointIndex, property: Property) -> Option<&Channel> {
        let fits = |channel: &&Channel| channel.joint == joint && channel.keys.property() == property;
        self.clip.channels().iter().rev().find(fits)
    }

    fn times(&self, channel: &Channel) -> &[f32] {
        &self.clip.timelines()[channel.timeline as usize]
    }

    fn rotations(&self, bone: &Bone, bones: &[Bone]) -> Option<NewKeys> {
        let (path, beside) = (self.path(bone, bones), self.path_beside(bone, bones));
        let before = bone.parent.map_or(bone.file_from_model, |parent| bones[parent].reference);
        let after = bone.reference.inverse();
        let joints = path.iter().chain(&beside);
        let moved: Vec<&Channel> = joints.filter_map(|&joint| self.channel(joint, Property::Rotation)).collect();
        let at_rest = |joints: &[JointIndex]| turn_of(self.skeleton.rest(), joints);
        match moved[..] {
            [] => {
                let turn = (before * at_rest(&beside).inverse() * at_rest(&path) * after).as_quat();
                let is_rest = turn.angle_between(Quat::IDENTITY) < 1e-5;
                (!is_rest).then(|| (Interpolation::Step, vec![0.0], Keys::Rotation(vec![turn.normalize()])))
            }
            [channel] if beside.is_empty() && channel.interpolation != Interpolation::CubicSpline => {
                let at = path.iter().position(|&joint| joint == channel.joint)?;
                let (before, after) = (before * at_rest(&path[at + 1..]), at_rest(&path[..at]) * after);
                let Keys::Rotation(keys) = &channel.keys else { return None };
                // Linear, so keys that aren't normalized stay what they are.
                let turned = keys.iter().map(|key| (before * key.as_dquat() * after).as_quat()).collect();
                Some((channel.interpolation, self.times(channel).to_vec(), Keys::Rotation(turned)))
            }
            _ => {
                let times = self.resampled_times(moved.into_iter());
                let mut last: Option<Quat> = None;
                let turned = self.sample(&times, |pose| {
                    let local = turn_of(pose, &beside).inverse() * turn_of(pose, &path);
                    let turn = (before * local * after).normalize().as_quat();
                    let turn = if last.is_some_and(|last| last.dot(turn) < 0.0) { -turn } else { turn };
                    last = Some(turn);
                    turn
                });
                Some((Interpolation::Linear, times, Keys::Rotation(turned)))
            }
        }
    }

    /// Returns the positions of the hips; `None` for other bones, and if nothing moves them.
    fn hips_positions(&self, bone: &Bone) -> Option<NewKeys> {
        if bone.slot != Slot::Hips {
            return None;
        }
        let own = self.channel(bone.joint, Property::Translation);
        let above = self.path(bone, &[]);
        let carried = above[1..].iter().flat_map(|&joint| {
            [Property::Translation, Property::Rotation, Property::Scale].map(|property| self.channel(joint, property))
        });
        let carried: Vec<&Channel> = carried.flatten().collect();
        let turn = DAffine3::from_quat(bone.file_from_model);
        let is_spline = own.is_some_and(|own| own.interpolation == Interpolation::CubicSpline);
        if is_spline || !carried.is_empty() {
            let times = self.resampled_times(carried.into_iter().chain(own));
            let positions = self.sample(&times, |pose| {
                let world = model_from_single_joint(self.skeleton, pose, bone.joint);
                turn.transform_vector3(world.translation.as_dvec3()).as_vec3()
            });
            return Some((Interpolation::Linear, times, Keys::Translation(positions)));
        }
        let own = own?;
        let Keys::Translation(keys) = &own.keys else { return None };
        let file_from_parent = match self.skeleton.parent(bone.joint) {
            Some(parent) => {
                let world = model_from_single_joint(self.skeleton, self.skeleton.rest(), parent);
                turn * DAffine3::from_mat4(glam::Mat4::from(world).as_dmat4())
            }
            None => turn,
        };
        let placed = keys.iter().map(|key| file_from_parent.transform_point3(key.as_dvec3()).as_vec3());
        Some((own.interpolation, self.times(own).to_vec(), Keys::Translation(placed.collect())))
    }

    /// Returns the keys of a property's node: the weight of an expression is the X of a translation, the gaze is a rotation.
    fn property(&self, channel: &PropertyChannel) -> NewKeys {
        let own_times = &self.clip.property_timelines()[channel.timeline as usize];
        let width = channel.target.width();
        let (interpolation, times, values) = match channel.interpolation {
            Interpolation::CubicSpline => {
                let times = resampled_times(own_times.clone());
                let (mut cursor, mut values) = (SampleCursor::default(), PropertyValues::default());
                let sample = |&time: &f32| {
                    self.clip.sample_properties(time, &mut cursor, &mut values);
                    values.get(channel.target).unwrap_or_default().to_array().into_iter().take(width)
                };
                let values = times.iter().flat_map(sample).collect();
                (Interpolation::Linear, times, values)
            }
            interpolation => (interpolation, own_times.clone(), channel.values.clone()),
        };
        let keys = if channel.target == PropertyTarget::LookAt {
            let angles = values.as_chunks::<2>().0.iter();
            let rotation =
                |[yaw, pitch]: &[f32; 2]| Quat::from_euler(EulerRot::YXZ, yaw.to_radians(), pitch.to_radians(), 0.0);
            Keys::Rotation(angles.map(rotation).collect())
        } else {
            Keys::Translation(values.iter().map(|&weight| Vec3::new(weight, 0.0, 0.0)).collect())
        };
        (interpolation, times, keys)
    }

    fn resampled_times<'a>(&self, channels: impl Iterator<Item = &'a Channel>) -> Vec<f32> {
        resampled_times(channels.flat_map(|channel| self.times(channel)).copied().collect())
    }

    fn sample<T>(&self, times: &[f32], mut value: impl FnMut(&Pose) -> T) -> Vec<T> {
        let (mut pose, mut cursor) = (self.skeleton.rest().clone(), SampleCursor::default());
        let sample = |&time: &f32| {
            pose.copy_from(self.skeleton.rest());
            self.clip.sample(self.skeleton, time, &mut cursor, &mut pose);
            value(&pose)
        };
        times.iter().map(sample).collect()
    }
}

/// Adds the frames of [`RESAMPLED_PER_SEC`] until the last of `times`.
fn resampled_times(mut times: Vec<f32>) -> Vec<f32> {
    let last = times.iter().copied().fold(0.0, f32::max);
    times.extend((0..=(last * RESAMPLED_PER_SEC) as usize).map(|frame| frame as f32 / RESAMPLED_PER_SEC));
    sort_floats(&mut times);
    times.dedup();
    times
}

/// Product of the joints' rotations, the topmost of which is the last.
fn turn_of(pose: &Pose, joints: &[JointIndex]) -> DQuat {
    let rotation = |&joint: &JointIndex| pose.local(joint).rotation.as_dquat().normalize();
    joints.iter().map(rotation).fold(DQuat::IDENTITY, |below, above| above * below)
}

/// Returns the name of the node that animates a property; `None` if VRM animations can't animate it.
fn node_name(asset: &Asset, target: PropertyTarget) -> Option<String> {
    match target {
        PropertyTarget::Expression(index) => Some(asset.avatar.expressions.get(index)?.name.clone()),
        PropertyTarget::LookAt => Some("lookAt".to_owned()),
        _ => None,
    }
}

fn extension(asset: &Asset, bones: &[Bone], targets: impl Iterator<Item = PropertyTarget>) -> Value {
    let human: Map<String, Value> =
        bones.iter().enumerate().map(|(node, bone)| (bone.slot.name().to_owned(), json!({ "node": node }))).collect();
    let mut extension = json!({ "specVersion": "1.0", "humanoid": { "humanBones": human } });
    let mut expressions: BTreeMap<&str, Map<String, Value>> = BTreeMap::new();
    for (at, target) in targets.enumerate() {
        let node = json!({ "node": bones.len() + at });
        match target {
            PropertyTarget::Expression(index) => {
                let expression = &asset.avatar.expressions[index];
                let kind = if expression.is_preset { "preset" } else { "custom" };
                expressions.entry(kind).or_default().insert(expression.name.clone(), node);
            }
            _ => extension["lookAt"] = node,
        }
    }
    if !expressions.is_empty() {
        extension["expressions"] = json!(expressions);
    }
    extension
}
