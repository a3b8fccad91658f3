//! A small human figure made in code, and re-rigs of it: other joint axes, another rest, more joints or fewer, other names,
//! an armature on top. What the flesh should do is known, so the exact answer is.

use std::collections::BTreeMap;

use gaitway::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Pose, SampleCursor, Skeleton, Transform,
};
use gaitway::asset::{Asset, AssetParts, Humanoid, Slot};
use glam::{DQuat, DVec3, EulerRot, Quat, Vec3};

use crate::random::Random;

/// Slot, parent slot, place in the world at the T-pose, metres; faces +Z.
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

/// How a rig differs from the plain one, which has all axes along the world's.
#[derive(Debug, Clone)]
pub struct Rig {
    /// Seeds a random orientation of every joint's axes; 0: none.
    pub axes: u64,
    /// Degrees by which the upper arms hang down at the rest.
    pub arms_down_degrees: f64,
    /// Parts that have no joint.
    pub without: Vec<Slot>,
    /// A joint more between each of these and its parent.
    pub doubled: Vec<Slot>,
    /// Prefix of all names.
    pub prefix: &'static str,
    /// Factor on all lengths, and on those below the hips' sides besides.
    pub size: f64,
    pub leg_length: f64,
    /// An armature node on top: turned by −90° about X, scaled by 0.01, the joints below in centimetres.
    pub armature: bool,
    /// Degrees that the figure is turned about +Y at its rest.
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
            armature: false,
            facing_degrees: 0.0,
        }
    }
}

impl Random {
    pub fn rotation(&mut self, most_degrees: f64) -> DQuat {
        let axis = DVec3::new(self.f64() - 0.5, self.f64() - 0.5, self.f64() - 0.5);
        let angle = most_degrees.to_radians() * (2.0 * self.f64() - 1.0);
        DQuat::from_axis_angle(axis.normalize_or(DVec3::Y), angle)
    }
}

pub struct Figure {
    pub asset: Asset,
    pub slots: Humanoid,
    /// World rotation of each slot's joint when the flesh stands in the T-pose facing +Z.
    pub t_pose: BTreeMap<Slot, DQuat>,
}

/// The rest's own turn away from the T-pose, of the arms.
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
    let mut random = Random(rig.axes.wrapping_mul(7919));
    let facing = DQuat::from_rotation_y(rig.facing_degrees.to_radians());
    let armature = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let mut joints: Vec<Joint> = Vec::new();
    // Of each slot: the joint that has it, its world rotation and place at the rest.
    let mut made: BTreeMap<Slot, (usize, DQuat, DVec3)> = BTreeMap::new();
    let mut t_pose = BTreeMap::new();
    let top = if rig.armature {
        let rest = Transform { rotation: armature.as_quat(), scale: Vec3::splat(0.01), ..Transform::IDENTITY };
        joints.push(Joint { name: "Armature".into(), rest, ..Joint::default() });
        Some((0, armature, DVec3::ZERO))
    } else {
        None
    };
    let unit = if rig.armature { 100.0 } else { 1.0 };
    let place = |slot: Slot| {
        let (_, _, at) = BODY.iter().find(|(other, ..)| *other == slot).unwrap();
        let mut at = DVec3::from(*at);
        let hip = 0.95;
        if at.y < hip {
            // Directions stay: only lengths differ.
            at.y = hip - (hip - at.y) * rig.leg_length;
            at.z *= rig.leg_length;
        }
        // Stands on the ground whatever its legs.
        at.y += 0.93 * (rig.leg_length - 1.0);
        at * rig.size
    };
    for (slot, parent, _) in BODY {
        // Always drawn, so that other options do not change it.
        let axes = if rig.axes == 0 { DQuat::IDENTITY } else { random.rotation(180.0) };
        if rig.without.contains(&slot) {
            continue;
        }
        let mut above = parent;
        while let Some(missing) = above.filter(|slot| rig.without.contains(slot)) {
            above = BODY.iter().find(|(other, ..)| *other == missing).unwrap().1;
        }
        let (mut parent_joint, mut parent_turn, parent_at) = match above {
            Some(above) => {
                let (joint, turn, at) = made[&above];
                (Some(joint), turn, at)
            }
            None => match top {
                Some((joint, turn, at)) => (Some(joint), turn, at),
                None => (None, DQuat::IDENTITY, DVec3::ZERO),
            },
        };
        // From the parent in the T-pose, turned as the parent's flesh is at the rest.
        let at = match above {
            Some(above) => {
                let lowered = lowered(above, rig.arms_down_degrees);
                parent_at + facing * (lowered * (place(slot) - place(above)))
            }
            None => facing * place(slot),
        };
        let upright = axes;
        let turn = facing * lowered(slot, rig.arms_down_degrees) * upright;
        t_pose.insert(slot, upright);
        let mut step = (parent_turn.conjugate() * (at - parent_at)) * unit;
        if rig.doubled.contains(&slot) {
            let extra = random.rotation(90.0);
            let rest =
                Transform { translation: (0.4 * step).as_vec3(), rotation: extra.as_quat(), ..Transform::IDENTITY };
            joints.push(Joint {
                name: format!("{}extra_{}", rig.prefix, slot.name()),
                parent: parent_joint,
                rest,
                ..Joint::default()
            });
            parent_joint = Some(joints.len() - 1);
            step = extra.conjugate() * (0.6 * step);
            parent_turn *= extra;
        }
        let rest = Transform {
            translation: step.as_vec3(),
            rotation: (parent_turn.conjugate() * turn).as_quat(),
            ..Transform::IDENTITY
        };
        joints.push(Joint {
            name: format!("{}{}", rig.prefix, slot.name()),
            parent: parent_joint,
            rest,
            ..Joint::default()
        });
        made.insert(slot, (joints.len() - 1, turn, at));
    }
    let skeleton = Skeleton::new(joints).unwrap();
    let slots = Humanoid(made.iter().map(|(&slot, made)| (slot, skeleton.joint_of_source(made.0).unwrap())).collect());
    Figure { asset: Asset::from(skeleton), slots, t_pose }
}

