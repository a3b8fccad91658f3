//! Pins baked into a clip.

use gaitway_character::anim::{Clip, JointIndex, Pose, Property};

use super::{Pin, PinTimes, Pinning};
use crate::baker::Baker;

/// Longest time between samples. A limb that is out of reach for a moment bends and straightens between two keys.
const MAX_STEP_SECS: f32 = 1.0 / 60.0;

/// Clips that repeat more often than this are sampled without regard to the times of pins in later rounds.
const MAX_ROUNDS: usize = 10_000;

/// Pins while they are baked, alone or with other changes to the clip.
#[derive(Debug)]
pub struct BakedPins<'a> {
    pinning: &'a Pinning<'a>,
    end_secs: f64,
    period_secs: f64,
}

impl<'a> BakedPins<'a> {
    /// Registers the channels that the pins replace and the times to sample. The clip repeats after `period_secs`, and so do the
    /// times of the pins.
    pub fn new(pinning: &'a Pinning<'a>, period_secs: f64, baker: &mut Baker<'_>) -> Self {
        for (joint, pin) in pinning.in_order() {
            pinning.replace_pinned(joint, pin, baker);
        }
        let end_secs = f64::from(baker.end_secs());
        let edges: Vec<f64> = pinning
            .pins
            .values()
            .filter_map(|pin| pin.times)
            .flat_map(|PinTimes { start_secs, end_secs, blend_secs }| {
                [start_secs - blend_secs, start_secs, end_secs, end_secs + blend_secs]
            })
            .chain([0.0])
            .filter(|edge| (0.0..=period_secs).contains(edge))
            .collect();
        let rounds = if period_secs > 0.0 { ((end_secs / period_secs).ceil() as usize).min(MAX_ROUNDS) } else { 1 };
        let in_round = |round: usize| edges.iter().map(move |edge| (round as f64 * period_secs + edge) as f32);
        // Rounding may put a jump on either side of such a time.
        let around = |time: f32| [time.next_down(), time, time.next_up()];
        baker.sample_at((0..rounds).flat_map(in_round).flat_map(around));
        baker.sample_every(MAX_STEP_SECS);
        Self { pinning, end_secs, period_secs }
    }

    /// Changes the pose that the clip below has at a time.
    pub fn apply(&self, time_secs: f32, pose: &mut Pose) {
        // The end is that of the last round, not the start of another.
        let is_end = f64::from(time_secs) >= self.end_secs || self.period_secs <= 0.0;
        let pin_secs = if is_end { self.period_secs } else { f64::from(time_secs) % self.period_secs };
        self.pinning.apply(pin_secs, pose);
    }
}

impl Pinning<'_> {
    /// Returns a clip with the pins baked in. It repeats after `period_secs`, and so do the times of the pins.
    pub fn bake(&self, clip: &Clip, period_secs: f64) -> Clip {
        let mut baker = Baker::new(&self.asset.skeleton, clip);
        let pins = BakedPins::new(self, period_secs, &mut baker);
        baker.bake(|time_secs, pose| pins.apply(time_secs, pose))
    }

    /// Replaces what a pin sets, if it has any effect.
    fn replace_pinned(&self, joint: JointIndex, pin: &Pin, baker: &mut Baker<'_>) {
        if pin.is_gaze() {
            baker.replace(joint, Property::Rotation);
        } else if let Some(limb) = self.limb_for(joint, pin.goal) {
            let moved = self.is_detached(limb);
            limb[..2].iter().for_each(|&bone| baker.replace(bone, Property::Rotation));
            baker.replace(joint, if moved { Property::Translation } else { Property::Rotation });
        }
    }
}
