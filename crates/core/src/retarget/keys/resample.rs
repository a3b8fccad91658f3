//! Resamples where no single channel suffices: evaluates a function of time at the given times, then subdivides until
//! linear interpolation follows it closely enough.

use glam::DVec3;

/// Maximum number of times an interval between two given times is halved.
const MAX_HALVINGS: u32 = 8;

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

/// A function of time, and how its values are interpolated and compared.
pub struct Curve<V, I, E> {
    pub value: V,
    pub interpolate: I,
    /// Distance between two values, in the unit of `tolerance`.
    pub error: E,
    pub tolerance: f64,
}

/// Merges timelines: ascending, without duplicates.
pub fn union<'a>(timelines: impl IntoIterator<Item = &'a [f32]>) -> Vec<f32> {
    let mut times: Vec<f32> = timelines.into_iter().flatten().copied().collect();
    times.sort_by(f32::total_cmp);
    times.dedup();
    times
}

/// Resamples a curve. `times` and `jumps` are ascending without duplicates; at `jumps` the value may change abruptly, so a
/// key is placed right before each.
pub fn resample<T: Copy>(
    times: &[f32],
    jumps: &[f32],
    curve: &Curve<impl Fn(f32) -> T, impl Fn(T, T, f64) -> T, impl Fn(T, T) -> f64>,
) -> Resampled<T> {
    let mut keys = Resampled { times: Vec::with_capacity(times.len()), values: Vec::with_capacity(times.len()) };
    let mut previous: Option<(f32, T)> = None;
    for &time in times {
        let key = (time, (curve.value)(time));
        if let Some(start) = previous {
            let just_before = time.next_down();
            if jumps.binary_search_by(|jump| jump.total_cmp(&time)).is_ok() && just_before > start.0 {
                let end = (just_before, (curve.value)(just_before));
                refine(curve, start, end, 0, &mut keys);
                keys.push(end);
            } else {
                refine(curve, start, key, 0, &mut keys);
            }
        }
        keys.push(key);
        previous = Some(key);
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
    let interpolate = |a: DVec3, b, factor| a.lerp(b, factor);
    resample(times, jumps, &Curve { value, interpolate, error: |a: DVec3, b| a.distance(b), tolerance })
}

/// Subdivides the interval between two keys until the tolerance is met.
fn refine<T: Copy>(
    curve: &Curve<impl Fn(f32) -> T, impl Fn(T, T, f64) -> T, impl Fn(T, T) -> f64>,
    start: (f32, T),
    end: (f32, T),
    halvings: u32,
    keys: &mut Resampled<T>,
) {
    let length = end.0 - start.0;
    let middle_secs = start.0 + 0.5 * length;
    if halvings == MAX_HALVINGS || middle_secs <= start.0 || middle_secs >= end.0 {
        return;
    }
    let error_at = |part: f32| {
        let time = start.0 + part * length;
        let factor = f64::from(time - start.0) / f64::from(length);
        (curve.error)((curve.interpolate)(start.1, end.1, factor), (curve.value)(time))
    };
    let max_error = [0.25, 0.5, 0.75].into_iter().map(error_at).fold(0.0, f64::max);
    if max_error <= curve.tolerance {
        return;
    }
    let middle = (middle_secs, (curve.value)(middle_secs));
    refine(curve, start, middle, halvings + 1, keys);
    keys.push(middle);
    refine(curve, middle, end, halvings + 1, keys);
}
