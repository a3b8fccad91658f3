//! Keys for what no single channel says: a function of time is read at given times, and in between until straight
//! interpolation follows it closely enough.

/// Halvings of an interval between two given times.
const MOST_HALVINGS: u32 = 8;

/// Keys of one value over time, to be interpolated linearly.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled<T> {
    pub times: Vec<f32>,
    pub values: Vec<T>,
}

/// Ascending times without doubles.
pub fn union<'a>(timelines: impl IntoIterator<Item = &'a [f32]>) -> Vec<f32> {
    let mut times: Vec<f32> = timelines.into_iter().flatten().copied().collect();
    times.sort_by(f32::total_cmp);
    times.dedup();
    times
}

/// `times` ascending, without doubles. At `jumps` the value may change at once, so a key is put right before each.
/// `error` measures how far a value is from another in the unit of `tolerance`.
pub fn resample<T: Copy>(
    times: &[f32],
    jumps: &[f32],
    tolerance: f64,
    exact: impl Fn(f32) -> T,
    mix: impl Fn(T, T, f64) -> T,
    error: impl Fn(T, T) -> f64,
) -> Resampled<T> {
    let mut keys = Resampled { times: Vec::with_capacity(times.len()), values: Vec::with_capacity(times.len()) };
    let mut before: Option<(f32, T)> = None;
    for &time in times {
        let value = exact(time);
        if let Some(start) = before {
            let just_before = time.next_down();
            if jumps.binary_search_by(|jump| jump.total_cmp(&time)).is_ok() && just_before > start.0 {
                let end = (just_before, exact(just_before));
                refine(start, end, 0, tolerance, &exact, &mix, &error, &mut keys);
                keys.push(end);
            } else {
                refine(start, (time, value), 0, tolerance, &exact, &mix, &error, &mut keys);
            }
        }
        keys.push((time, value));
        before = Some((time, value));
    }
    keys
}

impl<T> Resampled<T> {
    fn push(&mut self, (time, value): (f32, T)) {
        self.times.push(time);
        self.values.push(value);
    }
}

/// Adds the keys that are needed between two.
#[expect(clippy::too_many_arguments, reason = "one recursion over three functions")]
fn refine<T: Copy>(
    start: (f32, T),
    end: (f32, T),
    halvings: u32,
    tolerance: f64,
    exact: &impl Fn(f32) -> T,
    mix: &impl Fn(T, T, f64) -> T,
    error: &impl Fn(T, T) -> f64,
    keys: &mut Resampled<T>,
) {
    let length = end.0 - start.0;
    let middle_secs = start.0 + 0.5 * length;
    if halvings == MOST_HALVINGS || middle_secs <= start.0 || middle_secs >= end.0 {
        return;
    }
    let off = |part: f32| {
        let time = start.0 + part * length;
        let factor = f64::from(time - start.0) / f64::from(length);
        error(mix(start.1, end.1, factor), exact(time))
    };
    let worst = [0.25, 0.5, 0.75].into_iter().map(off).fold(0.0, f64::max);
    if worst <= tolerance {
        return;
    }
    let middle = (middle_secs, exact(middle_secs));
    refine(start, middle, halvings + 1, tolerance, exact, mix, error, keys);
    keys.push(middle);
    refine(middle, end, halvings + 1, tolerance, exact, mix, error, keys);
}
