//! The keys of a clip in the file's space, and their values at any time: glTF's interpolation, in 64 bits.

use gaitway_character::anim::Interpolation;
use glam::{DQuat, DVec4};

/// What the components of a value mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Three numbers, or one.
    Numbers,
    /// A quaternion.
    Rotation,
}

/// Keys of one property.
#[derive(Debug, Clone)]
pub struct Source {
    pub kind: Kind,
    pub interpolation: Interpolation,
    /// Strictly increasing, in seconds.
    pub times: Vec<f64>,
    /// One per key; of splines, the tangents before and after it as well.
    values: Vec<DVec4>,
}

impl Source {
    /// Converts keys. Quaternions become unit ones that follow each other by the shorter way, unless they are splines.
    pub fn new(kind: Kind, interpolation: Interpolation, times: &[f32], values: impl Iterator<Item = DVec4>) -> Source {
        let mut values: Vec<DVec4> = values.collect();
        if kind == Kind::Rotation && interpolation != Interpolation::CubicSpline {
            let mut last = DVec4::ZERO;
            for value in &mut values {
                *value = unit(*value);
                if value.dot(last) < 0.0 {
                    *value = -*value;
                }
                last = *value;
            }
        }
        Source { kind, interpolation, times: times.iter().map(|&time| time.into()).collect(), values }
    }

    /// Returns a key's value.
    pub fn key(&self, key: usize) -> DVec4 {
        match (self.interpolation, self.kind) {
            (Interpolation::CubicSpline, Kind::Rotation) => unit(self.values[3 * key + 1]),
            (Interpolation::CubicSpline, Kind::Numbers) => self.values[3 * key + 1],
            _ => self.values[key],
        }
    }

    /// Returns the value at a fraction of the way from a key to the next.
    pub fn between(&self, key: usize, fraction: f64) -> DVec4 {
        match self.interpolation {
            Interpolation::Step => self.key(key),
            Interpolation::Linear => straight(self.kind, self.key(key), self.key(key + 1), fraction),
            Interpolation::CubicSpline => {
                let length = self.times[key + 1] - self.times[key];
                let [before, after] = [3 * key, 3 * key + 3];
                let tangents = [self.values[before + 2], self.values[after]].map(|tangent| tangent * length);
                let ends = [self.values[before + 1], self.values[after + 1]];
                let [a, b, c, d] = hermite(fraction);
                let value = ends[0] * a + tangents[0] * b + ends[1] * c + tangents[1] * d;
                if self.kind == Kind::Rotation { unit(value) } else { value }
            }
        }
    }
}

/// Returns the value at a fraction of the straight way between two: for rotations, the shorter arc.
pub fn straight(kind: Kind, from: DVec4, to: DVec4, fraction: f64) -> DVec4 {
    if kind == Kind::Numbers {
        return from + (to - from) * fraction;
    }
    let cosine = from.dot(to);
    let (to, cosine) = if cosine < 0.0 { (-to, -cosine) } else { (to, cosine) };
    // atan2 keeps small angles apart, which the cosine doesn't.
    let angle = 2.0 * libm::atan2((to - from).length(), (to + from).length());
    let sine = libm::sin(angle);
    if cosine > 1.0 - 1e-12 || sine == 0.0 {
        return unit(from + (to - from) * fraction);
    }
    unit((from * libm::sin((1.0 - fraction) * angle) + to * libm::sin(fraction * angle)) / sine)
}

/// Returns the weights of the first end, its tangent, the second end and its tangent.
pub fn hermite(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, 3.0 * t2 - 2.0 * t3, t3 - t2]
}

/// Returns a quaternion of length 1; the identity for one that has no direction.
fn unit(value: DVec4) -> DVec4 {
    value.try_normalize().unwrap_or(DVec4::W)
}

pub fn quaternion(value: DVec4) -> DQuat {
    DQuat::from_vec4(value)
}
