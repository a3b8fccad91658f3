//! Few keys that stay within a tolerance.
//!
//! FBX has curves of numbers, which for a rotation are Euler angles; glTF's rotations follow great arcs. So programs that read the
//! curves (Autodesk's, Unity, Unreal, Blender, ufbx) and those that take the rotations at the keys and follow arcs between them
//! (three.js, assimp) agree only if both are considered: where the source has straight segments, keys are left out only if an arc
//! between the others stays within the tolerance; between two keys, the curves are lines, or splines where lines would not do. Splines
//! of the source become as few splines as possible.

use gaitway_character::anim::Interpolation;
use glam::{DVec3, DVec4};

use crate::euler;
use crate::source::{Kind, Source, hermite, quaternion, straight};

/// Number of parts of the interval between two keys that are looked at, up to an angle of the rotation there, in radians. A spline needs
/// four to be found.
const PARTS: [(f64, usize); 4] = [(0.03, 4), (0.15, 8), (0.5, 16), (f64::INFINITY, 32)];
/// Angles that differ by more are looked at in between, in radians.
const MAX_STEP: f64 = 0.26;
/// How often an interval is halved for that.
const MAX_HALVINGS: u32 = 8;

/// Curves from a key to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// The key's value.
    Step,
    Linear,
    /// A cubic spline with these slopes per second at its ends.
    Cubic(DVec3, DVec3),
}

/// Keys of up to three curves. Angles are in radians.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    pub times: Vec<f64>,
    pub values: Vec<DVec3>,
    /// What follows each key; of the last one, nothing that counts.
    pub segments: Vec<Segment>,
}

impl Keys {
    fn push(&mut self, point: &Point, segment: Segment) {
        self.times.push(point.time);
        self.values.push(point.value);
        self.segments.push(segment);
    }
}

/// A place on the way of the source.
#[derive(Debug, Clone, Copy)]
struct Point {
    time: f64,
    exact: DVec4,
    /// What the curves should have here.
    value: DVec3,
    is_key: bool,
}

/// Fits curves to a source. `near` are angles that those of a rotation begin near.
pub fn fit(source: &Source, tolerance: f64, near: DVec3) -> Keys {
    let points = points(source, near);
    let mut keys = Keys::default();
    let Some(first) = points.first() else { return keys };
    let error = |value: DVec3, exact: DVec4| error(source.kind, value, exact);
    if points.iter().all(|point| error(first.value, point.exact) <= tolerance) {
        keys.push(first, Segment::Linear);
        return keys;
    }
    if source.interpolation == Interpolation::Step {
        let last = points.len() - 1;
        for (place, point) in points.iter().enumerate() {
            if place == last || keys.values.last() != Some(&point.value) {
                keys.push(point, Segment::Step);
            }
        }
        return keys;
    }
    let fitting = Fitting { source, tolerance, points: &points };
    let stops: Vec<usize> = (0..points.len()).filter(|&place| points[place].is_key).collect();
    let (mut from, mut stop) = (0, 1);
    while let Some(&next) = stops.get(stop) {
        let (to, segment) = fitting.longest(from, &stops[stop..]).unwrap_or_else(|| fitting.part(from, next));
        keys.push(&points[from], segment);
        from = to;
        stop += stops[stop..].partition_point(|&place| place <= from);
    }
    keys.push(&points[from], Segment::Linear);
    keys
}

/// Returns the places that are looked at.
fn points(source: &Source, near: DVec3) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    let mut last = near;
    for key in 0..source.times.len() {
        let exact = source.key(key);
        last = value(source.kind, exact, last);
        let at_key = Point { time: source.times[key], exact, value: last, is_key: true };
        points.push(at_key);
        let parts = if key + 1 == source.times.len() { 1 } else { parts(source, key) };
        if parts == 1 {
            continue;
        }
        for part in 0..parts {
            let ends = [part, part + 1].map(|part| part as f64 / parts as f64);
            add_points(source, key, ends, MAX_HALVINGS, &mut points);
            if part + 1 < parts
                && let Some(before) = points.last().copied()
            {
                points.push(point(source, key, ends[1], before.value));
            }
        }
        last = points.last().map_or(last, |point| point.value);
    }
    points
}

/// Returns how many parts of the interval after a key are looked at.
fn parts(source: &Source, key: usize) -> usize {
    let angle = match (source.interpolation, source.kind) {
        (Interpolation::Step, _) | (Interpolation::Linear, Kind::Numbers) => return 1,
        (_, Kind::Numbers) => 0.0,
        (_, Kind::Rotation) => euler::difference(quaternion(source.key(key)), quaternion(source.key(key + 1))),
    };
    PARTS.iter().find(|(most, _)| angle <= *most).map_or(1, |(_, parts)| *parts)
}

