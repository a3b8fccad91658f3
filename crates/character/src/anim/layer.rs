//! Layers of poses: one pose blended over another or added to it, four joints at a time.
//!
//! Each layer changes the result of those below it, as Unity documents it ("Animation Layers" in its manual). The arithmetic
//! is that of ozz-animation: quaternions are negated where that shortens the arc and then interpolated linearly
//! (`BlendingJob`); what is added is `value - reference` of translations, `value * conjugate(reference)` of rotations and
//! `value / reference` of scales (`AdditiveAnimationBuilder`). Unlike there, rotations are normalized before they are
//! blended, since those of a [`Pose`] are shorter between keys.

use glam::{BVec4A, Vec4};

use super::kernels::{LANES, Quatx4, Transformx4, Vec3x4};
use super::{Pose, Skeleton};

/// The joints that a layer affects, and the morph weights of their meshes.
#[derive(Debug, Clone, Default)]
pub struct JointMask {
    /// One per group of a pose.
    lanes: Vec<BVec4A>,
    morph_weights: Vec<bool>,
}

impl JointMask {
    /// Creates the mask of some joints, given one flag per joint.
    pub fn new(skeleton: &Skeleton, included: &[bool]) -> Self {
        let rest = skeleton.rest();
        let mut lanes = vec![[false; LANES]; rest.groups.len()];
        let mut morph_weights = vec![false; rest.morph_weights.len()];
        for (joint, _) in skeleton.joints().zip(included).filter(|(_, included)| **included) {
            let (group, lane) = rest.place(joint);
            lanes[group][lane] = true;
            morph_weights[skeleton.morph_range(joint)].fill(true);
        }
        Self { lanes: lanes.into_iter().map(BVec4A::from_array).collect(), morph_weights }
    }

    fn of_groups(&self) -> impl Iterator<Item = (usize, BVec4A)> + '_ {
        self.lanes.iter().copied().enumerate().filter(|(_, lanes)| lanes.any())
    }

    fn of_morph_weights(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.morph_weights.len()).filter(|&index| self.morph_weights[index])
    }
}

impl Pose {
    /// Moves masked joints towards another pose of the same skeleton, rotations along the shorter arc. Weight 0 keeps
    /// `self` and weight 1 gives `layer`, bit for bit.
    pub fn override_with(&mut self, layer: &Pose, weight: f32, mask: &JointMask) {
        if weight <= 0.0 {
            return;
        }
        for (index, lanes) in mask.of_groups() {
            let (own, layer) = (&mut self.groups[index], &layer.groups[index]);
            let blended = if weight >= 1.0 { *layer } else { own.towards(layer, weight) };
            own.replace(lanes, blended);
        }
        for index in mask.of_morph_weights() {
            let (own, layer) = (&mut self.morph_weights[index], layer.morph_weights[index]);
            *own = if weight >= 1.0 { layer } else { *own + (layer - *own) * weight };
        }
    }

    /// Adds the difference between two other poses of the same skeleton to masked joints. Weight 0 keeps `self`, bit for
    /// bit, as does a `layer` that equals `reference`.
    pub fn add_layer(&mut self, layer: &Pose, reference: &Pose, weight: f32, mask: &JointMask) {
        if weight <= 0.0 {
            return;
        }
        for (index, lanes) in mask.of_groups() {
            let own = &mut self.groups[index];
            let sum = own.plus(&layer.groups[index], &reference.groups[index], weight);
            own.replace(lanes, sum);
        }
        for index in mask.of_morph_weights() {
            self.morph_weights[index] += (layer.morph_weights[index] - reference.morph_weights[index]) * weight;
        }
    }
}

impl Transformx4 {
    fn replace(&mut self, lanes: BVec4A, by: Self) {
        self.translation.replace(lanes, by.translation);
        self.rotation.replace(lanes, by.rotation);
        self.scale.replace(lanes, by.scale);
    }

    fn towards(&self, to: &Self, weight: f32) -> Self {
        let (from, arc) = (self.rotation.normalized(), to.rotation.normalized());
        let towards = Vec4::select(from.dot(&arc).cmplt(Vec4::ZERO), Vec4::splat(-weight), Vec4::splat(weight));
        Self {
            translation: self.translation.lerp(&to.translation, weight),
            rotation: from.map(&arc, |from, to| from * (1.0 - weight) + to * towards),
            scale: self.scale.lerp(&to.scale, weight),
        }
    }

    fn plus(&self, value: &Self, reference: &Self, weight: f32) -> Self {
        // Some exporters write a scale of zero as 1e-12.
        let is_zero = |scale: Vec4| scale.abs().cmplt(Vec4::splat(1e-6));
        let ratio = |value: Vec4, reference| Vec4::select(is_zero(reference), Vec4::ONE, value / reference);
        let translation = |own: Vec4, value: Vec4, reference: Vec4| own + (value - reference) * weight;
        let scale = |own: Vec4, value, reference| own * (Vec4::ONE + (ratio(value, reference) - Vec4::ONE) * weight);
        let turn = value.rotation.normalized().times(&reference.rotation.normalized().conjugate());
        Self {
            translation: self.translation.map(&value.translation, &reference.translation, translation),
            rotation: turn.normalized().part(weight).times(&self.rotation),
            scale: self.scale.map(&value.scale, &reference.scale, scale),
        }
    }
}

impl Vec3x4 {
    fn map(&self, b: &Self, c: &Self, of: impl Fn(Vec4, Vec4, Vec4) -> Vec4) -> Self {
        Self { x: of(self.x, b.x, c.x), y: of(self.y, b.y, c.y), z: of(self.z, b.z, c.z) }
    }
}

impl Quatx4 {
    fn map(&self, other: &Self, of: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self { x: of(self.x, other.x), y: of(self.y, other.y), z: of(self.z, other.z), w: of(self.w, other.w) }
    }

    fn dot(&self, other: &Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z + self.w * other.w
    }

    /// Divides instead of multiplying by the reciprocal, so that an identity stays one.
    fn normalized(&self) -> Self {
        let length = Vec4::from(self.dot(self).to_array().map(f32::sqrt));
        self.map(self, |part, _| part / length)
    }

    fn conjugate(&self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z, w: self.w }
    }

    /// The product, with the terms in such an order that a rotation times its own conjugate is real, whatever is rounded.
    fn times(&self, b: &Self) -> Self {
        let a = self;
        Self {
            x: a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            y: a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z,
            z: a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x,
            w: a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        }
    }

    /// A part of the rotation: from the identity along the shorter arc.
    fn part(&self, weight: f32) -> Self {
        let along = Vec4::select(self.w.cmplt(Vec4::ZERO), Vec4::splat(-weight), Vec4::splat(weight));
        let real = Vec4::splat(1.0 - weight);
        Self { x: self.x * along, y: self.y * along, z: self.z * along, w: real + self.w * along }.normalized()
    }
}
