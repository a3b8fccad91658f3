//! SIMD kernels of playback: four joints at a time, one per lane (structure of arrays), so that interpolating keys and
//! converting local transforms to matrices needs no shuffling. The unit tests have the same formulas for a single
//! joint, in f64.
//!
//! Whatever samples whole poses goes through them. Interpolated rotations stay shorter than 1, and their matrices are
//! divided by the squared length. Code that handles single joints (the gizmo, the inspector, retargeting) uses `Pose::local`
//! and `Pose::set_local` instead.

use glam::{Affine3A, BVec4A, Mat3A, Quat, Vec3, Vec4};

use super::joint::JointIndex;
use super::transform::Transform;

/// Joints per group.
pub(super) const LANES: usize = 4;

/// Four vectors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Vec3x4 {
    pub x: Vec4,
    pub y: Vec4,
    pub z: Vec4,
}

/// Four rotations. Stored ones are unit quaternions, but interpolated ones are shorter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Quatx4 {
    pub x: Vec4,
    pub y: Vec4,
    pub z: Vec4,
    pub w: Vec4,
}

/// Local transforms of four joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transformx4 {
    pub translation: Vec3x4,
    pub rotation: Quatx4,
    pub scale: Vec3x4,
}

/// Rotation keys of four channels, with the squared angles (as 4-vectors) to the next keys, which are at most a right
/// angle away.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ArcKey {
    rotation: Quatx4,
    squared_angles: Vec4,
}

impl Vec3x4 {
    pub fn new(lanes: [Vec3; LANES]) -> Self {
        Self {
            x: Vec4::from(lanes.map(|lane| lane.x)),
            y: Vec4::from(lanes.map(|lane| lane.y)),
            z: Vec4::from(lanes.map(|lane| lane.z)),
        }
    }

    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    pub fn set(&mut self, lane: usize, value: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (value.x, value.y, value.z);
    }

    /// Replaces the masked lanes with those of another value.
    #[inline(always)]
    pub fn replace(&mut self, lanes: BVec4A, by: Self) {
        if lanes.all() {
            *self = by;
            return;
        }
        let select = |by, own| Vec4::select(lanes, by, own);
        *self = Self { x: select(by.x, self.x), y: select(by.y, self.y), z: select(by.z, self.z) };
    }

    #[inline(always)]
    pub fn lerp(&self, to: &Self, factor: f32) -> Self {
        let lerp = |from: Vec4, to: Vec4| from + (to - from) * factor;
        Self { x: lerp(self.x, to.x), y: lerp(self.y, to.y), z: lerp(self.z, to.z) }
    }
}

impl Quatx4 {
    /// Expects unit quaternions; see [`unit()`].
    pub fn new(lanes: [Quat; LANES]) -> Self {
        Self {
            x: Vec4::from(lanes.map(|lane| lane.x)),
            y: Vec4::from(lanes.map(|lane| lane.y)),
            z: Vec4::from(lanes.map(|lane| lane.z)),
            w: Vec4::from(lanes.map(|lane| lane.w)),
        }
    }

    /// Returns a unit quaternion.
    pub fn get(&self, lane: usize) -> Quat {
        unit(Quat::from_xyzw(self.x[lane], self.y[lane], self.z[lane], self.w[lane]))
    }

    pub fn set(&mut self, lane: usize, value: Quat) {
        let value = unit(value);
        (self.x[lane], self.y[lane], self.z[lane], self.w[lane]) = (value.x, value.y, value.z, value.w);
    }

    /// Replaces the masked lanes with those of another value.
    #[inline(always)]
    pub fn replace(&mut self, lanes: BVec4A, by: Self) {
        if lanes.all() {
            *self = by;
            return;
        }
        let select = |by, own| Vec4::select(lanes, by, own);
        *self =
            Self { x: select(by.x, self.x), y: select(by.y, self.y), z: select(by.z, self.z), w: select(by.w, self.w) };
    }
}

