//! Turns a function of time into glTF keys that follow it within a tolerance.
//!
//! FBX curves are piecewise cubics in Euler angles, glTF has cubics in quaternions. Between two keys of the file the
//! motion is smooth, so a cubic with the right slopes at both ends follows it closely; where it doesn't, the piece is
//! halved. Then redundant keys are removed. Linear, stepped and constant motion is written as such.

/// Positions between two keys at which the fit is compared with the function: unevenly spaced, so that a motion that
/// repeats inside a piece is noticed, and close to the ends, where steep tangents act.
const CHECKS: [f64; 7] = [0.04, 0.15, 0.31, 0.5, 0.69, 0.85, 0.96];
/// Minimum dot product of the quaternions at a piece's ends, so that it turns by 160° at most. At 180°, rounding would decide in
/// which direction.
const MIN_COSINE: f64 = 0.17;
/// Maximum number of times a piece is halved.
const MAX_HALVINGS: u32 = 10;
/// Maximum number of pieces that are merged into one, which bounds the time for merging.
const MAX_MERGED: usize = 64;

/// Time where the function may have a corner or a jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Seconds from the start of the clip.
    pub time: f32,
    /// Whether the value may jump here.
    pub jump: bool,
}

/// How values are compared and interpolated.
#[derive(Clone, Copy, PartialEq)]
pub enum Space {
    /// Component by component.
    Linear,
    /// Unit quaternions.
    Rotation,
}

/// The interpolations of glTF.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Interpolation {
    Linear,
    Step,
    CubicSpline,
}

/// Keys of one channel.
#[derive(Debug)]
pub struct Keys {
    pub interpolation: Interpolation,
    pub times: Vec<f32>,
    /// One value per key; with `CubicSpline` in-tangent, value and out-tangent.
    pub values: Vec<f32>,
}

/// A function of time, its number of components, and the tolerance of its keys.
pub struct Track<'a> {
    pub sample: &'a mut dyn FnMut(f64, &mut [f64]),
    pub width: usize,
    pub space: Space,
    pub tolerance: f64,
    /// Evaluations left for the whole file. When they are used up, pieces are no longer halved.
    pub budget: &'a mut u64,
}

/// A piece between two neighbouring keys, with the function's values for checking.
struct Piece {
    times: [f32; 2],
    /// Value at the start, slope at the start, slope at the end, value at the end.
    ends: [Vec<f64>; 4],
    /// Values at `CHECKS`, one after the other.
    checks: Vec<f64>,
}

/// Fits keys to a track from the first to the last corner.
pub fn fit(track: &mut Track, corners: &[Corner]) -> Keys {
    let mut runs: Vec<Vec<Piece>> = Vec::new();
    let mut start = corners[0].time;
    let mut value = track.at(start, None);
    let mut jumped = true;
    for pair in corners.windows(2) {
        let corner = pair[1];
        if jumped {
            runs.push(Vec::new());
        }
        let before = if corner.jump { before(corner.time, start) } else { corner.time };
        let end = track.at(before, Some(&value));
        let run = runs.len() - 1;
        track.split([start, before], [value, end], 0, &mut runs[run]);
        // Its sign may have been flipped.
        let end = runs[run].last().map_or_else(Vec::new, |piece| piece.ends[3].clone());
        jumped = corner.jump;
        value = if jumped { track.after(corner.time, &end) } else { end };
        start = corner.time;
    }
    if jumped {
        runs.push(Vec::new());
    }
    track.keys(&runs, (start, value))
}

