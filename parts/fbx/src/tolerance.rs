//! Tolerances for a joint's keys, such that no joint of the model moves noticeably.
//!
//! Every joint must stay within 0.01° and within 0.01 mm per metre of the model's size. The errors of a joint's
//! ancestors accumulate, and a rotated ancestor moves it farther the farther away it is. So the allowance is shared
//! along the longest chain of animated joints, as independent errors accumulate, and a rotation gets less the longer
//! the chain below it is.

use ufbx::{Matrix, Node, Scene};

/// 0.01°, in radians.
const ANGLE: f64 = 1.745e-4;
/// 0.01 mm per metre.
const DISTANCE: f64 = 1e-5;
/// Approximate resolution of 32-bit quaternions.
const SMALLEST_ANGLE: f64 = 3e-7;

/// The model's measures at rest.
pub struct Tolerances {
    size: f64,
    /// Longest path from a node along its descendants.
    reach: Vec<f64>,
    parents: Vec<Option<usize>>,
    /// Scale of the node's parent in the world.
    scales: Vec<f64>,
}

/// Tolerances of one node's channels.
pub struct Tolerance {
    pub translation: f64,
    pub rotation: f64,
    pub scale: f64,
}

impl Tolerances {
    pub fn new(scene: &Scene) -> Tolerances {
        let nodes: Vec<&Node> = scene.nodes.into_iter().collect();
        let parents: Vec<Option<usize>> =
            nodes.iter().map(|node| node.parent.as_ref().map(|parent| parent.element.typed_id as usize)).collect();
        let mut reach = vec![0.0_f64; nodes.len()];
        // Parents come before their children.
        for (index, node) in nodes.iter().enumerate().rev() {
            let Some(parent) = parents[index] else { continue };
            let (here, there) = (position(&node.node_to_world), position(&nodes[parent].node_to_world));
            let way = distance(here, there) + reach[index];
            if way.is_finite() {
                reach[parent] = reach[parent].max(way);
            }
        }
        let scales = nodes.iter().map(|node| node.parent.as_ref().map_or(1.0, |parent| scale(&parent.node_to_world)));
        Tolerances { size: size(&nodes), reach, scales: scales.collect(), parents }
    }

    /// Returns the tolerances of each node, given which are animated.
    pub fn of_nodes(&self, animated: &[bool]) -> Vec<Tolerance> {
        let count = animated.len();
        let mut above = vec![0_u32; count];
        for index in 0..count {
            above[index] = self.parents[index].map_or(0, |parent| above[parent]) + u32::from(animated[index]);
        }
        let mut longest = above;
        for index in (0..count).rev() {
            if let Some(parent) = self.parents[index] {
                longest[parent] = longest[parent].max(longest[index]);
            }
        }
        (0..count).map(|index| self.of_node(index, f64::from(longest[index].max(1)).sqrt())).collect()
    }

    fn of_node(&self, index: usize, chain: f64) -> Tolerance {
        let share = DISTANCE * self.size / (2.5 * chain);
        // Rotations and scales of a node with nothing below it still move its mesh.
        let reach = self.reach[index].max(0.05 * self.size);
        Tolerance {
            translation: share / self.scales[index],
            rotation: (ANGLE / chain).min(share / reach).max(SMALLEST_ANGLE),
            scale: share / reach,
        }
    }
}

/// Returns the longest side of the box around all nodes and vertices; 1 if there is none.
fn size(nodes: &[&Node]) -> f64 {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    let mut include = |point: [f64; 3]| {
        for axis in 0..3 {
            if point[axis].is_finite() {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
    };
    for node in nodes.iter().filter(|node| !node.is_root) {
        include(position(&node.node_to_world));
        for &vertex in node.mesh.as_ref().map_or(&[][..], |mesh| mesh.vertices.as_ref()) {
            let vertex = ufbx::transform_position(&node.geometry_to_world, vertex);
            include([vertex.x, vertex.y, vertex.z]);
        }
    }
    let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    if size > 0.0 && size.is_finite() { size } else { 1.0 }
}

fn position(m: &Matrix) -> [f64; 3] {
    [m.m03, m.m13, m.m23]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum::<f64>().sqrt()
}

/// Returns the longest column of the matrix; 1 if it is 0 or not finite.
fn scale(m: &Matrix) -> f64 {
    let columns = [[m.m00, m.m10, m.m20], [m.m01, m.m11, m.m21], [m.m02, m.m12, m.m22]];
    let longest = columns.into_iter().map(|column| distance(column, [0.0; 3])).fold(0.0, f64::max);
    if longest > 0.0 && longest.is_finite() { longest } else { 1.0 }
}
