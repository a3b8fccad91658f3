//! Random vectors and rotations; not in `random`, because the tests of parts/* don't depend on glam.

// Each test program uses a part of it.
#![allow(dead_code)]

use glam::{Quat, Vec3};

use crate::random::Random;

impl Random {
    /// Components from -1 to 1.
    pub fn vec3(&mut self) -> Vec3 {
        2.0 * Vec3::new(self.f32(), self.f32(), self.f32()) - 1.0
    }

    /// A rotation of unit length.
    pub fn quat(&mut self) -> Quat {
        let xyz = self.vec3();
        Quat::from_xyzw(xyz.x, xyz.y, xyz.z, 2.0 * self.f32() - 1.0).normalize()
    }
}
