//! What the root options do to the hips' path: which axes lose their travel or freeze, and what moves to the root joint.

use glam::{DQuat, DVec3};

use super::heading::Yaw;
use super::path::{HipsPath, Travel};
use super::{Hips, Transfer, rotation_laws};
use crate::anim::{Interpolation, JointIndex, Keys};
use crate::retarget::keys::channel::NewChannel;
use crate::retarget::map::{ResolvedMap, RootPart};
use crate::retarget::math::{HORIZONTAL, unit};
use crate::retarget::pose::WorldPose;

/// The root options by axis of the common frame: 1 where something applies, else 0.
#[derive(Debug, Clone, Copy)]
pub struct RootPolicy {
    /// The joint that receives the travel, if it is extracted.
    pub extraction_joint: Option<JointIndex>,
    /// Travel that moves to that joint.
    pub extracted: DVec3,
    /// Travel that the hips lose, extracted or not.
    pub stopped: DVec3,
    pub frozen: DVec3,
}

impl RootPolicy {
    pub fn new(transfer: &Transfer, hips: &Hips) -> Self {
        let options = &transfer.map.root;
        let axes = |wanted: RootPart| {
            let on = |part: RootPart| f64::from(u8::from(part == wanted));
            DVec3::new(on(options.horizontal), on(options.vertical), on(options.horizontal))
        };
        let extraction_joint = extraction_joint(transfer, hips).filter(|_| options.extract);
        let extracted = match extraction_joint {
            Some(_) => axes(RootPart::Keep) * HORIZONTAL,
            None => DVec3::ZERO,
        };
        Self {
            extraction_joint,
            extracted,
            stopped: axes(RootPart::InPlace) + extracted,
            frozen: axes(RootPart::Freeze),
        }
    }
}

/// The parent of the hips, if it follows no source itself.
pub fn extraction_joint(transfer: &Transfer, hips: &Hips) -> Option<JointIndex> {
    let parent = transfer.target_skeleton.parent(transfer.map.pairs[hips.pair].target)?;
    transfer.map.source_of(parent).is_none().then_some(parent)
}

/// Whether the options leave the path alone, so that translations may be copied.
pub fn keeps_everything(map: &ResolvedMap) -> bool {
    [map.root.horizontal, map.root.vertical, map.root.yaw] == [RootPart::Keep; 3] && !map.root.extract
}

/// Channels of the root joint: linear travel, and its turning.
pub fn root_joint_channels(
    transfer: &Transfer,
    root: JointIndex,
    path: &HipsPath,
    turn: Option<&Yaw>,
) -> Vec<NewChannel> {
    let rest = &transfer.alignment.target;
    let local = rest.locals[root.get()];
    let world_from_parent = rest.parent_frame(transfer.target_skeleton, root);
    let parent_from_world = world_from_parent.inverse();
    let position = |time: f32| {
        let step = parent_from_world.transform_vector3(path.policy.extracted * path.travel.at(time));
        (local.translation + step).as_vec3()
    };
    let (first, last) = (path.times[0], path.times[path.times.len() - 1]);
    let times = if first < last { vec![first, last] } else { vec![first] };
    let positions = times.iter().map(|&time| position(time)).collect();
    let mut channels = vec![NewChannel {
        joint: root,
        interpolation: Interpolation::Linear,
        times,
        keys: Keys::Translation(positions),
        resampled: false,
    }];
    if let Some(turn) = turn {
        let parent = crate::anim::nearest_rotation(&world_from_parent.matrix3).map_or(DQuat::IDENTITY, unit);
        let rotation =
            |&radians: &f64| (parent.conjugate() * DQuat::from_rotation_y(radians) * parent * local.rotation).as_quat();
        let rotations = turn.radians.iter().map(rotation).collect();
        channels.push(NewChannel::resampled(root, turn.times.clone(), Keys::Rotation(rotations)));
    }
    channels
}

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
    let Travel { first_secs, slope, .. } = path.travel;
    let removed = |time: f32| {
        let extracted = path.policy.extracted * slope * f64::from(time - first_secs);
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
