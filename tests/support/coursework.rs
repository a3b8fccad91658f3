//! The skinning exercise of MIT 6.837, implemented literally in double precision from the text of its three files:
//! `p' = Σ w_j · T_j · B_j⁻¹ · p`. Shares no code with the library.

use glam::{DMat4, DQuat, DVec3, Quat};

use crate::random::Random;

pub struct Exercise {
    pub vertices: Vec<DVec3>,
    joints: Vec<(DVec3, Option<usize>)>,
    /// One row per vertex, one weight per joint.
    weights: Vec<Vec<f64>>,
}

impl Exercise {
    pub fn read(obj: &str, skel: &str, attach: &str) -> Self {
        let numbers = |line: &str| -> Vec<f64> { line.split_whitespace().map(|word| word.parse().unwrap()).collect() };
        let vertices =
            obj.lines().filter_map(|line| line.strip_prefix("v ")).map(|line| DVec3::from_slice(&numbers(line)));
        let joints = skel
            .lines()
            .map(numbers)
            .map(|row| (DVec3::from_slice(&row[..3]), if row[3] < 0.0 { None } else { Some(row[3] as usize) }));
        let weights = attach.lines().map(|line| {
            let row = numbers(line);
            let sum: f64 = row.iter().sum();
            std::iter::once(0.0).chain(row.into_iter().map(|weight| weight / sum)).collect()
        });
        Self { vertices: vertices.collect(), joints: joints.collect(), weights: weights.collect() }
    }

    /// Skins all vertices with these rotations of the joints.
    pub fn skinned(&self, rotations: &[DQuat]) -> Vec<DVec3> {
        let mut bind: Vec<DMat4> = Vec::new();
        let mut world: Vec<DMat4> = Vec::new();
        for (&(offset, parent), &rotation) in self.joints.iter().zip(rotations) {
            let (bind_parent, world_parent) =
                parent.map_or((DMat4::IDENTITY, DMat4::IDENTITY), |at| (bind[at], world[at]));
            bind.push(bind_parent * DMat4::from_translation(offset));
            world.push(world_parent * DMat4::from_rotation_translation(rotation, offset));
        }
        let world_from_bind: Vec<DMat4> =
            world.iter().zip(&bind).map(|(world, bind)| *world * bind.inverse()).collect();
        let skin = |(vertex, row): (&DVec3, &Vec<f64>)| {
            row.iter().zip(&world_from_bind).map(|(&weight, matrix)| weight * matrix.transform_point3(*vertex)).sum()
        };
        self.vertices.iter().zip(&self.weights).map(skin).collect()
    }
}

/// Random rotations of all joints: in double precision, and rounded to single.
#[allow(dead_code)] // Not every test program uses it.
pub fn pose(joints: usize, seed: u64) -> (Vec<DQuat>, Vec<Quat>) {
    let mut random = Random(seed);
    let mut angle = || 3.0 * random.f64() - 1.5;
    let rounded: Vec<Quat> = (0..joints)
        .map(|_| DQuat::from_euler(glam::EulerRot::XYZ, angle(), angle(), angle()).as_quat().normalize())
        .collect();
    (rounded.iter().map(|rotation| rotation.as_dquat().normalize()).collect(), rounded)
}
