//! Spring bones (`VRMC_springBone-1.0`, `VRMC_springBone_extended_collider-1.0`; `secondaryAnimation` of VRM 0.x):
//! chains of joints that swing, simulated by Verlet integration of their tails. This file takes one step;
//! `spring_cache` decides which steps to take.

use glam::{Affine3A, Quat, Vec3};

use crate::anim::{JointIndex, Pose, Skeleton};

/// Length in metres of a bone without a child joint (VRM 0.x).
const END_LENGTH: f32 = 0.07;

/// Maximum number of joints between the two ends of a bone.
const MAX_BONE_LEVELS: usize = 256;

/// The spring bones of a model and their colliders.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Springs {
    joints: Vec<SpringJoint>,
    colliders: Vec<Collider>,
    /// Spring joints and their descendants, parents first. A spring joint has its index in `joints`.
    moved: Vec<(JointIndex, Option<u32>)>,
}

/// A joint that swings. Lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct SpringJoint {
    /// The joint that rotates.
    pub joint: JointIndex,
    /// The point that swings, at rest, in the joint's space.
    pub tail: Vec3,
    /// Pull towards the rest direction, in metres per second.
    pub stiffness: f32,
    /// Gravity direction times power, in metres per second.
    pub gravity: Vec3,
    /// Fraction of the velocity lost in each step, 0 to 1.
    pub drag: f32,
    /// Radius of the tail for collisions.
    pub radius: f32,
    /// The tail's inertia is relative to this joint instead of the world.
    pub center: Option<JointIndex>,
    /// Indices into [`Springs::colliders`].
    pub colliders: Vec<u32>,
}

/// A shape that tails collide with, in the space of a joint. The radius is in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collider {
    /// The joint it is attached to.
    pub joint: JointIndex,
    /// Centre of a sphere, one end of a capsule, or a point on a plane.
    pub offset: Vec3,
    /// The other end of a capsule; equal to the offset for a sphere.
    pub tail: Vec3,
    /// Radius of a sphere or capsule.
    pub radius: f32,
    /// Whether the shape keeps tails inside rather than outside.
    pub inside: bool,
    /// Makes the shape a plane: tails stay on the side that the normal points to.
    pub normal: Option<Vec3>,
}

/// The state of one tail, in the space of the spring's centre joint or, without one, in world space.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Tail {
    position: Vec3,
    previous: Vec3,
}

impl Springs {
    /// Sorts the joints so that parents come first. If a joint has several springs, only the first is kept. The caller
    /// checks the indices of `colliders`.
    pub fn new(skeleton: &Skeleton, mut joints: Vec<SpringJoint>, colliders: Vec<Collider>) -> Self {
        joints.sort_by_key(|spring| spring.joint);
        joints.dedup_by_key(|spring| spring.joint);
        let mut is_moved = vec![false; skeleton.len()];
        let mut moved = Vec::new();
        for joint in skeleton.joints() {
            let spring = joints.binary_search_by_key(&joint, |spring| spring.joint).ok();
            let parent_moves = skeleton.parent(joint).is_some_and(|parent| is_moved[parent.get()]);
            if spring.is_some() || parent_moves {
                is_moved[joint.get()] = true;
                moved.push((joint, spring.map(|index| index as u32)));
            }
        }
        Self { joints, colliders, moved }
    }

    /// The joints that swing, parents first.
    pub fn joints(&self) -> &[SpringJoint] {
        &self.joints
    }

    /// The shapes that tails collide with.
    pub fn colliders(&self) -> &[Collider] {
        &self.colliders
    }

    /// Returns every joint that the springs refer to.
    pub(super) fn all_joints(&self) -> impl Iterator<Item = JointIndex> + '_ {
        let springs = self.joints.iter().flat_map(|spring| [Some(spring.joint), spring.center]);
        springs.flatten().chain(self.colliders.iter().map(|collider| collider.joint))
    }

    /// Puts all tails at their rest positions in a pose, without velocity. `world` has one transform per joint.
    pub(super) fn reset(&self, world: &[Affine3A], tails: &mut [Tail]) {
        for (spring, tail) in self.joints.iter().zip(tails) {
            let at_rest = world[spring.joint.get()].transform_point3(spring.tail);
            let position = spring.center_from_world(world).transform_point3(at_rest);
            *tail = Tail { position, previous: position };
        }
    }

    /// Moves all tails by the displacement of their joints between two poses, without adding velocity.
    pub(super) fn teleport(&self, from: &[Affine3A], to: &[Affine3A], tails: &mut [Tail]) {
        for (spring, tail) in self.joints.iter().zip(tails) {
            let [old, new] = [from, to]
                .map(|world| spring.center_from_world(world).transform_point3a(world[spring.joint.get()].translation));
            let offset = Vec3::from(new - old);
            *tail = Tail { position: tail.position + offset, previous: tail.previous + offset };
        }
    }

    /// Takes a step of `step_secs`. Expects the clip's `pose` and `world` transforms; updates the transforms of
    /// swinging joints and their descendants. Writes the local rotation of each spring joint to `rotations`.
    pub(super) fn step(
        &self,
        skeleton: &Skeleton,
        step_secs: f32,
        pose: &Pose,
        world: &mut [Affine3A],
        tails: &mut [Tail],
        rotations: &mut [Quat],
    ) {
        for &(joint, spring) in &self.moved {
            let world_from_parent = skeleton.parent(joint).map_or(Affine3A::IDENTITY, |parent| world[parent.get()]);
            let mut local = pose.local(joint);
            if let Some(index) = spring.map(|index| index as usize) {
                let spring = &self.joints[index];
                local.rotation = skeleton.rest().local(joint).rotation;
                let world_at_rest = world_from_parent * local.to_affine();
                let tail = spring.next_tail(step_secs, &world_at_rest, world, &self.colliders, tails[index]);
                let position = spring.center_from_world(world).transform_point3(tail);
                tails[index] = Tail { position, previous: tails[index].position };
                if let Some(swing) = spring.swing(&world_at_rest, tail) {
                    local.rotation = (local.rotation * swing).normalize();
                }
                rotations[index] = local.rotation;
            }
            world[joint.get()] = world_from_parent * local.to_affine();
        }
    }
}

