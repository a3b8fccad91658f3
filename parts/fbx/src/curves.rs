//! Which curves animate what, and when they have keys.

use gaitway_glb::Warnings;
use ufbx::{AnimCurve, AnimLayer, AnimStack, AnimValue, ExtrapolationMode, Interpolation};

use crate::fit::Corner;

/// Evaluations of a transform for halving pieces: the minimum, and the number per key. When they are used up, curves
/// are followed less closely.
const MIN_EVALUATIONS: u64 = 2_000_000;
const EVALUATIONS_PER_KEY: u64 = 40;
/// Maximum number of keys of one channel, including all repetitions; keys of several curves at the same time count once.
const MAX_CORNERS: usize = 1 << 18;
/// Maximum number of keys read from a file, counting those of repetitions and shared curves wherever they appear.
const MAX_KEYS: usize = 1 << 22;
/// Maximum number of keys from the repetitions of curves; beyond, they are followed less closely.
const MAX_REPEATED_KEYS: usize = 1 << 16;
/// Maximum length of a clip, in seconds: a day.
const MAX_SECS: f64 = 86_400.0;
/// Minimum difference between the ends of a clip and of its keys that counts: most programs differ by a frame.
const MIN_DIFFERENCE_SECS: f64 = 0.1;
/// The properties that a node's transform is made of.
pub const TRANSLATION_PROPERTIES: [&str; 5] =
    ["Lcl Translation", "RotationOffset", "RotationPivot", "ScalingOffset", "ScalingPivot"];
pub const ROTATION_PROPERTIES: [&str; 4] = ["Lcl Rotation", "PreRotation", "PostRotation", "RotationOrder"];
pub const SCALE_PROPERTIES: [&str; 1] = ["Lcl Scaling"];
/// The properties that make the translation depend on rotation and scale.
pub const PIVOT_PROPERTIES: [&str; 3] = ["RotationPivot", "ScalingPivot", "ScalingOffset"];

/// The remaining limits of the whole file.
pub struct Limits {
    /// Evaluations of a transform for halving pieces.
    pub evaluations: u64,
    keys: usize,
    repeated_keys: usize,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits { evaluations: MIN_EVALUATIONS, keys: MAX_KEYS, repeated_keys: MAX_REPEATED_KEYS }
    }
}

impl Limits {
    /// Returns whether curves could not be followed as closely as all others.
    pub fn are_reached(&self) -> bool {
        self.evaluations == 0 || self.repeated_keys < 2
    }
}

/// The animated properties of a stack, by element.
pub struct Curves<'a> {
    /// Element, property and curves, sorted by element.
    pub properties: Vec<(u32, &'a str, &'a AnimValue)>,
    pub layer_weights: Vec<&'a AnimValue>,
}

impl<'a> Curves<'a> {
    pub fn new(stack: &'a AnimStack) -> Curves<'a> {
        let layers = stack.anim.layers.into_iter();
        let props = layers.flat_map(|layer: &AnimLayer| &layer.anim_props);
        let mut properties: Vec<_> =
            props.map(|prop| (prop.element.element_id, &*prop.prop_name, &*prop.anim_value)).collect();
        properties.sort_by_key(|&(element, ..)| element);
        let weights = |&(element, name, value): &(u32, &str, &'a AnimValue)| {
            let layer = stack.anim.layers.into_iter().any(|layer| layer.element.element_id == element);
            (layer && name == "Weight").then_some(value)
        };
        let layer_weights = properties.iter().filter_map(weights).collect();
        Curves { properties, layer_weights }
    }

    /// Returns the values that animate any of the properties of an element.
    pub fn of(&self, element: u32, names: &'static [&'static str]) -> impl Iterator<Item = &'a AnimValue> + '_ {
        let start = self.properties.partition_point(|&(other, ..)| other < element);
        let rest = self.properties.get(start..).unwrap_or_default();
        let own = rest.iter().take_while(move |&&(other, ..)| other == element);
        own.filter(|(_, name, _)| names.contains(name)).map(|&(_, _, value)| value)
    }

    fn all(&self) -> impl Iterator<Item = &AnimCurve> {
        self.properties.iter().flat_map(|(_, _, value)| curves(value))
    }

    /// Returns whether there is any key.
    pub fn have_keys(&self) -> bool {
        self.all().any(|curve| !curve.keyframes.is_empty())
    }

    /// Returns the times of the first and the last key.
    fn key_range(&self) -> [f64; 2] {
        let with_keys = self.all().filter(|curve| !curve.keyframes.is_empty());
        let times = with_keys.map(|curve| (curve.min_time, curve.max_time));
        times.fold([f64::INFINITY, f64::NEG_INFINITY], |[first, last], (from, to)| [first.min(from), last.max(to)])
    }

    /// Returns the time range of the stack and of the keys after it, or that of the keys; none if that is implausible.
    pub fn range(&self, stack: &AnimStack) -> Option<[f64; 2]> {
        let [first, last] = self.key_range();
        let is_valid = |[from, to]: [f64; 2]| {
            first.is_finite() && last.is_finite() && from.is_finite() && (0.0..=MAX_SECS).contains(&(to - from))
        };
        let stated = [stack.time_begin, stack.time_end];
        let [from, to] = if stated[0] < stated[1] { stated } else { [first, last] };
        let extended = [from, if last > to + MIN_DIFFERENCE_SECS { last } else { to }];
        [extended, [from, to]].into_iter().find(|range| is_valid(*range))
    }

