//! Axis-aligned bounding boxes.

use glam::{Affine3A, Vec3};

/// An axis-aligned bounding box; empty if `min > max`, as in [`Bounds::EMPTY`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest coordinate on each axis.
    pub min: Vec3,
    /// Largest coordinate on each axis.
    pub max: Vec3,
}

impl Bounds {
    /// Contains nothing; a union with it changes nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Returns the bounds of the finite points.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// Grows the box to include a point. Non-finite points are ignored.
    pub fn including(self, point: Vec3) -> Self {
        if point.is_finite() { Self { min: self.min.min(point), max: self.max.max(point) } } else { self }
    }

    /// Returns the smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box contains nothing. A box around a single point is not empty.
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// The midpoint; NaN if empty.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Edge lengths; zero if empty.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// Length of the diagonal; zero if empty.
    pub fn diagonal(&self) -> f32 {
        self.size().length()
    }

    /// Corner `i` has the maximum X, Y or Z where bit 0, 1 or 2 of `i` is set.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|corner| {
            Vec3::select(glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0), self.max, self.min)
        })
    }

    /// Returns the bounds of the transformed corners.
    pub fn transformed(&self, to_from: &Affine3A) -> Self {
        if self.is_empty() { *self } else { Self::of(self.corners().map(|corner| to_from.transform_point3(corner))) }
    }
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}
