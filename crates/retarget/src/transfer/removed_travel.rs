//! The travel that a retargeted clip lacks because the root options removed it.

use gaitway_character::anim::JointIndex;
use glam::{DQuat, DVec3};

use super::Transfer;
use super::heading::rotation_laws;
use super::path::HipsPath;
use super::yaw::Yaw;
use crate::math::HORIZONTAL;
use crate::pose::WorldPose;

/// Travel of the source that the retargeted clip lacks, in target units and the common frame.
#[derive(Debug, Clone, Default)]
pub struct RemovedTravel {
    /// One entry for each time asked for; empty if nothing travels.
    horizontal: Vec<DVec3>,
    yaw: Option<Yaw>,
}

impl RemovedTravel {
    pub fn horizontal(&self, index: usize) -> DVec3 {
        self.horizontal.get(index).copied().unwrap_or(DVec3::ZERO)
    }

    /// The turning that was removed.
    pub fn turn(&self, time_secs: f32) -> DQuat {
        DQuat::from_rotation_y(self.yaw.as_ref().map_or(0.0, |yaw| yaw.at(time_secs)))
    }

    /// Where a target joint would be if no travel had been removed, given the inverse of [`Self::turn`].
    pub fn restored(
        &self,
        transfer: &Transfer,
        target: &WorldPose,
        joint: JointIndex,
        index: usize,
        turn_back: DQuat,
    ) -> DVec3 {
        let position = target.position(joint);
        let hips = transfer.hips_pair().map(|pair| target.position(pair.target));
        let turned = hips.map_or(position, |hips| hips + turn_back * (position - hips));
        turned + self.horizontal(index)
    }
}

pub fn removed_travel(transfer: &Transfer, times: &[f32]) -> RemovedTravel {
    let Some(hips) = transfer.hips else { return RemovedTravel::default() };
    let Some(path) = HipsPath::new(transfer, hips) else { return RemovedTravel::default() };
    let removed = |time: f32| {
        let extracted = path.policy.extracted * path.travel.root(time);
        (path.unedited(time) - path.at(time) - extracted) * HORIZONTAL
    };
    let yaw = match path.policy.extraction_joint {
        Some(_) => None,
        None => {
            let (laws, _) = rotation_laws(transfer);
            laws[hips.top_pair(transfer.map, transfer.target_skeleton)].yaw.clone()
        }
    };
    RemovedTravel { horizontal: times.iter().map(|&time| removed(time)).collect(), yaw }
}