    /// Warns if a clip ends at another time than its keys.
    pub fn warn_of_length(&self, stack: &AnimStack, [from, to]: [f64; 2], warnings: &mut Warnings) {
        let name = &*stack.element.name;
        let [_, last] = self.key_range();
        let repeats = |curve: &AnimCurve| curve.post_extrapolation.mode != ExtrapolationMode::Constant;
        if stack.time_begin < stack.time_end && to > stack.time_end {
            let [stop, end] = [stack.time_end, to].map(|time| seconds(time - from));
            warnings
                .add(format!("Clip \"{name}\" has keys after its end (LocalStop) at {stop} s: kept, up to {end} s."));
        } else if to > last + MIN_DIFFERENCE_SECS && !self.all().any(repeats) {
            let [last, end] = [last, to].map(|time| seconds(time - from));
            warnings.add(format!(
                "Clip \"{name}\" is longer than its keys, which end at {last} s: it stands still until {end} s."
            ));
        }
    }
}

/// Returns a time with three decimals. Formatting floats would take several kilobytes.
fn seconds(time: f64) -> String {
    let milliseconds = (1000.0 * time.max(0.0) + 0.5) as u64;
    format!("{}.{:03}", milliseconds / 1000, milliseconds % 1000)
}

fn curves(value: &AnimValue) -> impl Iterator<Item = &AnimCurve> {
    value.curves.iter().flatten().map(|curve| &**curve)
}

/// What animates one property of a node or one mesh's weights.
#[derive(Default)]
pub struct Drivers<'a> {
    pub values: Vec<&'a AnimValue>,
}

impl<'a> Drivers<'a> {
    pub fn is_animated(&self) -> bool {
        !self.values.is_empty()
    }

    /// Returns whether any curve changes.
    pub fn vary(&self) -> bool {
        self.values.iter().flat_map(|value| curves(value)).any(|curve| {
            let first = curve.keyframes.first().map_or(0.0, |key| key.value);
            let flat = |key: &ufbx::Keyframe| key.value == first && key.left.dy == 0.0 && key.right.dy == 0.0;
            !curve.keyframes.into_iter().all(flat)
        })
    }

    /// Returns the times of all keys within the range, from its start, and whether the value may jump there.
    pub fn corners(&self, [from, to]: [f64; 2], limits: &mut Limits) -> Result<Vec<Corner>, String> {
        let end = (to - from) as f32;
        let mut corners = vec![Corner { time: 0.0, jump: false }, Corner { time: end, jump: false }];
        if self.vary() {
            for curve in self.values.iter().flat_map(|value| curves(value)) {
                add_corners(curve, [from, to], &mut corners, limits);
            }
        }
        limits.evaluations += EVALUATIONS_PER_KEY * corners.len() as u64;
        corners.retain(|corner| (0.0..=end).contains(&corner.time));
        corners.sort_unstable_by(|a, b| a.time.total_cmp(&b.time));
        corners.dedup_by(|later, earlier| {
            let same = later.time == earlier.time;
            earlier.jump |= same && later.jump;
            same
        });
        if corners.len() > MAX_CORNERS {
            return Err(format!(
                "an animation curve has too many keys: expected at most {MAX_CORNERS}, found {}. Export it with fewer.",
                corners.len()
            ));
        }
        limits.keys = limits.keys.saturating_sub(corners.len());
        if limits.keys == 0 {
            return Err(format!("the animation has too many keys: expected at most {MAX_KEYS}. Export fewer takes."));
        }
        Ok(corners)
    }
}

/// Adds the keys of a curve and of its repetitions within the range.
fn add_corners(curve: &AnimCurve, [from, to]: [f64; 2], corners: &mut Vec<Corner>, limits: &mut Limits) {
    let keys: Vec<(f64, bool)> = curve
        .keyframes
        .into_iter()
        .enumerate()
        .map(|(index, key)| {
            let earlier = index.checked_sub(1).and_then(|earlier| curve.keyframes.get(earlier));
            let arrives = earlier.is_some_and(|key| key.interpolation == Interpolation::ConstantPrev);
            (key.time, arrives || key.interpolation == Interpolation::ConstantNext)
        })
        .collect();
    let mut add = |time: f64, jump: bool| corners.push(Corner { time: (time - from) as f32, jump });
    keys.iter().filter(|(time, _)| (from..=to).contains(time)).for_each(|&(time, jump)| add(time, jump));
    let (first, last) = (curve.min_time, curve.max_time);
    let period = last - first;
    for (extrapolation, gap) in [(&curve.pre_extrapolation, first - from), (&curve.post_extrapolation, to - last)] {
        let mirrors = extrapolation.mode == ExtrapolationMode::Mirror;
        let repeats = matches!(extrapolation.mode, ExtrapolationMode::Repeat | ExtrapolationMode::RepeatRelative);
        if !(mirrors || repeats) || gap <= 0.0 || period <= 0.0 {
            continue;
        }
        let wanted = (gap / period).ceil();
        let wanted =
            if extrapolation.repeat_count < 0 { wanted } else { wanted.min(extrapolation.repeat_count.into()) };
        let room = (limits.repeated_keys / keys.len().max(1)) as f64;
        let count = wanted.min(room) as usize;
        limits.repeated_keys -= count * keys.len();
        let after = gap == to - last;
        for repetition in 0..count {
            let start = repetition as f64 * period;
            for &(time, jump) in &keys {
                // How far the key is from the nearest end of the curve, in this repetition.
                let away = if (mirrors && repetition % 2 == 0) == after { last - time } else { time - first };
                let seam = repeats && (time == first || time == last);
                add(if after { last + start + away } else { first - start - away }, jump || seam);
            }
        }
    }
}
