//! Pins baked into a clip: what they set gets linear keys, as few as a greedy search finds; other channels are kept.

use glam::DQuat;

use super::{Pin, PinTimes, Pinning};
use crate::anim::{Clip, Interpolation, JointIndex, Pose, SampleCursor};
use crate::retarget::change::track::{Target, Track, Tracks};
use crate::retarget::keys::limits::{BETWEEN_KEYS, BETWEEN_SAMPLES, Limits};
use crate::retarget::keys::resample::{MAX_HALVINGS, fewest, union};
use crate::retarget::math::slerp;
use crate::retarget::pose::{WorldPose, is_within, locals_of};

/// Longest time between samples.
const MAX_STEP_SECS: f32 = 1.0 / 60.0;
/// Most samples between two keys, as if these were ten seconds apart: a damaged file has keys at any times. Where joints turn fast,
/// there are more.
const MAX_STEPS: f32 = 600.0;

impl Pinning<'_> {
    /// Returns a clip with the pins baked in. It repeats after `period_secs`, and so do the times of the pins.
    pub fn bake(&self, clip: &Clip, period_secs: f64) -> Clip {
        let skeleton = &self.asset.skeleton;
        let mut sampled = Sampled::new(self, clip, period_secs);
        let mut tracks = Tracks::of(clip);
        for (joint, pin) in self.in_order() {
            // With an overlapping pin, both search for their own keys.
            let Some(pinned) = self.pinned_joints(joint, pin) else { continue };
            let times = sampled.close_times(&pinned);
            let kept = fewest(times.len(), |from, to| {
                sampled.is_close([times[from], times[to]], &times[from + 1..to], BETWEEN_KEYS, &pinned)
            });
            let times_kept: Vec<f32> = kept.iter().map(|&at| times[at]).collect();
            let mut replace = |target, width, values| {
                tracks.tracks.retain(|track| track.target != target);
                let (interpolation, times) = (Interpolation::Linear, times_kept.clone());
                tracks.tracks.push(Track { target, interpolation, times, width, values });
            };
            for &joint in &pinned.turned {
                let rotation = |&time: &f32| sampled.at(time).local(joint).rotation.to_array();
                replace(Target::Rotation(joint), 4, times_kept.iter().flat_map(rotation).collect());
            }
            if let Some(joint) = pinned.moved {
                let translation = |&time: &f32| sampled.at(time).local(joint).translation.to_array();
                replace(Target::Translation(joint), 3, times_kept.iter().flat_map(translation).collect());
            }
        }
        tracks.build(clip.name(), skeleton)
    }

    /// What a pin sets; `None` if it has no effect.
    fn pinned_joints(&self, joint: JointIndex, pin: &Pin) -> Option<PinnedJoints> {
        let skeleton = &self.asset.skeleton;
        let limb = if pin.is_gaze() { None } else { Some(self.limb_for(joint, pin.goal)?) };
        let moved = limb.filter(|&limb| self.is_detached(limb)).map(|_| joint);
        let turned = match limb {
            Some([upper, lower, _]) if moved.is_some() => vec![upper, lower],
            Some(limb) => limb.to_vec(),
            None => vec![joint],
        };
        let is_below = |other: &JointIndex| turned.iter().chain(&moved).any(|&own| is_within(skeleton, *other, own));
        let below = skeleton.joints().filter(is_below).collect();
        Some(PinnedJoints { turned, moved, below })
    }
}

/// What a pin sets of a pose.
struct PinnedJoints {
    /// Joints whose rotation it sets.
    turned: Vec<JointIndex>,
    /// The joint whose translation it sets.
    moved: Option<JointIndex>,
    /// Joints that move along, and these themselves.
    below: Vec<JointIndex>,
}

/// The pinned clip at close times.
struct Sampled<'a> {
    pinning: &'a Pinning<'a>,
    clip: &'a Clip,
    period_secs: f64,
    times: Vec<f32>,
    limits: Limits,
    cursor: SampleCursor,
    pose: Pose,
}

impl<'a> Sampled<'a> {
    fn new(pinning: &'a Pinning<'a>, clip: &'a Clip, period_secs: f64) -> Self {
        let limits = Limits::new(&pinning.asset.skeleton);
        let times = close_times(clip, pinning.pins.values(), period_secs);
        let (cursor, pose) = (SampleCursor::default(), pinning.asset.skeleton.rest().clone());
        Self { pinning, clip, period_secs, times, limits, cursor, pose }
    }

