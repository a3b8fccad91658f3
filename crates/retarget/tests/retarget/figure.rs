//! A small human figure made in code, and other rigs of it: with other joint axes, another rest, more or fewer joints,
//! other names, an armature on top. The motion of each body part is known, and with it the exact answer.

use std::collections::BTreeMap;

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Pose, SampleCursor, Skeleton, Transform,
};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use glam::{DQuat, DVec3, EulerRot, Quat, Vec3};

use crate::random::Random;

/// Slot, parent slot, and position in the T-pose in metres. The figure faces +Z.
pub const BODY: [(Slot, Option<Slot>, [f64; 3]); 22] = [
    (Slot::Hips, None, [0.0, 1.0, 0.0]),
    (Slot::Spine, Some(Slot::Hips), [0.0, 1.1, 0.0]),
    (Slot::Chest, Some(Slot::Spine), [0.0, 1.25, -0.01]),
    (Slot::Neck, Some(Slot::Chest), [0.0, 1.5, -0.01]),
    (Slot::Head, Some(Slot::Neck), [0.0, 1.6, 0.0]),
    (Slot::LeftUpperLeg, Some(Slot::Hips), [0.1, 0.95, 0.0]),
    (Slot::LeftLowerLeg, Some(Slot::LeftUpperLeg), [0.1, 0.5, 0.01]),
    (Slot::LeftFoot, Some(Slot::LeftLowerLeg), [0.1, 0.08, -0.02]),
    (Slot::LeftToes, Some(Slot::LeftFoot), [0.1, 0.02, 0.12]),
    (Slot::RightUpperLeg, Some(Slot::Hips), [-0.1, 0.95, 0.0]),
    (Slot::RightLowerLeg, Some(Slot::RightUpperLeg), [-0.1, 0.5, 0.01]),
    (Slot::RightFoot, Some(Slot::RightLowerLeg), [-0.1, 0.08, -0.02]),
    (Slot::RightToes, Some(Slot::RightFoot), [-0.1, 0.02, 0.12]),
    (Slot::LeftShoulder, Some(Slot::Chest), [0.05, 1.45, 0.0]),
    (Slot::LeftUpperArm, Some(Slot::LeftShoulder), [0.2, 1.45, 0.0]),
    (Slot::LeftLowerArm, Some(Slot::LeftUpperArm), [0.48, 1.45, 0.0]),
    (Slot::LeftHand, Some(Slot::LeftLowerArm), [0.74, 1.45, 0.0]),
    (Slot::RightShoulder, Some(Slot::Chest), [-0.05, 1.45, 0.0]),
    (Slot::RightUpperArm, Some(Slot::RightShoulder), [-0.2, 1.45, 0.0]),
    (Slot::RightLowerArm, Some(Slot::RightUpperArm), [-0.48, 1.45, 0.0]),
    (Slot::RightHand, Some(Slot::RightLowerArm), [-0.74, 1.45, 0.0]),
    (Slot::Jaw, Some(Slot::Head), [0.0, 1.62, 0.08]),
];

/// How a rig differs from the default one, whose axes are all the world's.
#[derive(Debug, Clone)]
pub struct Rig {
    /// Seed of a random orientation for every joint's axes; 0 for none.
    pub axes: u64,
    /// How far the arms hang down at rest.
    pub arms_down_degrees: f64,
    /// Slots without a joint.
    pub without: Vec<Slot>,
    /// Slots with an extra joint between them and their parent.
    pub doubled: Vec<Slot>,
    /// Prefix of all names.
    pub prefix: &'static str,
    /// Factor on all lengths.
    pub size: f64,
    /// Additional factor on the legs.
    pub leg_length: f64,
    /// Additional factor on the thighs; shins are shorter by as much.
    pub thigh_length: f64,
    /// An armature node on top: turned by −90° about X and scaled by 0.01, with joints in centimetres.
    pub armature: bool,
    /// Turn of the whole figure about +Y at rest.
    pub facing_degrees: f64,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            axes: 0,
            arms_down_degrees: 0.0,
            without: Vec::new(),
            doubled: Vec::new(),
            prefix: "",
            size: 1.0,
            leg_length: 1.0,
            thigh_length: 1.0,
            armature: false,
            facing_degrees: 0.0,
        }
    }
}

impl Random {
    pub fn rotation(&mut self, max_degrees: f64) -> DQuat {
        let axis = DVec3::new(self.f64() - 0.5, self.f64() - 0.5, self.f64() - 0.5);
        let angle = max_degrees.to_radians() * (2.0 * self.f64() - 1.0);
        DQuat::from_axis_angle(axis.normalize_or(DVec3::Y), angle)
    }
}

pub struct Figure {
    pub asset: Asset,
    pub slots: Humanoid,
    /// World rotation of each slot's joint when the body is in the T-pose, facing +Z.
    pub t_pose: BTreeMap<Slot, DQuat>,
}