/// Normalizes a rotation. One already normalized up to rounding is returned unchanged; a degenerate one becomes the
/// identity. Components that change no f32 result become 0: their squares would be denormal, and processors are many
/// times slower with those.
pub(super) fn unit(value: Quat) -> Quat {
    const NEGLIGIBLE: f32 = 1e-12;
    let length_squared = value.length_squared();
    if (length_squared - 1.0).abs() < 1e-6 {
        return Quat::from_array(value.to_array().map(|part| if part.abs() < NEGLIGIBLE { 0.0 } else { part }));
    }
    let length = value.length();
    if length.is_finite() && length > 0.0 { value / length } else { Quat::IDENTITY }
}

impl ArcKey {
    pub fn new(from: Quatx4, to: Quatx4) -> Self {
        let (x, y, z, w) = (to.x - from.x, to.y - from.y, to.z - from.z, to.w - from.w);
        let squared_chords = x * x + y * y + z * z + w * w;
        Self { rotation: from, squared_angles: Vec4::from(squared_chords.to_array().map(squared_angle)) }
    }

    /// Interpolates along the arcs to the next keys. The results match slerp's in direction, not in length.
    #[inline(always)]
    pub fn slerp(&self, to: &Self, weight: &ArcWeight) -> Quatx4 {
        let weights = weight.at(self.squared_angles);
        let lerp = |from: Vec4, to: Vec4| from + (to - from) * weights;
        let (from, to) = (&self.rotation, &to.rotation);
        Quatx4 { x: lerp(from.x, to.x), y: lerp(from.y, to.y), z: lerp(from.z, to.z), w: lerp(from.w, to.w) }
    }
}

/// Beyond this, the polynomials in the squared angle are not accurate enough: 36 degrees as 4-vectors, 72 as rotations.
const MAX_SQUARED_ANGLE: f32 = 0.4;

/// Returns the squared angle between two unit vectors, given their squared distance: `(2 asin(√d / 2))²` and its series.
fn squared_angle(chord: f32) -> f32 {
    if chord > MAX_SQUARED_ANGLE {
        let angle = 2.0 * (0.5 * chord.sqrt()).min(1.0).asin();
        return angle * angle;
    }
    [1.0 / 16_632.0, 1.0 / 3150.0, 1.0 / 560.0, 1.0 / 90.0, 1.0 / 12.0, 1.0, 0.0]
        .into_iter()
        .fold(0.0, |sum, coefficient| sum * chord + coefficient)
}

/// Position, from 0 to 1, at which slerp's direction crosses the chord between two unit quaternions.
///
/// Slerp weights the ends by `sin((1 - t) ω)` and `sin(t ω)` (glTF 2.0 appendix C.3). The second weight as a fraction
/// of their sum is `½ + ½ tan(s ω) / tan(ω / 2)` with `s = t - ½`, and its Taylor series `t + s (s² - ¼) (⅓ ω² + …)`.
/// As in Eberly's "A Fast and Accurate Algorithm for Computing SLERP" (2011), the coefficients depend only on the time,
/// so all channels share them. Exact at the keys; elsewhere within 1e-7 radians.
pub(super) struct ArcWeight {
    factor: f32,
    /// Coefficients of ω², ω⁴ and ω⁶, the same in all lanes.
    coefficients: [Vec4; 3],
}

impl ArcWeight {
    pub fn new(factor: f32) -> Self {
        let s = factor - 0.5;
        let s2 = s * s;
        let common = s * (s2 - 0.25);
        Self {
            factor,
            coefficients: [
                Vec4::splat(common * (1.0 / 3.0)),
                Vec4::splat(common * (2.0 / 15.0 * s2 + 1.0 / 180.0)),
                Vec4::splat(common * ((17.0 / 315.0 * s2 + 1.0 / 420.0) * s2 + 1.0 / 7560.0)),
            ],
        }
    }

    #[inline(always)]
    fn at(&self, squared_angles: Vec4) -> Vec4 {
        if squared_angles.cmpgt(Vec4::splat(MAX_SQUARED_ANGLE)).any() {
            return self.at_wide(squared_angles);
        }
        let [a, b, c] = self.coefficients;
        ((c * squared_angles + b) * squared_angles + a) * squared_angles + Vec4::splat(self.factor)
    }

