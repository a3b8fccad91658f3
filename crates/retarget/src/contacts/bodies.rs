//! Source and target side by side: the same parts, which of them may touch, and where they do.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Humanoid, Slot};
use glam::{DMat3, DVec3};

use super::body::{Body, BodyMotion, Frames, POINTS};
use super::parts::{Part, Region};
use super::shape::Side;
use super::solid::Place;
use crate::pose::PartialPose;
use crate::transfer::Transfer;

/// Joints of the arms, as in [`Region::arm`].
const ARMS: [[Slot; 3]; 2] = [
    [Slot::LeftUpperArm, Slot::LeftLowerArm, Slot::LeftHand],
    [Slot::RightUpperArm, Slot::RightLowerArm, Slot::RightHand],
];

/// A part of an arm, or a shin with its knee.
#[derive(Debug)]
pub struct GroundPart {
    pub part: usize,
    pub is_knee: bool,
    /// Whether it is a hand or knee: these rest on the ground.
    pub rests: bool,
}

/// A limb's part and another that it may touch: arms touch everything but themselves, legs only each other.
#[derive(Debug)]
pub struct PartPair {
    pub limb: usize,
    pub other: usize,
    /// Whether the limb's part is a hand: what hands touch is kept.
    pub is_hand: bool,
    /// How deep the limb's points are in the other part on the target at rest.
    pub at_rest: [f64; POINTS],
}

/// A point of a limb near or inside another part.
#[derive(Debug, Clone, Copy)]
pub struct Meeting {
    /// Index into [`Bodies::pairs`].
    pub pair: usize,
    pub point: usize,
    /// From the point to the other part's surface; negative inside.
    pub distance: f64,
    /// The nearest place on the other part.
    pub place: Place,
}

/// Source and target with the same parts.
#[derive(Debug)]
pub struct Bodies {
    pub source: Body,
    pub target: Body,
    /// By part.
    pub regions: Vec<Region>,
    /// How far each part moves if the end of its limb does, at its beginning and end.
    levers: Vec<[f64; 2]>,
    /// Number of points on each body's limbs.
    pub limb_points: u32,
    pub pairs: Vec<PartPair>,
    /// Parts with a place on the ground.
    pub ground_parts: Vec<GroundPart>,
    /// Shoulder, elbow and wrist of the target's arms, as in [`Region::arm`]. The wrist needn't be mapped.
    pub arms: [Option<[JointIndex; 3]>; 2],
}

impl Bodies {
    /// Returns `None` if no limb is mapped. `slots` are those of source and target.
    pub fn new(transfer: &Transfer, slots: [&Humanoid; 2]) -> Option<Self> {
        let alignment = transfer.alignment;
        let parts = Part::mapped(transfer);
        // The direction of angle 0 has to be the same for both bodies.
        let source_axis = |part: &Part| part.axis(&parts, &alignment.source, |pair| pair.source).0;
        let fronts: Vec<DVec3> =
            parts.iter().map(|part| if source_axis(part).z.abs() > 0.8 { DVec3::Y } else { DVec3::Z }).collect();
        let source = Side {
            asset: transfer.source,
            skeleton: transfer.tracks.skeleton,
            slots: slots[0],
            rest: &alignment.source,
            skinned: &alignment.source,
            joint: |pair| pair.source,
        };
        let target = Side {
            asset: transfer.target,
            skeleton: transfer.target_skeleton,
            slots: slots[1],
            rest: &alignment.target,
            skinned: &alignment.unaligned_target,
            joint: |pair| pair.target,
        };
        let [source, target] = [source, target].map(|side| side.body(transfer, &parts, &fronts));
        let regions: Vec<Region> = parts.iter().map(|part| part.kind.region).collect();
        // Upper arms turn about their beginning.
        let levers = parts.iter().map(|part| part.kind.levers.unwrap_or([0.0, 0.5])).collect();
        let mut limb_points = 0;
        let mut pairs = Vec::new();
        let mut ground_parts = Vec::new();
        for (limb, part) in parts.iter().enumerate().filter(|(_, part)| part.kind.levers.is_some()) {
            limb_points += POINTS as u32;
            let is_knee = part.is_shin();
            if is_knee || !part.kind.region.is_leg() {
                ground_parts.push(GroundPart { part: limb, is_knee, rests: is_knee || part.is_hand() });
            }
            for (other, &region) in regions.iter().enumerate() {
                let own = part.kind.region;
                if own != region && (!own.is_leg() || region.is_leg()) {
                    pairs.push(PartPair { limb, other, is_hand: part.is_hand(), at_rest: [0.0; POINTS] });
                }
            }
        }
        let target_joint = |slot: Slot| transfer.pair(slot).map(|pair| pair.target);
        let arms = ARMS.map(|[shoulder, elbow, wrist]| {
            let wrist = target_joint(wrist).or_else(|| slots[1].joint(wrist))?;
            Some([target_joint(shoulder)?, target_joint(elbow)?, wrist])
        });
        let mut bodies = Self { source, target, regions, levers, limb_points, pairs, ground_parts, arms };
        let rest = bodies.target.frames(&alignment.unaligned_target);
        for meeting in bodies.meetings(&bodies.target, &rest, 0.0) {
            bodies.pairs[meeting.pair].at_rest[meeting.point] = -meeting.distance;
        }
        (!bodies.pairs.is_empty()).then_some(bodies)
    }

    /// Where the source is at each time.
    pub fn source_motion(&self, transfer: &Transfer, times: &[f32]) -> BodyMotion {
        let world_from_model = transfer.alignment.source.world_from_model;
        let mut pose = PartialPose::new(transfer.tracks.skeleton, world_from_model, self.source.moving_joints());
        let mut motion = BodyMotion::default();
        times.iter().for_each(|&time| motion.push(&self.source, pose.update(transfer.tracks.locals_at(time))));
        motion
    }

    /// How far a place on a part moves if the end of its limb does, as a share.
    pub fn lever(&self, part: usize, share: f64) -> f64 {
        let [from, to] = self.levers[part];
        from + share * (to - from)
    }

    /// Finds the points of limbs that are inside other parts of the same body or at most `reach` away, pair by pair.
    pub fn meetings(&self, body: &Body, frames: &Frames, reach: f64) -> Vec<Meeting> {
        let spheres: Vec<(DVec3, f64)> = body
            .solids
            .iter()
            .zip(frames)
            .map(|(solid, &(at, turn))| (at + turn * solid.center, solid.bound))
            .collect();
        let mut meetings = Vec::new();
        let mut limb = (usize::MAX, [DVec3::ZERO; POINTS]);
        for (index, pair) in self.pairs.iter().enumerate() {
            let ((center, bound), (other_center, other_bound)) = (spheres[pair.limb], spheres[pair.other]);
            if center.distance(other_center) > bound + other_bound + reach {
                continue;
            }
            if limb.0 != pair.limb {
                limb = (pair.limb, std::array::from_fn(|point| body.point(pair.limb, point, frames)));
            }
            let (origin, turn) = frames[pair.other];
            let other_from_common = DMat3::from_quat(turn.conjugate());
            for (point, &position) in limb.1.iter().enumerate() {
                if position.distance_squared(other_center) > (other_bound + reach).powi(2) {
                    continue;
                }
                let position = other_from_common * (position - origin);
                if let Some((distance, place)) = body.solids[pair.other].locate(position, reach) {
                    meetings.push(Meeting { pair: index, point, distance, place });
                }
            }
        }
        meetings
    }
}
