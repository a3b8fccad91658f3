//! Small inputs made in code, shared by the modules.

use gaitway::anim::{Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton, Transform};
use glam::{Quat, Vec3};

/// A joint that hangs on another one of the list.
pub fn joint(name: &str, parent: Option<usize>, rest: Transform) -> Joint {
    Joint { name: name.to_owned(), parent, rest, morph_weights: Vec::new() }
}

/// `count` joints in a row, each 0.1 m above its parent and turned a little.
pub fn chain(count: usize) -> Skeleton {
    let rest = Transform { translation: Vec3::Y * 0.1, rotation: Quat::from_rotation_z(0.05), scale: Vec3::ONE };
    let joints = (0..count).map(|at| joint(&format!("joint {at}"), at.checked_sub(1), rest)).collect();
    Skeleton::new(joints).unwrap()
}

/// One joint with two morph targets at rest weights 0.25 and 0.5.
pub fn one_joint() -> Skeleton {
    let joint = Joint { morph_weights: vec![0.25, 0.5], ..joint("only", None, Transform::IDENTITY) };
    Skeleton::new(vec![joint]).unwrap()
}

/// A clip with one channel on joint 0.
pub fn one_channel(skeleton: &Skeleton, interpolation: Interpolation, times_secs: &[f32], keys: Keys) -> Clip {
    let mut builder = ClipBuilder::new("clip", skeleton);
    builder.channel(JointIndex(0), interpolation, times_secs, keys).unwrap();
    builder.build()
}

/// Numbers from 0 up to 1, the same on every machine (a linear congruential generator).
pub struct Random(pub u32);

impl Random {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }

    pub fn vec3(&mut self) -> Vec3 {
        2.0 * Vec3::new(self.next(), self.next(), self.next()) - 1.0
    }

    pub fn quat(&mut self) -> Quat {
        let xyz = self.vec3();
        Quat::from_xyzw(xyz.x, xyz.y, xyz.z, 2.0 * self.next() - 1.0).normalize()
    }
}