/// Rotation of a slot at rest away from the T-pose.
fn lowered(slot: Slot, degrees: f64) -> DQuat {
    let name = slot.name();
    let arm = name.ends_with("UpperArm") || name.ends_with("LowerArm") || name.ends_with("Hand");
    match (arm, name.starts_with("left")) {
        (false, _) => DQuat::IDENTITY,
        (true, true) => DQuat::from_rotation_z(-degrees.to_radians()),
        (true, false) => DQuat::from_rotation_z(degrees.to_radians()),
    }
}

pub fn build(rig: &Rig) -> Figure {
    let mut builder = Builder::new(rig);
    for (slot, parent, _) in BODY {
        builder.add(slot, parent);
    }
    let skeleton = Skeleton::new(builder.joints).unwrap();
    let joint = |placed: &Placed| skeleton.joint_of_source(placed.joint).unwrap();
    let slots = Humanoid(builder.placed.iter().map(|(&slot, placed)| (slot, joint(placed))).collect());
    Figure { asset: Asset::from(skeleton), slots, t_pose: builder.t_pose }
}

/// A joint's index in the list, and its world rotation and position at rest.
#[derive(Clone, Copy)]
struct Placed {
    joint: usize,
    rotation: DQuat,
    position: DVec3,
}

struct Builder<'a> {
    rig: &'a Rig,
    random: Random,
    facing: DQuat,
    armature: Option<Placed>,
    joints: Vec<Joint>,
    placed: BTreeMap<Slot, Placed>,
    t_pose: BTreeMap<Slot, DQuat>,
}

impl<'a> Builder<'a> {
    fn new(rig: &'a Rig) -> Self {
        let mut builder = Self {
            rig,
            random: Random(rig.axes.wrapping_mul(7919)),
            facing: DQuat::from_rotation_y(rig.facing_degrees.to_radians()),
            armature: None,
            joints: Vec::new(),
            placed: BTreeMap::new(),
            t_pose: BTreeMap::new(),
        };
        if rig.armature {
            let rotation = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
            let rest = Transform { rotation: rotation.as_quat(), scale: Vec3::splat(0.01), ..Transform::IDENTITY };
            builder.joints.push(Joint { name: "Armature".into(), rest, ..Joint::default() });
            builder.armature = Some(Placed { joint: 0, rotation, position: DVec3::ZERO });
        }
        builder
    }

    /// Adds a slot's joint. Parents come first.
    fn add(&mut self, slot: Slot, parent: Option<Slot>) {
        let rig = self.rig;
        // Always drawn, so that other options do not change it.
        let axes = if rig.axes == 0 { DQuat::IDENTITY } else { self.random.rotation(180.0) };
        if rig.without.contains(&slot) {
            return;
        }
        let parent = self.nearest_present(parent);
        let above = parent.map(|parent| self.placed[&parent]).or(self.armature);
        let (mut parent_joint, mut parent_rotation, parent_position) = match above {
            Some(above) => (Some(above.joint), above.rotation, above.position),
            None => (None, DQuat::IDENTITY, DVec3::ZERO),
        };
        // From the parent in the T-pose, turned as the parent is at rest.
        let position = match parent {
            Some(parent) => {
                let lowered = lowered(parent, rig.arms_down_degrees);
                parent_position + self.facing * (lowered * (t_pose_position(rig, slot) - t_pose_position(rig, parent)))
            }
            None => self.facing * t_pose_position(rig, slot),
        };
        let rotation = self.facing * lowered(slot, rig.arms_down_degrees) * axes;
        self.t_pose.insert(slot, axes);
        let centimetres = if rig.armature { 100.0 } else { 1.0 };
        let mut step = (parent_rotation.conjugate() * (position - parent_position)) * centimetres;
        if rig.doubled.contains(&slot) {
            let extra = self.random.rotation(90.0);
            parent_joint = Some(self.push(format!("extra_{}", slot.name()), parent_joint, 0.4 * step, extra));
            step = extra.conjugate() * (0.6 * step);
            parent_rotation *= extra;
        }
        let joint = self.push(slot.name().to_owned(), parent_joint, step, parent_rotation.conjugate() * rotation);
        self.placed.insert(slot, Placed { joint, rotation, position });
    }

    /// The slot, or its nearest ancestor that the rig has.
    fn nearest_present(&self, mut slot: Option<Slot>) -> Option<Slot> {
        while let Some(missing) = slot.filter(|slot| self.rig.without.contains(slot)) {
            slot = BODY.iter().find(|(other, ..)| *other == missing).unwrap().1;
        }
        slot
    }

    fn push(&mut self, name: String, parent: Option<usize>, translation: DVec3, rotation: DQuat) -> usize {
        let (translation, rotation) = (translation.as_vec3(), rotation.as_quat());
        let rest = Transform { translation, rotation, ..Transform::IDENTITY };
        self.joints.push(Joint { name: format!("{}{name}", self.rig.prefix), parent, rest, ..Joint::default() });
        self.joints.len() - 1
    }
}