impl Track<'_> {
    fn at(&mut self, time: f32, align: Option<&[f64]>) -> Vec<f64> {
        self.value(f64::from(time), align)
    }

    fn value(&mut self, time: f64, align: Option<&[f64]>) -> Vec<f64> {
        *self.budget = self.budget.saturating_sub(1);
        let mut value = vec![0.0; self.width];
        (self.sample)(time, &mut value);
        if let Some(other) = align.filter(|_| self.space == Space::Rotation)
            && dot(&value, other) < 0.0
        {
            value.iter_mut().for_each(|component| *component = -*component);
        }
        value
    }

    /// Returns the value just after a jump, whose time may have been rounded down.
    fn after(&mut self, time: f32, align: &[f64]) -> Vec<f64> {
        let here = self.at(time, Some(align));
        let later = self.value(f64::from(time) + 2.0 * f64::from(time.next_up() - time), Some(align));
        if self.error(&here, &later) < 0.5 * self.error(&later, align) { here } else { later }
    }

    /// Adds the pieces from one corner to the next.
    fn split(&mut self, times: [f32; 2], [start, end]: [Vec<f64>; 2], halvings: u32, pieces: &mut Vec<Piece>) {
        let [from, to] = times.map(f64::from);
        let duration = to - from;
        let slopes = [self.slope(from, duration, &start), self.slope(to, -duration, &end)];
        let mut checks = Vec::with_capacity(CHECKS.len() * self.width);
        for at in CHECKS {
            checks.extend(self.value(from + at * duration, Some(&start)));
        }
        let [slope_start, slope_end] = slopes;
        let piece = Piece { times, ends: [start, slope_start, slope_end, end], checks };
        let middle = ((from + to) / 2.0) as f32;
        let splits = halvings < MAX_HALVINGS && *self.budget > 0 && times[0] < middle && middle < times[1];
        if !splits || self.follows(std::slice::from_ref(&piece), Interpolation::CubicSpline) {
            pieces.push(piece);
            return;
        }
        let [start, _, _, end] = piece.ends;
        let half = self.at(middle, Some(&start));
        self.split([times[0], middle], [start, half], halvings + 1, pieces);
        // A quaternion whose sign has been flipped since then flips the end as well.
        let half = pieces.last().map_or_else(Vec::new, |piece| piece.ends[3].clone());
        let end = if dot(&half, &end) < 0.0 && self.space == Space::Rotation {
            end.iter().map(|component| -component).collect()
        } else {
            end
        };
        self.split([middle, times[1]], [half, end], halvings + 1, pieces);
    }

    /// Returns the one-sided derivative at an end of a piece; `duration` is negative at its end.
    fn slope(&mut self, time: f64, duration: f64, value: &[f64]) -> Vec<f64> {
        let step = duration / 256.0;
        if step == 0.0 {
            return vec![0.0; self.width];
        }
        let [one, two, three] = [1.0, 2.0, 3.0].map(|steps| self.value(time + steps * step, Some(value)));
        // Exact for a cubic, as translations between two keys are.
        (0..self.width)
            .map(|i| (18.0 * one[i] - 11.0 * value[i] - 9.0 * two[i] + 2.0 * three[i]) / (6.0 * step))
            .collect()
    }

    /// Returns whether one span over all of the pieces follows the function.
    fn follows(&self, pieces: &[Piece], interpolation: Interpolation) -> bool {
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return true };
        let span = Span {
            times: [f64::from(first.times[0]), f64::from(last.times[1])],
            ends: [&first.ends[0], &first.ends[1], &last.ends[2], &last.ends[3]],
        };
        if self.space == Space::Rotation && dot(span.ends[0], span.ends[3]) < MIN_COSINE {
            return false;
        }
        let mut value = vec![0.0; self.width];
        let mut close = |time: f64, expected: &[f64]| {
            span.value(time, interpolation, self.space, &mut value);
            self.error(&value, expected) <= self.tolerance
        };
        pieces.iter().enumerate().all(|(index, piece)| {
            let [from, to] = piece.times.map(f64::from);
            let inside = CHECKS
                .iter()
                .zip(piece.checks.chunks_exact(self.width))
                .all(|(at, expected)| close(from + at * (to - from), expected));
            inside && (index + 1 == pieces.len() || close(to, &piece.ends[3]))
        })
    }

    /// Returns the distance of two values: the angle between rotations, else the length of the difference.
    fn error(&self, a: &[f64], b: &[f64]) -> f64 {
        let sign = if self.space == Space::Rotation && dot(a, b) < 0.0 { -1.0 } else { 1.0 };
        let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - sign * b) * (a - sign * b)).sum();
        let error = squares.sqrt();
        if self.space == Space::Rotation { 2.0 * error } else { error }
    }

    /// Chooses the interpolation and leaves out what it doesn't need.
    fn keys(&self, runs: &[Vec<Piece>], last: (f32, Vec<f64>)) -> Keys {
        if self.is_constant(runs, &last.1) {
            return self.constant(runs, &last);
        }
        let stepped = runs.iter().flatten().all(|piece| {
            let mut values = piece.checks.chunks_exact(self.width).chain([&piece.ends[3][..]]);
            values.all(|value| self.error(value, &piece.ends[0]) <= self.tolerance)
        });
        if stepped {
            return self.steps(runs, &last);
        }
        let cubic: Vec<Vec<usize>> = runs.iter().map(|run| self.merged(run, Interpolation::CubicSpline)).collect();
        let cubic_keys: usize = cubic.iter().map(Vec::len).sum();
        if runs.iter().flatten().all(|piece| self.follows(std::slice::from_ref(piece), Interpolation::Linear)) {
            let linear: Vec<Vec<usize>> = runs.iter().map(|run| self.merged(run, Interpolation::Linear)).collect();
            let linear_keys: usize = linear.iter().map(Vec::len).sum();
            if linear_keys * (1 + self.width) <= cubic_keys * (1 + 3 * self.width) {
                return self.write(runs, &linear, &last, Interpolation::Linear);
            }
        }
        self.write(runs, &cubic, &last, Interpolation::CubicSpline)
    }

    fn is_constant(&self, runs: &[Vec<Piece>], last: &[f64]) -> bool {
        let values =
            runs.iter().flatten().flat_map(|piece| piece.checks.chunks_exact(self.width).chain([&piece.ends[0][..]]));
        values.into_iter().all(|value| self.error(value, last) <= self.tolerance)
    }

    fn constant(&self, runs: &[Vec<Piece>], (end, value): &(f32, Vec<f64>)) -> Keys {
        let start = runs.iter().flatten().next().map_or(*end, |piece| piece.times[0]);
        let times = if start < *end { vec![start, *end] } else { vec![*end] };
        let values = times.iter().flat_map(|_| value.iter().map(|&component| component as f32)).collect();
        Keys { interpolation: Interpolation::Linear, times, values }
    }

    /// Keeps the keys at which the value changes, and the last one for the clip's duration.
    fn steps(&self, runs: &[Vec<Piece>], last: &(f32, Vec<f64>)) -> Keys {
        let mut keys = Keys { interpolation: Interpolation::Step, times: Vec::new(), values: Vec::new() };
        let mut kept: Option<&[f64]> = None;
        for piece in runs.iter().flatten() {
            if kept.is_none_or(|value| self.error(value, &piece.ends[0]) > self.tolerance) {
                keys.push(piece.times[0], [&piece.ends[0]]);
                kept = Some(&piece.ends[0]);
            }
        }
        keys.push(last.0, [&last.1]);
        keys
    }

    /// Returns how many pieces each span covers when as many as possible are merged, greedily from the start.
    fn merged(&self, run: &[Piece], interpolation: Interpolation) -> Vec<usize> {
        let mut spans = Vec::new();
        let mut start = 0;
        while start < run.len() {
            let mut count = 1;
            while count < MAX_MERGED
                && start + count < run.len()
                && self.follows(&run[start..=start + count], interpolation)
            {
                count += 1;
            }
            spans.push(count);
            start += count;
        }
        // Few keys saved are worth less than times shared with other channels.
        if spans.len() * 4 > run.len() * 3 { vec![1; run.len()] } else { spans }
    }

    fn write(
        &self,
        runs: &[Vec<Piece>],
        spans: &[Vec<usize>],
        last: &(f32, Vec<f64>),
        interpolation: Interpolation,
    ) -> Keys {
        let mut keys = Keys { interpolation, times: Vec::new(), values: Vec::new() };
        let flat = vec![0.0; self.width];
        for (run, spans) in runs.iter().zip(spans) {
            let mut incoming = &flat;
            let mut start = 0;
            for &count in spans {
                let (first, end) = (&run[start], &run[start + count - 1]);
                keys.push_shaped(first.times[0], incoming, &first.ends[0], &first.ends[1]);
                incoming = &end.ends[2];
                start += count;
            }
            if let Some(end) = run.last() {
                keys.push_shaped(end.times[1], incoming, &end.ends[3], &flat);
            }
        }
        // The last corner is its own key only after a jump.
        if keys.times.last().is_none_or(|&time| time < last.0) {
            keys.push_shaped(last.0, &flat, &last.1, &flat);
        }
        keys
    }
}

