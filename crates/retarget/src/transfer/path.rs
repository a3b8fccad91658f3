//! The path of the target's hips: the source's in the common frame, measured from the rest or the feet and scaled by the ratio of
//! the hips' heights above the ground; edited as the root options ask.

use glam::DVec3;

use super::averaged::{averaged, steps};
use super::root_motion::RootPolicy;
use super::{Hips, Transfer};
use crate::keys::resample::union;
use crate::math::HORIZONTAL;

/// A path that strays further from its line than this, as a share of the hips' height, doesn't go straight.
const MAX_SWAY: f64 = 0.25;

/// How the path travels: along the straight line from its first to its last key. A root joint that takes the travel follows the
/// path instead, without its sway, if that isn't straight.
#[derive(Debug, Clone)]
pub struct Travel {
    pub first_secs: f32,
    last_secs: f32,
    first: DVec3,
    /// Of the line, per second.
    pub slope: DVec3,
    /// Times and places of a root joint that doesn't go straight, from where it starts.
    bends: Option<(Vec<f32>, Vec<DVec3>)>,
}

impl Travel {
    /// On the line.
    pub fn line(&self, time_secs: f32) -> DVec3 {
        self.slope * f64::from(time_secs - self.first_secs)
    }

    /// Where a root joint that takes the travel is, from where it starts.
    pub fn root(&self, time_secs: f32) -> DVec3 {
        let Some((times, places)) = &self.bends else { return self.line(time_secs) };
        let to = times.partition_point(|&time| time <= time_secs).clamp(1, times.len() - 1);
        let [start, end] = [times[to - 1], times[to]].map(f64::from);
        let factor = ((f64::from(time_secs) - start) / (end - start)).clamp(0.0, 1.0);
        places[to - 1].lerp(places[to], factor)
    }

    /// Key times of that root joint.
    pub fn root_times(&self) -> Vec<f32> {
        match &self.bends {
            Some((times, _)) => times.clone(),
            None if self.first_secs < self.last_secs => vec![self.first_secs, self.last_secs],
            None => vec![self.first_secs],
        }
    }

    /// Whether a root joint that takes the travel goes along the line.
    pub fn is_straight(&self) -> bool {
        self.bends.is_none()
    }

    /// Lets the root joint follow a path that strays from the line by more than `max_sway` over the ground.
    fn bend(&mut self, max_sway: f64, position: impl Fn(f32) -> DVec3) {
        let times = steps(self.first_secs, self.last_secs);
        let places: Vec<DVec3> = times.iter().map(|&time| (position(time) - self.first) * HORIZONTAL).collect();
        let sway = |(&time, place): (&f32, &DVec3)| place.distance(self.line(time) * HORIZONTAL);
        if times.iter().zip(&places).map(sway).fold(0.0, f64::max) > max_sway {
            let places = averaged(&places);
            self.bends = Some((times, places));
        }
    }
}

/// The path as a function of time, in the common frame and target units.
pub struct HipsPath<'a> {
    transfer: &'a Transfer<'a>,
    hips: &'a Hips,
    pub policy: RootPolicy,
    pub times: Vec<f32>,
    pub travel: Travel,
}

impl<'a> HipsPath<'a> {
    /// None if the source's hips do not move.
    pub fn new(transfer: &'a Transfer<'a>, hips: &'a Hips) -> Option<Self> {
        let times = union(transfer.tracks.path_timelines(transfer.map.pairs[hips.pair].source));
        let (&first_secs, &last_secs) = (times.first()?, times.last()?);
        let first = unedited(transfer, hips, first_secs);
        let secs = f64::from(last_secs - first_secs);
        let slope = if secs > 0.0 { (unedited(transfer, hips, last_secs) - first) / secs } else { DVec3::ZERO };
        let mut travel = Travel { first_secs, last_secs, first, slope, bends: None };
        let policy = RootPolicy::new(transfer, hips);
        if policy.extracted != DVec3::ZERO && secs > 0.0 {
            travel.bend(MAX_SWAY * hips.height, |time| unedited(transfer, hips, time));
        }
        Some(Self { transfer, hips, policy, times, travel })
    }

    /// The path before the root options apply.
    pub fn unedited(&self, time_secs: f32) -> DVec3 {
        unedited(self.transfer, self.hips, time_secs)
    }

    pub fn at(&self, time_secs: f32) -> DVec3 {
        self.edit(self.unedited(time_secs), time_secs)
    }

    pub fn edit(&self, unedited: DVec3, time_secs: f32) -> DVec3 {
        let RootPolicy { in_place, extracted, frozen, .. } = self.policy;
        let gone = in_place * self.travel.line(time_secs) + extracted * self.travel.root(time_secs);
        (unedited - gone) * (DVec3::ONE - frozen) + self.travel.first * frozen
    }

    /// The same for a tangent, in units per second, if no bent travel is extracted.
    pub fn edit_tangent(&self, tangent: DVec3) -> DVec3 {
        let frozen = self.policy.frozen;
        (tangent - self.policy.stopped() * self.travel.slope) * (DVec3::ONE - frozen)
    }
}

/// The path before the root options apply.
pub fn unedited(transfer: &Transfer, hips: &Hips, time_secs: f32) -> DVec3 {
    let (joint, source) = (transfer.map.pairs[hips.pair].source, &transfer.alignment.source);
    hips.target_position(transfer.tracks.position(joint, time_secs, source.world_from_model))
}