fn t_pose_position(rig: &Rig, slot: Slot) -> DVec3 {
    let (_, _, position) = BODY.iter().find(|(other, ..)| *other == slot).unwrap();
    let mut position = DVec3::from(*position);
    let hip = 0.95;
    if matches!(slot, Slot::LeftLowerLeg | Slot::RightLowerLeg) {
        position.y = hip - (hip - position.y) * rig.thigh_length;
    }
    if position.y < hip {
        // Longer or shorter, in the same direction.
        position.y = hip - (hip - position.y) * rig.leg_length;
        position.z *= rig.leg_length;
    }
    // On the ground, however long its legs.
    position.y += 0.93 * (rig.leg_length - 1.0);
    position * rig.size
}

impl Figure {
    pub fn joint(&self, slot: Slot) -> JointIndex {
        self.slots.joint(slot).unwrap()
    }

    /// World rotations (without scale) and positions of all joints.
    pub fn world(&self, clip: &Clip, time_secs: f32) -> Vec<(DQuat, DVec3)> {
        let skeleton = &self.asset.skeleton;
        let mut pose: Pose = skeleton.rest().clone();
        clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
        self.world_of(&pose)
    }

    /// World rotations (without scale) and positions of all joints in a pose.
    pub fn world_of(&self, pose: &Pose) -> Vec<(DQuat, DVec3)> {
        let skeleton = &self.asset.skeleton;
        let mut world: Vec<(DQuat, DVec3, f64)> = Vec::new();
        for (local, parent) in pose.locals().zip(skeleton.parents()) {
            let (turn, at, scale) = parent.map_or((DQuat::IDENTITY, DVec3::ZERO, 1.0), |parent| world[parent.get()]);
            let at = at + turn * (local.translation.as_dvec3() * scale);
            world.push(((turn * local.rotation.as_dquat()).normalize(), at, scale * f64::from(local.scale.x)));
        }
        world.into_iter().map(|(turn, at, _)| (turn, at)).collect()
    }

    /// Rotation of each slot's body part away from the T-pose, facing +Z.
    pub fn body_parts(&self, clip: &Clip, time_secs: f32) -> BTreeMap<Slot, DQuat> {
        let world = self.world(clip, time_secs);
        let turned = |(&slot, &joint): (&Slot, &JointIndex)| {
            (slot, (world[joint.get()].0 * self.t_pose[&slot].conjugate()).normalize())
        };
        self.slots.0.iter().map(turned).collect()
    }

    /// Adds a clip with random rotations of up to `degrees` from the rest on every slot, and travelling hips.
    pub fn dance(&mut self, seed: u64, degrees: f64, interpolation: Interpolation) {
        let mut random = Random(seed);
        let skeleton = &self.asset.skeleton;
        let mut clip = ClipBuilder::new("dance", skeleton);
        for (&slot, &joint) in &self.slots.0 {
            let keys = 4 + (random.f64() * 5.0) as usize;
            let times: Vec<f32> = (0..keys).map(|key| key as f32 * 1.5 / (keys - 1) as f32).collect();
            let rest = skeleton.rest().local(joint);
            let mut rotations: Vec<Quat> = Vec::new();
            let mut places: Vec<Vec3> = Vec::new();
            let hips = skeleton.parent(joint).map_or(1.0, |top| 1.0 / skeleton.rest().local(top).scale.x);
            for _ in 0..keys {
                let spline = interpolation == Interpolation::CubicSpline;
                let value = (random.rotation(degrees) * rest.rotation.as_dquat()).normalize().as_quat();
                let mut tangent = || Quat::from_euler(EulerRot::XYZ, random.f64() as f32, 0.3, -0.2) * 0.5;
                if spline {
                    rotations.extend([tangent(), value, tangent()]);
                } else {
                    rotations.push(value);
                }
                let mut wander = || Vec3::new(random.f64() as f32, random.f64() as f32, random.f64() as f32) * hips;
                if spline {
                    places.extend([wander(), rest.translation + 0.5 * wander(), wander()]);
                } else {
                    places.push(rest.translation + 0.5 * wander());
                }
            }
            clip.channel(joint, interpolation, &times, Keys::Rotation(rotations)).unwrap();
            if slot == Slot::Hips {
                clip.channel(joint, interpolation, &times, Keys::Translation(places)).unwrap();
            }
        }
        let clip = clip.build();
        self.set_clip(clip);
    }

    /// Replaces the clips by this one.
    pub fn set_clip(&mut self, clip: Clip) {
        let parts = std::mem::take(&mut self.asset).into_parts();
        self.asset = Asset::new(AssetParts { clips: vec![clip], ..parts }).unwrap();
    }
}