/// Adds the places between two of one interval: none, unless angles change much there.
fn add_points(source: &Source, key: usize, [from, to]: [f64; 2], halvings: u32, points: &mut Vec<Point>) {
    let Some(before) = points.last().copied() else { return };
    let after = point(source, key, to, before.value);
    if halvings == 0 || source.kind == Kind::Numbers || (after.value - before.value).abs().max_element() < MAX_STEP {
        return;
    }
    let middle = 0.5 * (from + to);
    add_points(source, key, [from, middle], halvings - 1, points);
    let near = points.last().map_or(before.value, |point| point.value);
    points.push(point(source, key, middle, near));
    add_points(source, key, [middle, to], halvings - 1, points);
}

fn point(source: &Source, key: usize, fraction: f64, near: DVec3) -> Point {
    let exact = source.between(key, fraction);
    let [from, to] = [source.times[key], source.times[key + 1]];
    Point { time: from + (to - from) * fraction, exact, value: value(source.kind, exact, near), is_key: false }
}

fn value(kind: Kind, exact: DVec4, near: DVec3) -> DVec3 {
    match kind {
        Kind::Numbers => exact.truncate(),
        Kind::Rotation => euler::nearest(quaternion(exact), near),
    }
}

fn error(kind: Kind, value: DVec3, exact: DVec4) -> f64 {
    match kind {
        Kind::Numbers => (value - exact.truncate()).abs().max_element(),
        Kind::Rotation => euler::difference(euler::quaternion(value), quaternion(exact)),
    }
}

struct Fitting<'a> {
    source: &'a Source,
    tolerance: f64,
    points: &'a [Point],
}

impl Fitting<'_> {
    /// Returns the farthest of the stops that one segment can reach, and the segment.
    fn longest(&self, from: usize, stops: &[usize]) -> Option<(usize, Segment)> {
        let segment = |stop: usize| self.segment(from, stops[stop]);
        let mut best = (0, segment(0)?);
        let (mut stride, mut beyond) = (1, stops.len());
        while best.0 + stride < stops.len() {
            match segment(best.0 + stride) {
                Some(found) => best = (best.0 + stride, found),
                None => {
                    beyond = best.0 + stride;
                    break;
                }
            }
            stride *= 2;
        }
        while best.0 + 1 < beyond {
            let middle = usize::midpoint(best.0, beyond);
            match segment(middle) {
                Some(found) => best = (middle, found),
                None => beyond = middle,
            }
        }
        Some((stops[best.0], best.1))
    }

    /// Returns a part of the way to the next stop that one segment can cover: at least to the next place.
    fn part(&self, from: usize, stop: usize) -> (usize, Segment) {
        let mut to = usize::midpoint(from, stop);
        while to > from + 1 {
            if let Some(segment) = self.segment(from, to) {
                return (to, segment);
            }
            to = usize::midpoint(from, to);
        }
        (from + 1, Segment::Linear)
    }

    /// Returns a segment between two places that stays within the tolerance, if there is one.
    fn segment(&self, from: usize, to: usize) -> Option<Segment> {
        let (start, end) = (&self.points[from], &self.points[to]);
        let inner = &self.points[from + 1..to];
        let length = end.time - start.time;
        let fraction = |point: &Point| (point.time - start.time) / length;
        let within = |value: DVec3, point: &Point| error(self.source.kind, value, point.exact) <= self.tolerance;
        if self.source.interpolation == Interpolation::Linear {
            let arc = |point: &Point| straight(self.source.kind, start.exact, end.exact, fraction(point));
            let is_near = |point: &Point| match self.source.kind {
                Kind::Numbers => within(arc(point).truncate(), point),
                Kind::Rotation => euler::difference(quaternion(arc(point)), quaternion(point.exact)) <= self.tolerance,
            };
            if !inner.iter().filter(|point| point.is_key).all(is_near) {
                return None;
            }
        }
        let line = |point: &Point| start.value + (end.value - start.value) * fraction(point);
        if inner.iter().all(|point| within(line(point), point)) {
            return Some(Segment::Linear);
        }
        let [out, arrival] = slopes(start, end, inner)?;
        let spline = |point: &Point| {
            let [a, b, c, d] = hermite(fraction(point));
            start.value * a + out * b + end.value * c + arrival * d
        };
        let follows = inner.iter().all(|point| within(spline(point), point));
        follows.then(|| Segment::Cubic(out / length, arrival / length))
    }
}

/// Returns the tangents of the spline between two places that is nearest to those in between: least squares.
fn slopes(start: &Point, end: &Point, inner: &[Point]) -> Option<[DVec3; 2]> {
    let (mut oo, mut oi, mut ii) = (0.0, 0.0, 0.0);
    let (mut out, mut arrival) = (DVec3::ZERO, DVec3::ZERO);
    for point in inner {
        let [a, b, c, d] = hermite((point.time - start.time) / (end.time - start.time));
        let rest = point.value - start.value * a - end.value * c;
        (oo, oi, ii) = (oo + b * b, oi + b * d, ii + d * d);
        out += rest * b;
        arrival += rest * d;
    }
    let determinant = oo * ii - oi * oi;
    let slopes = [(out * ii - arrival * oi) / determinant, (arrival * oo - out * oi) / determinant];
    slopes.iter().all(|slope| slope.is_finite()).then_some(slopes)
}
