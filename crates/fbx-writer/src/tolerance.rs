//! Tolerances for a joint's keys, such that no joint of the model moves noticeably.
//!
//! Every joint must stay within 0.01°, and with every vertex within 0.01 mm per metre of the model's size. The errors of a joint's
//! ancestors accumulate, and a rotated ancestor moves it farther the farther away it is. So the allowance is shared along the longest
//! chain of animated joints, as independent errors accumulate, and a rotation gets less the longer the chain below it is.

use gaitway_character::anim::{JointIndex, Skeleton};
use glam::{DMat4, DVec3};

use crate::layout::{Contents, Layout};
use crate::mesh::for_each_point;

/// 0.01°, in radians.
const ANGLE: f64 = 1.745e-4;
/// 0.01 mm per metre.
const DISTANCE: f64 = 1e-5;
/// Below this, 32-bit numbers of degrees can't tell angles apart.
const SMALLEST_ANGLE: f64 = 5e-7;
/// Maximum error of a blend shape's weight.
pub const WEIGHT: f64 = 1e-4;

/// Tolerances of one joint's channels, in the file's units and radians.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    pub translation: f64,
    pub rotation: f64,
    pub scale: f64,
}

/// The model's measures at rest.
#[derive(Debug)]
pub struct Tolerances {
    size: f64,
    /// Longest path from a joint along its descendants to a vertex or a joint.
    reach: Vec<f64>,
    /// Scale of the joint's parent in the world.
    scales: Vec<f64>,
}

impl Tolerances {
    /// Measures a model at rest.
    pub fn new(contents: Contents, layout: &Layout) -> Tolerances {
        let (skeleton, worlds) = (&contents.asset.skeleton, &layout.worlds);
        let position = |joint: JointIndex| worlds[joint.get()].w_axis.truncate();
        let mut reach = vec![0.0_f64; worlds.len()];
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut include = |joint: JointIndex, point: DVec3| {
            let way = position(joint).distance(point);
            if way.is_finite() {
                (low, high) = (low.min(point), high.max(point));
                reach[joint.get()] = reach[joint.get()].max(way);
            }
        };
        skeleton.joints().for_each(|joint| include(joint, position(joint)));
        for_each_point(contents, layout, &mut include);
        // Parents come before their children.
        for joint in skeleton.joints().rev() {
            let Some(parent) = skeleton.parent(joint) else { continue };
            let way = position(joint).distance(position(parent)) + reach[joint.get()];
            if way.is_finite() {
                reach[parent.get()] = reach[parent.get()].max(way);
            }
        }
        let size = (high - low).max_element();
        let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let parent_scale = |joint| skeleton.parent(joint).map_or(1.0, |parent| scale(&worlds[parent.get()]));
        Tolerances { size, reach, scales: skeleton.joints().map(parent_scale).collect() }
    }

    /// Returns the tolerances of each joint, given which are animated.
    pub fn of_joints(&self, skeleton: &Skeleton, animated: &[bool]) -> Vec<Tolerance> {
        let mut chains = vec![0_u32; animated.len()];
        for joint in skeleton.joints() {
            let above = skeleton.parent(joint).map_or(0, |parent| chains[parent.get()]);
            chains[joint.get()] = above + u32::from(animated[joint.get()]);
        }
        for joint in skeleton.joints().rev() {
            if let Some(parent) = skeleton.parent(joint) {
                chains[parent.get()] = chains[parent.get()].max(chains[joint.get()]);
            }
        }
        let chain = |index: usize| f64::from(chains[index].max(1)).sqrt();
        (0..animated.len()).map(|index| self.of_joint(index, chain(index))).collect()
    }

    fn of_joint(&self, index: usize, chain: f64) -> Tolerance {
        let share = DISTANCE * self.size / (2.5 * chain);
        // Something may be attached to a joint with nothing below it.
        let reach = self.reach[index].max(0.05 * self.size);
        Tolerance {
            translation: share / self.scales[index],
            rotation: (ANGLE / chain).min(share / reach).max(SMALLEST_ANGLE),
            scale: share / reach,
        }
    }
}

/// Returns the longest column of the matrix; 1 if it is 0 or not finite.
fn scale(matrix: &DMat4) -> f64 {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let longest = columns.into_iter().map(|column| column.truncate().length()).fold(0.0, f64::max);
    if longest > 0.0 && longest.is_finite() { longest } else { 1.0 }
}
