//! Resamples where no single channel suffices: evaluates a function of time at the given times, then subdivides until
//! linear interpolation follows it closely enough. [`fewest`] does the reverse: it drops samples that interpolation restores.

use gaitway_character::sort::sort_floats;
use glam::DVec3;

use super::limits::ROUNDING;
use crate::budget::added_times;

/// Maximum number of times an interval between two given times is halved.
pub const MAX_HALVINGS: u32 = 8;

/// Keys of one value over time, for linear interpolation.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled<T> {
    pub times: Vec<f32>,
    pub values: Vec<T>,
}

impl<T> Resampled<T> {
    fn push(&mut self, (time, value): (f32, T)) {
        self.times.push(time);
        self.values.push(value);
    }
}

/// A function of time, and how its values are compared.
pub struct Curve<V, E> {
    pub value: V,
    /// `error(from, to, factor, value)`: distance of `value` from the interpolation between `from` and `to`, in the unit of
    /// `tolerance`.
    pub error: E,
    pub tolerance: f64,
}

/// Merges timelines: ascending, without duplicates.
pub fn union<'a>(timelines: impl IntoIterator<Item = &'a [f32]>) -> Vec<f32> {
    let mut times: Vec<f32> = timelines.into_iter().flatten().copied().collect();
    sort_floats(&mut times);
    times.dedup();
    times
}

/// Resamples a curve. `times` and `jumps` are ascending without duplicates; at `jumps` the value may change abruptly, so a
/// key is placed right before each.
pub fn resample<T>(
    times: &[f32],
    jumps: &[f32],
    curve: Curve<impl FnMut(f32) -> T, impl FnMut(&T, &T, f64, &T) -> f64>,
) -> Resampled<T> {
    resample_adding(times, jumps, curve, added_times(times.len()))
}

/// Like [`resample`], but halves intervals between the given times no more than `max_added` times: the rest is interpolated.
pub fn resample_adding<T>(
    times: &[f32],
    jumps: &[f32],
    mut curve: Curve<impl FnMut(f32) -> T, impl FnMut(&T, &T, f64, &T) -> f64>,
    max_added: usize,
) -> Resampled<T> {
    let mut budget = max_added;
    let mut keys = Resampled { times: Vec::with_capacity(times.len()), values: Vec::with_capacity(times.len()) };
    for &time in times {
        let key = (time, (curve.value)(time));
        if let Some(&start) = keys.times.last() {
            let just_before = time.next_down();
            if jumps.binary_search_by(|jump| jump.total_cmp(&time)).is_ok() && just_before > start {
                let end = (just_before, (curve.value)(just_before));
                refine(&mut curve, &end, 0, &mut budget, &mut keys);
                keys.push(end);
            } else {
                refine(&mut curve, &key, 0, &mut budget, &mut keys);
            }
        }
        keys.push(key);
    }
    keys
}

/// Resamples a position, with distances as errors.
pub fn resample_positions(
    times: &[f32],
    jumps: &[f32],
    tolerance: f64,
    value: impl Fn(f32) -> DVec3,
) -> Resampled<DVec3> {
    let error = |from: &DVec3, to: &DVec3, factor: f64, at: &DVec3| {
        let distance = from.lerp(*to, factor).distance(*at);
        // No keys bring it closer than `f32` allows, however far from the origin.
        if distance > ROUNDING * at.length() { distance } else { 0.0 }
    };
    resample(times, jumps, Curve { value, error, tolerance })
}

