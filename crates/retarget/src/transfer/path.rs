//! The path of the target's hips: the source's in the common frame, measured from the rest or the feet and scaled by the ratio of
//! the hips' heights above the ground; edited as the root options ask.

use glam::DVec3;

use super::root_motion::RootPolicy;
use super::{Hips, Transfer};
use crate::keys::resample::union;

/// The straight line from the first to the last key of the path.
#[derive(Debug, Clone, Copy)]
pub struct Travel {
    pub first_secs: f32,
    first: DVec3,
    /// Per second.
    pub slope: DVec3,
}

impl Travel {
    pub fn at(&self, time_secs: f32) -> DVec3 {
        self.slope * f64::from(time_secs - self.first_secs)
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
        let travel = Travel { first_secs, first, slope };
        Some(Self { transfer, hips, policy: RootPolicy::new(transfer, hips), times, travel })
    }

    /// The path before the root options apply.
    pub fn unedited(&self, time_secs: f32) -> DVec3 {
        unedited(self.transfer, self.hips, time_secs)
    }

    pub fn at(&self, time_secs: f32) -> DVec3 {
        self.edit(self.unedited(time_secs), time_secs)
    }

    pub fn edit(&self, unedited: DVec3, time_secs: f32) -> DVec3 {
        let RootPolicy { stopped, frozen, .. } = self.policy;
        (unedited - stopped * self.travel.at(time_secs)) * (DVec3::ONE - frozen) + self.travel.first * frozen
    }

    /// The same for a tangent, in units per second.
    pub fn edit_tangent(&self, tangent: DVec3) -> DVec3 {
        let RootPolicy { stopped, frozen, .. } = self.policy;
        (tangent - stopped * self.travel.slope) * (DVec3::ONE - frozen)
    }
}

/// The path before the root options apply.
pub fn unedited(transfer: &Transfer, hips: &Hips, time_secs: f32) -> DVec3 {
    let (joint, source) = (transfer.map.pairs[hips.pair].source, &transfer.alignment.source);
    hips.target_position(transfer.tracks.position(joint, time_secs, source.world_from_model))
}