    /// Samples the pose with all pins.
    fn at(&mut self, time_secs: f32) -> &Pose {
        let skeleton = &self.pinning.asset.skeleton;
        self.pose.copy_from(skeleton.rest());
        self.clip.sample(skeleton, time_secs, &mut self.cursor, &mut self.pose);
        // The end is that of the last round, not the start of another.
        let is_end = time_secs >= self.clip.duration_secs() || self.period_secs <= 0.0;
        let pin_secs = if is_end { self.period_secs } else { f64::from(time_secs) % self.period_secs };
        self.pinning.apply(pin_secs, &mut self.pose);
        &self.pose
    }

    /// The times, and more where joints turn so fast that they would be off between two of them.
    fn close_times(&mut self, pinned: &PinnedJoints) -> Vec<f32> {
        let mut close = Vec::with_capacity(self.times.len());
        // Of each interval that is left its end and the number of times it was halved.
        let mut left: Vec<(f32, u32)> = self.times.iter().rev().map(|&time| (time, 0)).collect();
        while let Some((to, halvings)) = left.pop() {
            if let Some(&from) = close.last() {
                let middle: f32 = 0.5 * (from + to);
                let is_inside = from < middle && middle < to;
                // Halfway through an S-curve there is no error.
                let between = [0.25, 0.5, 0.75].map(|part| from + part * (to - from));
                if is_inside && halvings < MAX_HALVINGS && !self.is_close([from, to], &between, BETWEEN_SAMPLES, pinned)
                {
                    left.extend([(to, halvings + 1), (middle, halvings + 1)]);
                    continue;
                }
            }
            close.push(to);
        }
        close
    }

    /// Whether what a pin sets, interpolated between two times, brings all joints below to where they are in between, but for a
    /// share of the limits.
    fn is_close(&mut self, [from, to]: [f32; 2], between: &[f32], share: f64, pinned: &PinnedJoints) -> bool {
        let skeleton = &self.pinning.asset.skeleton;
        let [before, after] = [from, to].map(|at| locals_of(self.at(at)));
        between.iter().all(|&at| {
            let factor = f64::from(at - from) / f64::from(to - from);
            let exact = WorldPose::new(skeleton, locals_of(self.at(at)), DQuat::IDENTITY);
            let mut locals = exact.locals.clone();
            for joint in pinned.turned.iter().map(|joint| joint.get()) {
                locals[joint].rotation = slerp(before[joint].rotation, after[joint].rotation, factor);
            }
            if let Some(joint) = pinned.moved.map(JointIndex::get) {
                locals[joint].translation = before[joint].translation.lerp(after[joint].translation, factor);
            }
            let found = WorldPose::new(skeleton, locals, DQuat::IDENTITY);
            pinned.below.iter().all(|&joint| self.limits.share(&exact, &found, joint) <= share)
        })
    }
}

/// The times of all keys and those at which a pin sets in or ends, with the moment before each, since values may jump there;
/// and more in between.
fn close_times<'a>(clip: &Clip, pins: impl Iterator<Item = &'a Pin>, period_secs: f64) -> Vec<f32> {
    let duration_secs = clip.duration_secs();
    let mut jumps = vec![0.0, duration_secs];
    let rounds = if period_secs > 0.0 { (f64::from(duration_secs) / period_secs).ceil() as usize } else { 1 };
    let edges: Vec<f64> = pins
        .filter_map(|pin| pin.times)
        .flat_map(|PinTimes { start_secs, end_secs, blend_secs }| {
            [start_secs - blend_secs, start_secs, end_secs, end_secs + blend_secs]
        })
        .chain([0.0])
        .filter(|edge| (0.0..=period_secs).contains(edge))
        .collect();
    for round in 0..rounds {
        jumps.extend(edges.iter().map(|edge| (round as f64 * period_secs + edge) as f32));
    }
    for channel in clip.channels().iter().filter(|channel| channel.interpolation == Interpolation::Step) {
        jumps.extend(&clip.timelines()[channel.timeline as usize]);
    }
    let before: Vec<f32> = jumps.iter().map(|time| time.next_down()).collect();
    let after: Vec<f32> = jumps.iter().map(|time| time.next_up()).collect();
    let keys = clip.timelines().iter().map(Vec::as_slice).chain([&jumps[..], &before, &after]);
    let mut times = union(keys);
    times.retain(|&time| (0.0..=duration_secs).contains(&time));
    let mut close = Vec::with_capacity(times.len());
    for pair in times.windows(2) {
        let steps = ((pair[1] - pair[0]) / MAX_STEP_SECS).ceil().clamp(1.0, MAX_STEPS);
        close.extend((0..steps as usize).map(|step| pair[0] + (pair[1] - pair[0]) * (step as f32 / steps)));
    }
    close.extend(times.last());
    close.dedup();
    close
}
