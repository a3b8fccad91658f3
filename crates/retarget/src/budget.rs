//! What the time of a clip may cost, counted before any work begins. Keys can be at any time, so a file of 300 bytes may last for
//! ever, or a thousandth of a second below a clip of a day: whatever takes a step of its own length, repeats a clip or divides the
//! time between two keys asks here how often it may. Real clips, hours of them, stay below; docs/limits.md has the numbers.

use gaitway_character::anim::Skeleton;

use crate::map::Pair;

/// Steps of a measurement times joints of the skeleton: 2 hours at 60 a second for 75 joints.
const MAX_MEASURED: usize = 1 << 25;
/// Poses of the target that are held all at once while feet are planted or contacts kept, times joints: 32 minutes of 75 joints at 30
/// a second, which take about 600 MB.
const MAX_CORRECTED: usize = 1 << 22;
/// Steps at which bodies are compared, which are held all at once: 8 minutes.
pub const MAX_TOUCH_STEPS: usize = 1 << 14;
/// Chains of joints of one body times those of the other that are compared by their places: a thousand of each.
const MAX_COMPARED_CHAINS: usize = 1 << 20;
/// Moments that are added between the keys of a clip, with the whole body at each.
const MAX_ADDED_MOMENTS: usize = 1 << 15;
/// Times that are added between the keys of one channel.
const MAX_ADDED_TIMES: usize = 1 << 20;
/// Of these, those that a channel with few keys gets, and those for each key. Real motion needs fewer than one for a key, and this
/// keeps the time for all channels in proportion to their keys.
const MIN_ADDED_TIMES: usize = 1 << 14;
const ADDED_FOR_KEY: usize = 4;
/// Keys of a layer that is repeated as long as a clip lasts, in all of its channels.
const MAX_REPEATED_KEYS: usize = 1 << 22;
/// Poses that are held all at once while layers and pins are baked, times joints.
const MAX_HELD: usize = 12 << 20;
/// Poses at the keys of layers that are repeated, times joints.
const MAX_REPEATED_POSES: usize = 2 << 20;
/// Poses that are added to those where a curve needs more, times joints.
const MAX_ADDED: usize = 2 << 20;
/// Of these, those that a few given poses get, however far they are apart.
const MIN_ADDED: usize = 1 << 18;

/// Ancestors of all mapped joints, of both skeletons, since much walks up from every one of them: those of a chain of 4,096 joints.
pub const MAX_ANCESTORS: usize = 1 << 24;

/// Returns whether mapped joints lie below so many others, all together, that retargeting them would take minutes.
pub fn are_too_deep(model: &Skeleton, source: &Skeleton, pairs: &[Pair]) -> bool {
    let [of_model, of_source] = [model, source].map(depths);
    let ancestors = |pair: &Pair| of_model[pair.target.get()] + of_source[pair.source.get()];
    pairs.iter().map(ancestors).sum::<usize>() > MAX_ANCESTORS
}

/// The number of ancestors of each joint.
fn depths(skeleton: &Skeleton) -> Vec<usize> {
    let mut depths = Vec::with_capacity(skeleton.len());
    for parent in skeleton.parents() {
        depths.push(parent.map_or(0, |parent| depths[parent.get()] + 1));
    }
    depths
}

/// Returns how many steps of a measurement to take, from the start of a clip, for a skeleton of this many joints: all of these, or
/// as many as the budget has.
pub fn measured_steps(steps: f32, joints: usize) -> usize {
    // The conversion saturates.
    (steps as usize).min(MAX_MEASURED / joints.max(1))
}

/// Returns at how many times a clip of a skeleton of this many joints may be corrected.
pub fn corrected_poses(joints: usize) -> usize {
    MAX_CORRECTED / joints.max(1)
}

/// Returns whether so many chains of joints of two bodies may be compared, each with each.
pub fn may_compare_chains(targets: usize, sources: usize) -> bool {
    targets.saturating_mul(sources) <= MAX_COMPARED_CHAINS
}

/// Returns at how many times a clip may be baked for a skeleton of this many joints, or a mesh of this many morph targets.
pub fn held_poses(joints: usize) -> usize {
    MAX_HELD / joints.max(1)
}

/// Returns how often something with keys at so many times may be repeated and sampled at each of them, for a skeleton of this many
/// joints.
pub fn sampled_rounds(keys: usize, joints: usize) -> usize {
    MAX_REPEATED_POSES / joints.max(1) / keys.max(1)
}

/// Returns how many times may be added to so many where linear interpolation doesn't follow.
pub fn added_times(keys: usize) -> usize {
    keys.saturating_mul(ADDED_FOR_KEY).clamp(MIN_ADDED_TIMES, MAX_ADDED_TIMES)
}

/// Returns how many poses of so many joints may be added to the given ones where linear interpolation doesn't follow.
pub fn added_poses(joints: usize, given: usize) -> usize {
    let [min, max] = [MIN_ADDED, MAX_ADDED].map(|poses| poses / joints.max(1));
    given.saturating_mul(ADDED_FOR_KEY).clamp(min, max)
}

/// Returns into how many parts the time between two keys may be divided, `parts` at most, if there are so many keys.
pub fn parts_between(keys: usize, parts: usize) -> usize {
    parts.min(MAX_ADDED_MOMENTS / keys.max(1)).max(1)
}

/// Returns how often something with so many keys may be repeated, `rounds` at most.
pub fn affordable_rounds(keys: usize, rounds: f64) -> usize {
    (rounds.ceil() as usize).min(MAX_REPEATED_KEYS / keys.max(1)).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_affordable_is_whole_and_the_rest_is_not() {
        assert_eq!(measured_steps(3600.0 * 60.0, 75), 216_000);
        assert_eq!([measured_steps(3e38, 64), measured_steps(f32::INFINITY, 0)], [1 << 19, 1 << 25]);
        assert_eq!([parts_between(40, 600), parts_between(1 << 14, 600), parts_between(1 << 22, 600)], [600, 2, 1]);
        assert_eq!([added_poses(64, 2), added_poses(64, 5000), added_poses(0, usize::MAX)], [1 << 12, 20_000, 2 << 20]);
        assert_eq!([added_times(2), added_times(10_000), added_times(usize::MAX)], [1 << 14, 40_000, 1 << 20]);
        assert_eq!([corrected_poses(75), corrected_poses(0), corrected_poses(usize::MAX)], [55_924, 1 << 22, 0]);
        assert_eq!([held_poses(65), held_poses(0), held_poses(usize::MAX)], [193_583, 12 << 20, 0]);
        assert_eq!(
            [affordable_rounds(10, 2.5), affordable_rounds(1 << 20, 1e30), affordable_rounds(0, 0.0)],
            [3, 4, 1]
        );
    }
}