impl Figure {
    pub fn joint(&self, slot: Slot) -> JointIndex {
        self.slots.joint(slot).unwrap()
    }

    /// World rotations (without scale) and places of all joints.
    pub fn world(&self, clip: &Clip, time_secs: f32) -> Vec<(DQuat, DVec3)> {
        let skeleton = &self.asset.skeleton;
        let mut pose: Pose = skeleton.rest().clone();
        clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
        let mut world: Vec<(DQuat, DVec3, f64)> = Vec::new();
        for (local, parent) in pose.locals.iter().zip(skeleton.parents()) {
            let (turn, at, scale) = parent.map_or((DQuat::IDENTITY, DVec3::ZERO, 1.0), |parent| world[parent.get()]);
            let at = at + turn * (local.translation.as_dvec3() * scale);
            world.push(((turn * local.rotation.as_dquat()).normalize(), at, scale * f64::from(local.scale.x)));
        }
        world.into_iter().map(|(turn, at, _)| (turn, at)).collect()
    }

    /// How far the flesh of each part is turned away from the T-pose facing +Z.
    pub fn flesh(&self, clip: &Clip, time_secs: f32) -> BTreeMap<Slot, DQuat> {
        let world = self.world(clip, time_secs);
        let turned = |(&slot, &joint): (&Slot, &JointIndex)| {
            (slot, (world[joint.get()].0 * self.t_pose[&slot].conjugate()).normalize())
        };
        self.slots.0.iter().map(turned).collect()
    }

    /// A lively clip on all joints with a slot: rotations of up to `degrees` about the rest, and the hips wander.
    pub fn dance(&mut self, seed: u64, degrees: f64, interpolation: Interpolation) {
        let mut random = Random(seed);
        let skeleton = &self.asset.skeleton;
        let mut clip = ClipBuilder::new("dance", skeleton);
        for (&slot, &joint) in &self.slots.0 {
            let keys = 4 + (random.f64() * 5.0) as usize;
            let times: Vec<f32> = (0..keys).map(|key| key as f32 * 1.5 / (keys - 1) as f32).collect();
            let rest = skeleton.rest().locals[joint.get()];
            let mut rotations: Vec<Quat> = Vec::new();
            let mut places: Vec<Vec3> = Vec::new();
            let hips = skeleton.parent(joint).map_or(1.0, |top| 1.0 / skeleton.rest().locals[top.get()].scale.x);
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
