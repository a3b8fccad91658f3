//! Merges JOINTS_n and WEIGHTS_n of a primitive into one list per vertex, strongest first (§3.7.3.3).

use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::{Influences, MAX_INFLUENCES};

/// Weight sums farther from 1 are reported; smaller errors are rounding.
const SUM_TOLERANCE: f32 = 1e-3;

/// Larger weights are ignored, like NaN. Smaller ones can't make a sum overflow.
const MAX_WEIGHT: f32 = 1e30;

/// One JOINTS_n with its WEIGHTS_n.
pub struct InfluenceSet {
    pub joints: Vec<[u32; 4]>,
    pub weights: Vec<[f32; 4]>,
}

pub fn merge(mesh: &str, vertices: usize, sets: &[InfluenceSet], warnings: &mut Warnings) -> Influences {
    match sets {
        [] => return Influences::default(),
        [set] => return single_set(mesh, set, warnings),
        _ => {}
    }
    let of_vertex = |vertex: usize, pairs: &mut Vec<(u16, f32)>| {
        pairs.clear();
        for set in sets {
            for (&joint, &weight) in set.joints[vertex].iter().zip(&set.weights[vertex]) {
                if weight > 0.0 && weight < MAX_WEIGHT {
                    pairs.push((joint.min(u32::from(u16::MAX)) as u16, weight));
                }
            }
        }
        // Stable: equal weights keep the file's order.
        pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    };
    let mut pairs = Vec::with_capacity(4 * sets.len());
    let mut max_count = 1;
    for vertex in 0..vertices {
        of_vertex(vertex, &mut pairs);
        max_count = max_count.max(pairs.len());
    }
    let stride = max_count.min(MAX_INFLUENCES).next_multiple_of(4);
    let mut influences =
        Influences { stride, joints: vec![0; stride * vertices], weights: vec![0.0; stride * vertices] };
    let (mut normalized, mut missing, mut largest_lost_weight) = (0, 0, 0.0_f32);
    for vertex in 0..vertices {
        of_vertex(vertex, &mut pairs);
        let total: f32 = pairs.iter().map(|pair| pair.1).sum();
        if pairs.is_empty() {
            missing += 1;
            pairs.push((0, 1.0));
        } else if (total - 1.0).abs() > SUM_TOLERANCE {
            normalized += 1;
        }
        for lost in pairs.iter().skip(MAX_INFLUENCES) {
            largest_lost_weight = largest_lost_weight.max(lost.1 / total);
        }
        pairs.truncate(MAX_INFLUENCES);
        let kept: f32 = pairs.iter().map(|pair| pair.1).sum();
        for (at, &(joint, weight)) in pairs.iter().enumerate() {
            influences.joints[vertex * stride + at] = joint;
            influences.weights[vertex * stride + at] = weight / kept;
        }
    }
    if max_count > MAX_INFLUENCES {
        let (found, kept) = (max_count, MAX_INFLUENCES);
        warnings.push(Warning::InfluencesDropped { mesh: mesh.to_owned(), found, kept, largest_lost_weight });
    }
    warn(mesh, missing, normalized, warnings);
    influences
}

/// Fast path for the common case, at most four influences per vertex, without growing lists.
fn single_set(mesh: &str, set: &InfluenceSet, warnings: &mut Warnings) -> Influences {
    let vertices = set.joints.len();
    let (mut sorted_joints, mut sorted_weights) = (vec![[0; 4]; vertices], vec![[0.0; 4]; vertices]);
    let (mut normalized, mut missing) = (0, 0);
    let sorted = sorted_joints.iter_mut().zip(&mut sorted_weights);
    for ((joints, weights), (sorted_joints, sorted_weights)) in set.joints.iter().zip(&set.weights).zip(sorted) {
        let (mut joints, mut weights) = (joints.map(|joint| joint.min(u32::from(u16::MAX)) as u16), *weights);
        for (joint, weight) in joints.iter_mut().zip(&mut weights) {
            if !(*weight > 0.0 && *weight < MAX_WEIGHT) {
                (*joint, *weight) = (0, 0.0);
            }
        }
        if !weights.is_sorted_by(|a, b| a >= b) {
            // Swaps neighbours only if the second is heavier: equal weights keep the file's order.
            for (a, b) in [(0, 1), (1, 2), (2, 3), (0, 1), (1, 2), (0, 1)] {
                if weights[a] < weights[b] {
                    weights.swap(a, b);
                    joints.swap(a, b);
                }
            }
        }
        let total: f32 = weights.iter().sum();
        if total == 0.0 {
            missing += 1;
            weights = [1.0, 0.0, 0.0, 0.0];
        } else {
            normalized += usize::from((total - 1.0).abs() > SUM_TOLERANCE);
            weights = weights.map(|weight| weight / total);
        }
        *sorted_joints = joints;
        *sorted_weights = weights;
    }
    warn(mesh, missing, normalized, warnings);
    Influences { stride: 4, joints: sorted_joints.into_flattened(), weights: sorted_weights.into_flattened() }
}

fn warn(mesh: &str, missing: usize, normalized: usize, warnings: &mut Warnings) {
    let mesh = mesh.to_owned();
    if missing > 0 {
        warnings.push(Warning::WeightsMissing { mesh: mesh.clone(), vertices: missing });
    }
    if normalized > 0 {
        warnings.push(Warning::WeightsNormalized { mesh, vertices: normalized });
    }
}
