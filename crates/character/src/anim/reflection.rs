//! A skeleton that a node above its body mirrors, as an armature with a negative scale does.
//!
//! Below such a node, local transforms mean what they do on any other skeleton; only what is made of them is mirrored. So the
//! skeleton is looked at in a mirror: X is negated in model space, which changes the local transforms of the mirroring node and of
//! everything that isn't below it, and nothing else.

use glam::{DQuat, DVec3, Vec3};

use super::{Interpolation, JointIndex, Keys, Pose, Transform};

/// How the local transforms of a mirrored skeleton change in a mirror. Those of any other skeleton don't change.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Reflection {
    /// By joint; empty if the skeleton isn't mirrored.
    places: Vec<Place>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Below the node that mirrors.
    Below,
    /// That node; after its turn in the mirror, a turn of its own remains, depending on the axes that it negates.
    Mirrors(DQuat),
    Elsewhere,
}

fn is_mirroring(scale: Vec3) -> bool {
    scale.x * scale.y * scale.z < 0.0
}

/// The rotation that negating X and the axes of a mirroring scale make together. The signs of X and Y imply Z's.
fn turn_of(scale: Vec3) -> DQuat {
    match (scale.x < 0.0, scale.y < 0.0) {
        (true, false) => DQuat::IDENTITY,
        (true, true) => DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0),
        (false, true) => DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0),
        (false, false) => DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0),
    }
}

impl Reflection {
    /// Finds the reflection that puts a skeleton right, the identity unless most joints are mirrored at rest. `parents` are those of
    /// all joints, before their children.
    pub(super) fn of(parents: &[Option<JointIndex>], rest: &Pose) -> Self {
        let scales = || (0..parents.len() as u32).map(|joint| rest.local(JointIndex(joint)).scale);
        if !scales().any(is_mirroring) {
            return Self::default();
        }
        let mut is_mirrored: Vec<bool> = Vec::with_capacity(parents.len());
        let mut places = Vec::with_capacity(parents.len());
        for (parent, scale) in parents.iter().zip(scales()) {
            let above = parent.is_some_and(|parent| is_mirrored[parent.get()]);
            let mirrors = is_mirroring(scale);
            is_mirrored.push(above != mirrors);
            places.push(match (above, mirrors) {
                (true, _) => Place::Below,
                (false, true) => Place::Mirrors(turn_of(scale)),
                (false, false) => Place::Elsewhere,
            });
        }
        let mirrored = is_mirrored.iter().filter(|mirrored| **mirrored).count();
        if 2 * mirrored > parents.len() { Self { places } } else { Self::default() }
    }

    /// Whether the skeleton isn't mirrored, so that nothing changes.
    pub fn is_identity(&self) -> bool {
        self.places.is_empty()
    }

    fn place(&self, joint: JointIndex) -> Place {
        self.places.get(joint.get()).copied().unwrap_or(Place::Below)
    }

    /// Whether a joint's local transform is another one in the mirror.
    pub fn changes(&self, joint: JointIndex) -> bool {
        self.place(joint) != Place::Below
    }

    /// Returns a joint's local translation in the mirror, and back again.
    pub fn translation(&self, joint: JointIndex, translation: DVec3) -> DVec3 {
        if self.changes(joint) { translation * DVec3::new(-1.0, 1.0, 1.0) } else { translation }
    }

    /// Returns a joint's local rotation in the mirror, and back again; linear, so that tangents change alike.
    pub fn rotation(&self, joint: JointIndex, rotation: DQuat) -> DQuat {
        let DQuat { x, y, z, w } = rotation;
        let mirrored = DQuat::from_xyzw(x, -y, -z, w);
        match self.place(joint) {
            Place::Below => rotation,
            Place::Mirrors(turn) => mirrored * turn,
            Place::Elsewhere => mirrored,
        }
    }

    /// Returns a joint's local scale in the mirror.
    pub fn scale(&self, joint: JointIndex, scale: DVec3) -> DVec3 {
        if matches!(self.place(joint), Place::Mirrors(_)) { scale.abs() } else { scale }
    }

    /// Converts a joint's scale keys to those in the mirror. Tangents have any sign: they turn round where the value does.
    pub fn change_scales(&self, joint: JointIndex, interpolation: Interpolation, values: &mut [Vec3]) {
        let in_mirror = |scale: Vec3| self.scale(joint, scale.as_dvec3()).as_vec3();
        if interpolation != Interpolation::CubicSpline {
            return values.iter_mut().for_each(|scale| *scale = in_mirror(*scale));
        }
        for key in values.chunks_exact_mut(3) {
            let mirrored = in_mirror(key[1]);
            let signs = Vec3::select(mirrored.cmpeq(key[1]), Vec3::ONE, Vec3::NEG_ONE);
            (key[0], key[1], key[2]) = (key[0] * signs, mirrored, key[2] * signs);
        }
    }

    /// Returns a joint's local transform in the mirror.
    pub fn transform(&self, joint: JointIndex, local: &Transform) -> Transform {
        Transform {
            translation: self.translation(joint, local.translation.as_dvec3()).as_vec3(),
            rotation: self.rotation(joint, local.rotation.as_dquat()).as_quat(),
            scale: self.scale(joint, local.scale.as_dvec3()).as_vec3(),
        }
    }

    /// Converts a joint's translation or rotation keys to those in the mirror, or back. Other keys stay as they are.
    pub fn change_keys(&self, joint: JointIndex, keys: &mut Keys) {
        match keys {
            Keys::Translation(values) => {
                values.iter_mut().for_each(|at| *at = self.translation(joint, at.as_dvec3()).as_vec3());
            }
            Keys::Rotation(values) => {
                values.iter_mut().for_each(|turn| *turn = self.rotation(joint, turn.as_dquat()).as_quat());
            }
            Keys::Scale(_) | Keys::MorphWeights { .. } => {}
        }
    }
}