    #[cold]
    fn at_wide(&self, squared_angles: Vec4) -> Vec4 {
        Vec4::from(squared_angles.to_array().map(|squared| {
            let half = 0.5 * squared.sqrt();
            if half > 0.0 && self.factor > 0.0 {
                0.5 + 0.5 * ((2.0 * self.factor - 1.0) * half).tan() / half.tan()
            } else {
                self.factor
            }
        }))
    }
}

impl Transformx4 {
    pub const IDENTITY: Self = Self {
        translation: Vec3x4 { x: Vec4::ZERO, y: Vec4::ZERO, z: Vec4::ZERO },
        rotation: Quatx4 { x: Vec4::ZERO, y: Vec4::ZERO, z: Vec4::ZERO, w: Vec4::ONE },
        scale: Vec3x4 { x: Vec4::ONE, y: Vec4::ONE, z: Vec4::ONE },
    };

    pub fn get(&self, lane: usize) -> Transform {
        Transform {
            translation: self.translation.get(lane),
            rotation: self.rotation.get(lane),
            scale: self.scale.get(lane),
        }
    }

    /// Returns the matrices `parent_from_joint`: columns x, y, z and the translation, three rows each, one lane per
    /// joint. Divides by the rotations' squared lengths instead of normalizing them.
    #[inline(always)]
    fn matrices(&self) -> [[f32; LANES]; 12] {
        let Quatx4 { x, y, z, w } = self.rotation;
        let Vec3x4 { x: sx, y: sy, z: sz } = self.scale;
        let twice = Vec4::splat(2.0) / (x * x + y * y + z * z + w * w);
        let (x2, y2, z2) = (x * twice, y * twice, z * twice);
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (xy, xz, yz) = (x * y2, x * z2, y * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        let Vec3x4 { x: tx, y: ty, z: tz } = self.translation;
        [
            (Vec4::ONE - (yy + zz)) * sx,
            (xy + wz) * sx,
            (xz - wy) * sx,
            (xy - wz) * sy,
            (Vec4::ONE - (xx + zz)) * sy,
            (yz + wx) * sy,
            (xz + wy) * sz,
            (yz - wx) * sz,
            (Vec4::ONE - (xx + yy)) * sz,
            tx,
            ty,
            tz,
        ]
        .map(|entries| entries.to_array())
    }
}

/// Multiplies local transforms down the hierarchy. `joints` has the joint of each lane and its parent, parents first;
/// `out` has one entry per joint.
pub(super) fn model_from_joint(
    groups: &[Transformx4],
    joints: &[(JointIndex, Option<JointIndex>)],
    world_from_model: Affine3A,
    out: &mut [Affine3A],
) {
    for (group, joints) in groups.iter().zip(joints.chunks(LANES)) {
        let entries = group.matrices();
        for (lane, &(joint, parent)) in joints.iter().enumerate() {
            let to_from_parent = parent.map_or(world_from_model, |parent| out[parent.get()]);
            let Mat3A { x_axis, y_axis, z_axis } = to_from_parent.matrix3;
            let column = |row: usize| {
                x_axis * entries[row][lane] + y_axis * entries[row + 1][lane] + z_axis * entries[row + 2][lane]
            };
            out[joint.get()] = Affine3A {
                matrix3: Mat3A::from_cols(column(0), column(3), column(6)),
                translation: column(9) + to_from_parent.translation,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use glam::{DAffine3, DQuat};

    use super::*;

    /// Returns a reproducible number from -1 to 1.
    fn scattered(seed: usize) -> f32 {
        (seed as f32 * 12.9898).sin()
    }

    fn scattered_quat(seed: usize) -> Quat {
        let part = |at| scattered(4 * seed + at);
        Quat::from_xyzw(part(0), part(1), part(2), part(3)).normalize()
    }

    /// Slerp of appendix C.3 for an angle between the quaternions of at most 90 degrees.
    fn slerp(from: DQuat, to: DQuat, factor: f64) -> DQuat {
        let angle = 2.0 * (0.5 * (to - from).length()).asin();
        if angle == 0.0 {
            return from;
        }
        from * (((1.0 - factor) * angle).sin() / angle.sin()) + to * ((factor * angle).sin() / angle.sin())
    }

    #[test]
    fn arcs_have_slerps_direction() {
        let mut worst = 0.0_f64;
        for step in 0..=400 {
            let from = scattered_quat(step);
            // From tiny angles to a right angle, different in each lane.
            let to: [Quat; LANES] = std::array::from_fn(|lane| {
                let angle = FRAC_PI_2 * (step as f64 / 400.0) * [1.0, 0.99, 0.3, 1e-4][lane];
                let side = scattered_quat(step + 1);
                let side = (side - from * from.dot(side)).normalize();
                (from.as_dquat() * angle.cos() + side.as_dquat() * angle.sin()).as_quat()
            });
            let ends = [Quatx4::new([from; LANES]), Quatx4::new(to)];
            let [start, end] = [ArcKey::new(ends[0], ends[1]), ArcKey::new(ends[1], ends[1])];
            for factor in [0.0, 1e-3, 0.1, 0.25, 0.45, 0.5, 0.7, 0.85, 0.999, 1.0] {
                let found = start.slerp(&end, &ArcWeight::new(factor));
                for (lane, to) in to.iter().enumerate() {
                    let expected = slerp(from.as_dquat().normalize(), to.as_dquat().normalize(), f64::from(factor));
                    worst = worst.max((found.get(lane).as_dquat().normalize() - expected).length());
                }
            }
        }
        assert!(worst < 2e-7, "off by {worst}");
    }

    #[test]
    fn both_ends_of_an_arc_are_exact() {
        let ends = [1, 2].map(|seed| Quatx4::new(std::array::from_fn(|lane| scattered_quat(seed + 10 * lane))));
        let keys = [ArcKey::new(ends[0], ends[1]), ArcKey::new(ends[1], ends[1])];
        assert_eq!(keys[0].slerp(&keys[1], &ArcWeight::new(0.0)), ends[0]);
        assert_eq!(keys[1].slerp(&keys[1], &ArcWeight::new(0.3)), ends[1]);
    }

    #[test]
    fn squared_angles_match_the_arc_sine() {
        for step in 0..=1000 {
            let chord = 0.002 * step as f32;
            let angle = 2.0 * (0.5 * f64::from(chord).sqrt()).asin();
            let found = f64::from(squared_angle(chord));
            assert!((found - angle * angle).abs() <= 1e-6 * found, "{found} for {chord}, expected {}", angle * angle);
        }
    }

    #[test]
    fn four_matrices_equal_four_single_ones() {
        for seed in 0..100 {
            let vector = |at| Vec3::new(scattered(at), scattered(at + 1), scattered(at + 2));
            let locals: [Transform; LANES] = std::array::from_fn(|lane| Transform {
                translation: vector(7 * seed + lane),
                rotation: scattered_quat(seed + 100 * lane),
                scale: 2.0 * vector(11 * seed + lane),
            });
            let mut group = Transformx4 {
                translation: Vec3x4::new(locals.map(|local| local.translation)),
                rotation: Quatx4::new(locals.map(|local| local.rotation)),
                scale: Vec3x4::new(locals.map(|local| local.scale)),
            };
            // Not normalized, as after interpolation.
            let length = 0.7 + 0.3 * scattered(seed);
            group.rotation.x *= length;
            group.rotation.y *= length;
            group.rotation.z *= length;
            group.rotation.w *= length;
            let joints: Vec<_> = (0..LANES as u32).map(|joint| (JointIndex(joint), None)).collect();
            let mut found = [Affine3A::IDENTITY; LANES];
            model_from_joint(&[group], &joints, Affine3A::IDENTITY, &mut found);
            for (found, local) in found.iter().zip(&locals) {
                let expected = DAffine3::from_scale_rotation_translation(
                    local.scale.as_dvec3(),
                    local.rotation.as_dquat().normalize(),
                    local.translation.as_dvec3(),
                );
                assert!(found.as_daffine3().abs_diff_eq(expected, 1e-6), "{found:?} from {local:?}");
            }
        }
    }

    #[test]
    fn negligible_components_of_rotations_become_zero() {
        let tidy = unit(Quat::from_xyzw(1.9e-21, -3.5e-15, 0.6, 0.8));
        assert_eq!(tidy, Quat::from_xyzw(0.0, 0.0, 0.6, 0.8));
        assert_eq!(unit(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)), Quat::IDENTITY);
    }
}
