//! Which way the body faces along its path, judged by shape: feet point forward, and knees bend forward. Names and slots of left
//! and right don't count, so a body that walks backwards shows even if both files are wrong about the sides.

use gaitway_character::anim::JointIndex;
use glam::{DQuat, DVec2, DVec3};

use crate::feet::{Sole, Soles};
use crate::map::Pair;
use crate::pose::WorldPose;
use crate::transfer::{LEG_CHAINS, Transfer};

/// Shares of a leg's length: how far a foot reaches ahead of its ankle, or a knee out of line, to show a direction.
const MIN_FOOT: f64 = 0.04;
const MIN_KNEE: f64 = 0.08;

/// A body travels if its hips go this share of a leg's length from so many moments before to as many after.
const WINDOW: usize = 4;
const MIN_TRAVEL: f64 = 0.3;

/// The joints of a leg from the thigh to the foot, and the foot's sole.
type Leg = ([JointIndex; 3], Option<Sole>);

/// The legs of the source or the target.
pub struct Legs {
    legs: Vec<Leg>,
    hips: Option<JointIndex>,
    /// Mean length of a leg at rest.
    length: f64,
}

impl Legs {
    pub fn of_source(transfer: &Transfer) -> Self {
        let rest = &transfer.alignment.source;
        Self::new(transfer, rest, Soles::of(transfer, transfer.source, rest, |pair| pair.source), |pair| pair.source)
    }

    pub fn of_target(transfer: &Transfer, soles: Soles) -> Self {
        Self::new(transfer, &transfer.alignment.target, soles, |pair| pair.target)
    }

    fn new(transfer: &Transfer, rest: &WorldPose, soles: Soles, joint: fn(&Pair) -> JointIndex) -> Self {
        let mut legs = Vec::new();
        let mut length = 0.0;
        for (slots, sole) in LEG_CHAINS.into_iter().zip(soles.feet) {
            let [Some(upper), Some(lower), Some(foot)] = slots.map(|slot| transfer.pair(slot).map(joint)) else {
                continue;
            };
            let at = |joint| rest.position(joint);
            length += at(upper).distance(at(lower)) + at(lower).distance(at(foot));
            legs.push(([upper, lower, foot], sole));
        }
        let length = length / (legs.len().max(1) as f64);
        Self { legs, hips: transfer.hips_pair().map(joint), length }
    }

    /// The joints that [`Heading::new`] needs in a pose.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + '_ {
        let of_legs = self
            .legs
            .iter()
            .flat_map(|(joints, sole)| joints.iter().copied().chain(sole.iter().flat_map(Sole::joints)));
        of_legs.chain(self.hips)
    }

    /// The horizontal direction that the feet or else the knees point in, if they point anywhere.
    fn forward(&self, pose: &WorldPose) -> Option<DVec2> {
        let points = |min: f64, direction: &dyn Fn(&Leg) -> Option<DVec3>| {
            let mean = self.legs.iter().filter_map(direction).sum::<DVec3>() / self.legs.len().max(1) as f64;
            let level = DVec2::new(mean.x, mean.z);
            // Feet that hang down point anywhere.
            let is_level = level.length() > mean.y.abs();
            (is_level && level.length() > min * self.length).then(|| level.normalize())
        };
        let foot = |([_, _, foot], sole): &Leg| Some(sole.as_ref()?.ahead(pose, *foot));
        let knee = |([upper, lower, foot], _): &Leg| {
            let [hip, knee, ankle] = [upper, lower, foot].map(|joint| pose.position(*joint));
            let line = (ankle - hip).try_normalize()?;
            Some(knee - hip - line * line.dot(knee - hip))
        };
        points(MIN_FOOT, &foot).or_else(|| points(MIN_KNEE, &knee))
    }
}

/// Where a body faces and where its hips are, at one moment.
#[derive(Clone, Copy)]
pub struct Heading {
    forward: Option<DVec2>,
    hips: DVec2,
}

impl Heading {
    /// `hips` is where the hips are with all travel.
    pub fn new(legs: &Legs, pose: &WorldPose, hips: DVec3) -> Self {
        Self { forward: legs.forward(pose), hips: DVec2::new(hips.x, hips.z) }
    }

    /// Turns the body about the vertical; the hips stay.
    pub fn turned(self, turn: DQuat) -> Self {
        let turned = |forward: DVec2| {
            let forward = turn * DVec3::new(forward.x, 0.0, forward.y);
            DVec2::new(forward.x, forward.z)
        };
        Self { forward: self.forward.map(turned), ..self }
    }
}

/// Returns the angle in degrees between how the source and the target face along their paths, on the whole, from moments of each.
/// Where they stand, it is the angle between the directions they face in.
pub fn facing_path_error([source, target]: [&Legs; 2], moments: &[[Heading; 2]]) -> Option<f64> {
    let mut sum = DVec2::ZERO;
    let mut count = 0;
    for (at, now) in moments.iter().enumerate() {
        let [Some(source_forward), Some(target_forward)] = now.map(|heading| heading.forward) else { continue };
        let [from, to] = [at.saturating_sub(WINDOW), (at + WINDOW).min(moments.len() - 1)].map(|at| &moments[at]);
        let [source_path, target_path] = [0, 1].map(|side| to[side].hips - from[side].hips);
        let travels =
            source_path.length() > MIN_TRAVEL * source.length && target_path.length() > MIN_TRAVEL * target.length;
        let angle = source_forward.angle_to(target_forward);
        let of_paths = if travels { source_path.angle_to(target_path) } else { 0.0 };
        sum += DVec2::from_angle(angle - of_paths);
        count += 1;
    }
    (count > 0).then(|| sum.to_angle().abs().to_degrees())
}
