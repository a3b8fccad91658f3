//! What the root options do to the hips' path: which axes lose their travel or freeze, and what moves to the root joint.

use gaitway_character::anim::JointIndex;
use glam::DVec3;

use super::{Hips, Transfer};
use crate::map::{ResolvedMap, RootPart};
use crate::math::HORIZONTAL;

/// The root options by axis of the common frame: 1 where something applies, else 0.
#[derive(Debug, Clone, Copy)]
pub struct RootPolicy {
    /// The joint that receives the travel, if it is extracted.
    pub extraction_joint: Option<JointIndex>,
    /// Travel that moves to that joint.
    pub extracted: DVec3,
    /// Travel that is removed.
    pub in_place: DVec3,
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
        Self { extraction_joint, extracted, in_place: axes(RootPart::InPlace), frozen: axes(RootPart::Freeze) }
    }

    /// Travel that the hips lose, extracted or not.
    pub fn stopped(&self) -> DVec3 {
        self.in_place + self.extracted
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