/// Subdivides the interval from the last key to `end` until the tolerance is met.
fn refine<T>(
    curve: &mut Curve<impl FnMut(f32) -> T, impl FnMut(&T, &T, f64, &T) -> f64>,
    end: &(f32, T),
    halvings: u32,
    budget: &mut usize,
    keys: &mut Resampled<T>,
) {
    let (Some(&start_secs), Some(start)) = (keys.times.last(), keys.values.last()) else { return };
    let length = end.0 - start_secs;
    let Some(middle_secs) = middle(start_secs, end.0).filter(|_| *budget > 0) else { return };
    // Halfway through an S-curve there is no error.
    let is_close = [0.25, 0.5, 0.75].into_iter().all(|part| {
        let time = start_secs + part * length;
        let factor = f64::from(time - start_secs) / f64::from(length);
        (curve.error)(start, &end.1, factor, &(curve.value)(time)) <= curve.tolerance
    });
    if is_close {
        return;
    }
    if halvings == MAX_HALVINGS {
        close_in(curve, end, budget, keys);
        return;
    }
    let middle = (middle_secs, (curve.value)(middle_secs));
    *budget -= 1;
    refine(curve, &middle, halvings + 1, budget, keys);
    keys.push(middle);
    refine(curve, end, halvings + 1, budget, keys);
}

/// Bisects to a jump between the last key and `end`, and adds keys on both sides of it. A smooth curve would have been close
/// enough after [`MAX_HALVINGS`]. Another jump so close to the first remains a ramp.
fn close_in<T>(
    curve: &mut Curve<impl FnMut(f32) -> T, impl FnMut(&T, &T, f64, &T) -> f64>,
    end: &(f32, T),
    budget: &mut usize,
    keys: &mut Resampled<T>,
) {
    let (Some(&start_secs), Some(start)) = (keys.times.last(), keys.values.last()) else { return };
    let mut before: Option<(f32, T)> = None;
    let mut after: Option<(f32, T)> = None;
    loop {
        let from = before.as_ref().map_or((start_secs, start), |(time, value)| (*time, value));
        let to = after.as_ref().map_or((end.0, &end.1), |(time, value)| (*time, value));
        let Some(middle_secs) = middle(from.0, to.0) else { break };
        let value = (curve.value)(middle_secs);
        *budget = budget.saturating_sub(1);
        let mut difference = |other: &T| (curve.error)(other, other, 0.0, &value);
        if difference(from.1) <= difference(to.1) {
            before = Some((middle_secs, value));
        } else {
            after = Some((middle_secs, value));
        }
    }
    let [from, to] =
        [before.as_ref().map_or(start, |(_, value)| value), after.as_ref().map_or(&end.1, |(_, value)| value)];
    // Anything smaller is rounding, or part of a steep curve.
    if (curve.error)(from, from, 0.0, to) > curve.tolerance {
        before.into_iter().chain(after).for_each(|key| keys.push(key));
    }
}

/// Returns a time strictly between two, if there is one.
fn middle(from: f32, to: f32) -> Option<f32> {
    let middle = from + 0.5 * (to - from);
    (from < middle && middle < to).then_some(middle)
}

/// Returns the indices of the samples to keep, greedily: from each, the farthest for which `fits` holds, found by doubling and
/// halving the step. Always keeps the first and the last.
pub fn fewest(count: usize, mut fits: impl FnMut(usize, usize) -> bool) -> Vec<usize> {
    let (mut kept, mut from) = (vec![0], 0);
    while from + 1 < count {
        let (mut near, mut step) = (from + 1, 2);
        while from + step < count && fits(from, from + step) {
            near = from + step;
            step *= 2;
        }
        let mut far = (from + step).min(count);
        while far - near > 1 {
            let middle = (near + far) / 2;
            if fits(from, middle) { near = middle } else { far = middle }
        }
        kept.push(near);
        from = near;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jumps that no one announced are searched for, which costs more than the keys that it adds.
    #[test]
    fn noise_is_evaluated_as_often_as_the_budget_says() {
        let mut evaluations = 0;
        let value = |time: f32| {
            evaluations += 1;
            f64::from(time.to_bits().wrapping_mul(0x9E37_79B9) >> 16)
        };
        let error = |from: &f64, to: &f64, factor: f64, at: &f64| (from + (to - from) * factor - at).abs();
        let times: Vec<f32> = (0..100).map(|second| second as f32).collect();
        let keys = resample_adding(&times, &[], Curve { value, error, tolerance: 1e-3 }, 2000);
        assert!(keys.times.len() < 2100, "{} keys", keys.times.len());
        // Each of them looks at up to three times between its ends.
        assert!(evaluations < 4 * 2100, "{evaluations} evaluations");
    }
}