impl SpringJoint {
    /// Returns the tail of a joint at rest: the origin of `child` or, without one, a point 7 cm away in the direction
    /// from the parent to the joint. `None` if `child` isn't a descendant within `MAX_BONE_LEVELS`.
    pub fn rest_tail(skeleton: &Skeleton, joint: JointIndex, child: Option<JointIndex>) -> Option<Vec3> {
        let rest = skeleton.rest();
        let Some(mut descendant) = child else {
            return Some(rest.local(joint).translation.normalize_or(Vec3::Y) * END_LENGTH);
        };
        let mut tail = Vec3::ZERO;
        for _ in 0..MAX_BONE_LEVELS {
            if descendant == joint {
                return Some(tail);
            }
            tail = rest.local(descendant).to_affine().transform_point3(tail);
            descendant = skeleton.parent(descendant)?;
        }
        None
    }

    fn world_from_center(&self, world: &[Affine3A]) -> Affine3A {
        self.center.map_or(Affine3A::IDENTITY, |center| world[center.get()])
    }

    fn center_from_world(&self, world: &[Affine3A]) -> Affine3A {
        self.center.map_or(Affine3A::IDENTITY, |center| world[center.get()].inverse())
    }

    /// Returns the rotation from the joint's rest that points it at a tail in world space; `None` if there is none.
    fn swing(&self, world_at_rest: &Affine3A, tail: Vec3) -> Option<Quat> {
        let axis = self.tail.normalize_or(Vec3::Y);
        let to_tail = world_at_rest.inverse().transform_point3(tail).normalize_or(axis);
        Some(Quat::from_rotation_arc(axis, to_tail)).filter(|swing| swing.is_finite())
    }

    /// Returns the tail's next position in world space.
    fn next_tail(
        &self,
        step_secs: f32,
        world_at_rest: &Affine3A,
        world: &[Affine3A],
        colliders: &[Collider],
        tail: Tail,
    ) -> Vec3 {
        let head = Vec3::from(world_at_rest.translation);
        let to_rest = world_at_rest.transform_vector3(self.tail);
        let length = to_rest.length();
        let direction = to_rest.normalize_or(Vec3::Y);
        let by_inertia = tail.position + (tail.position - tail.previous) * (1.0 - self.drag);
        let pull = direction * self.stiffness + self.gravity;
        let next = self.world_from_center(world).transform_point3(by_inertia) + pull * step_secs;
        let at_length = |tail: Vec3| head + (tail - head).normalize_or(direction) * length;
        let mut next = at_length(next);
        for &collider in &self.colliders {
            let Some(collider) = colliders.get(collider as usize) else { continue };
            if let Some(push) = collider.push(&world[collider.joint.get()], next, self.radius) {
                next = at_length(next + push);
            }
        }
        if next.is_finite() { next } else { head + to_rest }
    }
}

impl Collider {
    /// Returns the shortest displacement that separates a sphere from the shape; `None` if they don't overlap.
    fn push(&self, world_from_joint: &Affine3A, center: Vec3, radius: f32) -> Option<Vec3> {
        let from = center - world_from_joint.transform_point3(self.offset);
        let (away, distance) = match self.normal {
            Some(normal) => {
                let normal = world_from_joint.matrix3.inverse().transpose() * normal;
                let normal = normal.normalize_or_zero();
                (normal, from.dot(normal) - radius)
            }
            None => {
                let along = world_from_joint.transform_vector3(self.tail - self.offset);
                // NaN for a sphere, which has no length.
                let fraction = (from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
                let from = if fraction.is_nan() { from } else { from - along * fraction };
                let (away, length) = (from.normalize_or_zero(), from.length());
                match self.inside {
                    true => (-away, self.radius - radius - length),
                    false => (away, length - radius - self.radius),
                }
            }
        };
        (distance < 0.0).then(|| away * -distance)
    }
}