impl Keys {
    fn push_shaped(&mut self, time: f32, incoming: &[f64], value: &[f64], outgoing: &[f64]) {
        if self.interpolation == Interpolation::CubicSpline {
            self.push(time, [incoming, value, outgoing]);
        } else {
            self.push(time, [value]);
        }
    }

    fn push<const COUNT: usize>(&mut self, time: f32, values: [&[f64]; COUNT]) {
        if self.times.last().is_some_and(|&last| last >= time) {
            return;
        }
        self.times.push(time);
        for value in values {
            self.values.extend(value.iter().map(|&component| component as f32));
        }
    }
}

/// Two keys and what lies between them.
struct Span<'a> {
    times: [f64; 2],
    /// As in [`Piece`].
    ends: [&'a Vec<f64>; 4],
}

impl Span<'_> {
    /// Interpolates as specified in glTF 2.0, appendix C.
    fn value(&self, time: f64, interpolation: Interpolation, space: Space, out: &mut [f64]) {
        let duration = self.times[1] - self.times[0];
        let t = if duration > 0.0 { (time - self.times[0]) / duration } else { 0.0 };
        let [start, slope_start, slope_end, end] = self.ends;
        let weights = match (interpolation, space) {
            (Interpolation::Step, _) => [1.0, 0.0, 0.0, 0.0],
            (Interpolation::CubicSpline, _) => hermite(t, duration),
            (Interpolation::Linear, Space::Linear) => [1.0 - t, 0.0, 0.0, t],
            (Interpolation::Linear, Space::Rotation) => slerp(dot(start, end), t),
        };
        for (i, out) in out.iter_mut().enumerate() {
            *out =
                weights[0] * start[i] + weights[1] * slope_start[i] + weights[2] * slope_end[i] + weights[3] * end[i];
        }
        if space == Space::Rotation {
            let length = dot(out, out).sqrt();
            if length > 0.0 {
                out.iter_mut().for_each(|component| *component /= length);
            }
        }
    }
}

fn hermite(t: f64, duration: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, duration * (t3 - 2.0 * t2 + t), duration * (t3 - t2), 3.0 * t2 - 2.0 * t3]
}

fn slerp(cosine: f64, t: f64) -> [f64; 4] {
    let sign = if cosine < 0.0 { -1.0 } else { 1.0 };
    let cosine = cosine.abs().min(1.0);
    let angle = libm::acos(cosine);
    let sine = libm::sin(angle);
    if sine < 1e-6 {
        return [1.0 - t, 0.0, 0.0, sign * t];
    }
    [libm::sin((1.0 - t) * angle) / sine, 0.0, 0.0, sign * libm::sin(t * angle) / sine]
}

/// Returns the time just before a jump, at least that of the key before.
fn before(time: f32, earlier: f32) -> f32 {
    time.next_down().max(earlier)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(times: &[f32]) -> Vec<Corner> {
        times.iter().map(|&time| Corner { time, jump: false }).collect()
    }

    fn fitted(space: Space, width: usize, corners: &[Corner], mut sample: impl FnMut(f64, &mut [f64])) -> Keys {
        let mut budget = 1_000_000;
        let mut track = Track { sample: &mut sample, width, space, tolerance: 1e-6, budget: &mut budget };
        fit(&mut track, corners)
    }

    #[test]
    fn a_straight_line_keeps_its_ends() {
        let keys = fitted(Space::Linear, 1, &corners(&[0.0, 0.25, 0.5, 1.0]), |t, out| out[0] = 3.0 * t);
        assert_eq!(keys.interpolation, Interpolation::Linear);
        assert_eq!((keys.times, keys.values), (vec![0.0, 1.0], vec![0.0, 3.0]));
    }

    #[test]
    fn a_corner_stays() {
        let keys = fitted(Space::Linear, 1, &corners(&[0.0, 0.5, 1.0]), |t, out| out[0] = (t - 0.5).abs());
        assert_eq!((keys.times, keys.values), (vec![0.0, 0.5, 1.0], vec![0.5, 0.0, 0.5]));
    }

    #[test]
    fn what_never_changes_has_one_value() {
        let keys = fitted(Space::Linear, 1, &corners(&[0.0, 0.3, 2.0]), |_, out| out[0] = 7.0);
        assert_eq!((keys.times, keys.values), (vec![0.0, 2.0], vec![7.0, 7.0]));
    }

    #[test]
    fn steps_are_steps() {
        let jumps = [0.0, 1.0, 2.0, 3.0].map(|time| Corner { time, jump: true });
        let keys =
            fitted(Space::Linear, 1, &jumps, |t, out| out[0] = if t < 1.0 { 1.0 } else { t.floor().min(2.0) * 2.0 });
        assert_eq!(keys.interpolation, Interpolation::Step);
        assert_eq!((keys.times, keys.values), (vec![0.0, 1.0, 2.0, 3.0], vec![1.0, 2.0, 4.0, 4.0]));
    }

    #[test]
    fn a_jump_between_slopes_has_two_keys() {
        let jump = [(0.0, false), (1.0, true), (2.0, false)].map(|(time, jump)| Corner { time, jump });
        let keys = fitted(Space::Linear, 1, &jump, |t, out| out[0] = if t < 1.0 { t } else { 10.0 - t });
        assert_eq!(keys.interpolation, Interpolation::Linear);
        assert_eq!(keys.times, [0.0, 1.0_f32.next_down(), 1.0, 2.0]);
        assert!((keys.values[1] - 1.0).abs() < 1e-5 && (keys.values[2] - 9.0).abs() < 1e-5, "{keys:?}");
    }

    #[test]
    fn a_cubic_is_one_span() {
        let keys = fitted(Space::Linear, 1, &corners(&[0.0, 0.5, 1.0, 1.5, 2.0]), |t, out| out[0] = t * t * (3.0 - t));
        assert_eq!(keys.interpolation, Interpolation::CubicSpline);
        assert_eq!(keys.times, [0.0, 2.0]);
        for (value, expected) in keys.values.iter().zip([0.0, 0.0, 0.0, 0.0, 4.0, 0.0]) {
            assert!((value - expected).abs() < 1e-3, "{keys:?}");
        }
    }

    #[test]
    fn three_turns_between_two_keys_are_followed() {
        let turn = |t: f64, out: &mut [f64]| {
            let half = 3.0 * std::f64::consts::PI * t;
            out.copy_from_slice(&[0.0, half.sin(), 0.0, half.cos()]);
        };
        let keys = fitted(Space::Rotation, 4, &corners(&[0.0, 1.0]), turn);
        assert!(keys.times.len() > 6, "{:?}", keys.times);
        assert_eq!(keys.interpolation, Interpolation::Linear, "a turn of even speed");
    }

    /// However the last bits of the keys fall.
    #[test]
    fn no_rotation_turns_back() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.36, 0.48, 0.8], [-0.6, 0.0, 0.8]];
        let speeds = [(1.0, false), (2.0, false), (0.7, false), (1.0, true), (2.0, true)];
        for degrees in [-1440, -1080, -720, -540, -360, -180, 180, 360, 540, 720, 1080, 1440] {
            for (duration, is_eased) in speeds {
                axes.iter().for_each(|&axis| check_turn(degrees.into(), duration, is_eased, axis));
            }
        }
    }

    fn check_turn(degrees: f64, duration: f64, is_eased: bool, axis: [f64; 3]) {
        let angle = |time: f64| {
            let t = time / duration;
            degrees.to_radians() * if is_eased { t * t * (3.0 - 2.0 * t) } else { t }
        };
        let turn = |time: f64, out: &mut [f64]| {
            let (sin, cos) = (0.5 * angle(time)).sin_cos();
            out.copy_from_slice(&[axis[0] * sin, axis[1] * sin, axis[2] * sin, cos]);
        };
        let keys = fitted(Space::Rotation, 4, &corners(&[0.0, duration as f32]), turn);
        for at in 0..keys.times.len() - 1 {
            for (time, found) in within_piece(&keys, at) {
                let mut expected = [0.0; 4];
                turn(time, &mut expected);
                let cosine = dot(&found, &expected).abs();
                assert!(cosine > 1.0 - 1e-6, "{degrees}° in {duration} s about {axis:?}, at {time}: {cosine}");
            }
        }
    }

    /// Samples one piece the way a reader of the file does.
    fn within_piece(keys: &Keys, at: usize) -> [(f64, [f64; 4]); 9] {
        let is_cubic = keys.interpolation == Interpolation::CubicSpline;
        let parts = if is_cubic { 3 } else { 1 };
        let key = |at: usize, part: usize| -> Vec<f64> {
            let start = 4 * (parts * at + if is_cubic { part } else { 0 });
            keys.values[start..start + 4].iter().map(|&component| component.into()).collect()
        };
        let ends = [key(at, 1), key(at, 2), key(at + 1, 0), key(at + 1, 1)];
        let times = [at, at + 1].map(|at| f64::from(keys.times[at]));
        let span = Span { times, ends: [&ends[0], &ends[1], &ends[2], &ends[3]] };
        std::array::from_fn(|step| {
            let time = times[0] + step as f64 / 8.0 * (times[1] - times[0]);
            let mut found = [0.0; 4];
            span.value(time, keys.interpolation, Space::Rotation, &mut found);
            (time, found)
        })
    }

    #[test]
    fn a_used_up_budget_ends() {
        let mut budget = 0;
        let mut sample = |t: f64, out: &mut [f64]| out[0] = (t * 1000.0).sin();
        let mut track =
            Track { sample: &mut sample, width: 1, space: Space::Linear, tolerance: 1e-9, budget: &mut budget };
        assert_eq!(fit(&mut track, &corners(&[0.0, 1.0])).times.len(), 2);
    }
}
