//! Planted feet: while the source's foot is in contact, the target's stays in one place on the ground. First the whole body is
//! put on the ground (`height`), and feet are moved apart (`width`) and turned level (`level`). From there the legs reach, and
//! the hips come down further when a leg would have to be longer than it is. A leg that still doesn't reach, or would have to
//! turn too fast, is planted only partly.

use std::fmt;
use std::ops::Range;

use gaitway_character::anim::{Clip, JointIndex};
use glam::{DQuat, DVec3};
use serde::Serialize;

use super::body::{body_shifts, means};
use super::contacts::{Ground, SourceContacts, contacts_of, ranges};
use super::height::{floats, hover, lower};
use super::leg::{Leg, drop_to_reach, solve_leg};
use super::level::level_feet;
use super::plan::{EASE_SECS, LegContacts, Plan, Stage, plan};
use super::sole::Soles;
use super::width::spreads;
use crate::keys::channel::NewChannel;
use crate::limit::limit_turns;
use crate::pose::{Scratch, WorldPose, moved};
use crate::times::{corrected_times, near};
use crate::transfer::{Transfer, removed_travel};
use crate::two_bones::limb_rotations;

/// The hips come down by at most this share of their height for a leg to reach.
const MAX_DROP: f64 = 0.1;

/// How far planting may turn a thigh or shin, and how fast: at 60 frames per second, by about 4° per frame.
const MAX_TURN_DEGREES: f64 = 30.0;
const MAX_TURN_DEGREES_PER_SEC: f64 = 250.0;

/// How far a foot may end from where it begins, as a share of the hips' height, in a clip that repeats in place.
const MAX_GAP: f64 = 0.02;

/// How much of a repeated clip's other end is taken into account at each end.
const REPEATED_SECS: f32 = 1.0;

/// What planting did.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Planting {
    /// Number of contacts in which a foot is held.
    pub contacts: usize,
    /// Speed of the ground under a figure that walks or runs in place; `None` if the ground stands still.
    pub ground_metres_per_sec: Option<f64>,
    /// By how much the body is lowered over the whole clip; negative if it is raised.
    pub lowered_metres: f64,
}

impl fmt::Display for Planting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.contacts, self.ground_metres_per_sec) {
            (0, _) => write!(f, "no contacts found")?,
            (1, _) => write!(f, "1 contact held")?,
            (contacts, None) => write!(f, "{contacts} contacts held")?,
            (contacts, Some(speed)) => {
                write!(f, "{contacts} contacts held, in place on ground that moves at {speed:.2} m/s")?;
            }
        }
        match self.lowered_metres {
            metres if metres >= 0.0005 => write!(f, "; body lowered by {metres:.3} m"),
            metres if metres <= -0.0005 => write!(f, "; body raised by {:.3} m", -metres),
            _ => Ok(()),
        }
    }
}

/// Returns all channels of the clip with planted feet; `None` if no leg is mapped or the clip is too long. `resampled` lists the
/// joints whose keys in `clip` are not the source's own.
pub fn planted_channels(
    transfer: &Transfer,
    clip: &Clip,
    resampled: &[JointIndex],
) -> Option<(Vec<NewChannel>, Planting)> {
    let times = corrected_times(transfer.tracks.clip, transfer.target_skeleton.len())?;
    let mut scratch = Scratch::default();
    let mut poses: Vec<WorldPose> = times.iter().map(|&time| transfer.target_pose(clip, time, &mut scratch)).collect();
    let soles = Soles::new(transfer);
    let (mut legs, source_ground) = legs_in_contact(transfer, &soles, &times);
    let lowered_metres = hover(transfer, &legs, &poses, soles.ground)?;
    lower(transfer, &legs, &mut poses, |_| lowered_metres);
    let height = transfer.hips.map_or_else(|| leg_length(transfer, &legs), |hips| hips.height);
    let rest = &transfer.alignment.unaligned_target;
    let floats = floats(&times, &legs, &poses, soles.ground, height);
    lower(transfer, &legs, &mut poses, |at| floats[at]);
    if let [left, right] = &mut legs[..] {
        left.spread = spreads(transfer, &times, &poses, height);
        right.spread = left.spread.iter().map(|spread| -spread).collect();
    }
    level_feet(&times, transfer.target_skeleton, rest, &legs, &mut poses, [soles.ground, height]);
    let contacts = legs.iter().map(|leg| ranges(&leg.touching).len()).sum();
    let travel = ground_travel(transfer, &times, &source_ground);
    let mut samples = Samples { times, poses, travel };
    let own = 0..samples.times.len();
    let own = if is_cycle(&legs, &samples, height) { samples.repeat(&mut legs) } else { own };
    let Samples { times, poses, travel } = &samples;
    let is_moving = source_ground.speed > 0.0;
    let stage = Stage { times, poses, ground: soles.ground, travel, is_moving, height };
    let plans: Vec<Plan> = legs.iter().map(|leg| plan(stage, leg, &ranges(&leg.touching))).collect();
    let hips = transfer.hips_carrier();
    let shifts = if hips.is_some() { body_shifts(times, &plans) } else { vec![DVec3::ZERO; times.len()] };
    let drops = drops(stage, &plans, &shifts);
    let rotations = leg_rotations(transfer, stage, &plans, &shifts, &drops, own.clone());
    let moves: Vec<DVec3> = shifts.iter().zip(&drops).map(|(shift, drop)| shift - DVec3::Y * drop).collect();
    let hips = hips.filter(|_| {
        lowered_metres != 0.0 || floats.iter().any(|&by| by != 0.0) || moves.iter().any(|&by| by != DVec3::ZERO)
    });
    let translation =
        hips.map(|hips| (hips, moved(transfer.target_skeleton, hips, &poses[own.clone()], &moves[own.clone()])));
    let channels = NewChannel::corrected(clip, resampled, &times[own], translation, rotations);
    let speed = transfer.scale() * source_ground.speed;
    Some((channels, Planting { contacts, ground_metres_per_sec: is_moving.then_some(speed), lowered_metres }))
}

/// The clip at the sampled times.
struct Samples {
    times: Vec<f32>,
    poses: Vec<WorldPose>,
    travel: Vec<DVec3>,
}

impl Samples {
    /// Puts the clip's end before it and its beginning after it, so that both ends are planted alike. Returns where the clip
    /// itself is then.
    fn repeat(&mut self, legs: &mut [LegContacts]) -> Range<usize> {
        let Self { times, poses, travel } = self;
        let last = times.len() - 1;
        let secs = times[last] - times[0];
        let step = travel[last] - travel[0];
        let pad = times[1..last].partition_point(|&time| time - times[0] <= REPEATED_SECS);
        let (before, after) = (last - pad..last, 1..pad + 1);
        *times = repeated(times, &before, &after, |time, rounds| time + f32::from(rounds) * secs);
        *travel = repeated(travel, &before, &after, |travel, rounds| *travel + f64::from(rounds) * step);
        *poses = repeated(poses, &before, &after, |pose, _| pose.clone());
        for leg in legs {
            // The same moment, whose speed was seen from one side each.
            leg.touching[0] |= leg.touching[last];
            leg.touching[last] = leg.touching[0];
            leg.touching = repeated(&leg.touching, &before, &after, |touching, _| *touching);
            leg.spread = repeated(&leg.spread, &before, &after, |spread, _| *spread);
        }
        pad..pad + last + 1
    }
}

/// The values with a part of them before and a part after; `round` is −1, 0 or 1 for the three.
fn repeated<T>(values: &[T], before: &Range<usize>, after: &Range<usize>, of_round: impl Fn(&T, i8) -> T) -> Vec<T> {
    let rounds = [(&values[before.clone()], -1), (values, 0), (&values[after.clone()], 1)];
    rounds
        .into_iter()
        .flat_map(|(values, round)| values.iter().map(move |value| (value, round)))
        .map(|(value, round)| of_round(value, round))
        .collect()
}

/// Whether the clip ends as it begins, in the same place.
fn is_cycle(legs: &[LegContacts], samples: &Samples, height: f64) -> bool {
    let [first, .., last] = &samples.poses[..] else { return false };
    let is_closed = |joint: JointIndex| first.position(joint).distance(last.position(joint)) < MAX_GAP * height;
    samples.poses.len() > 2
        && legs.iter().all(|LegContacts { leg, .. }| [leg.hip, leg.ankle, leg.toes].into_iter().all(is_closed))
}

/// Length of the first leg at rest, in place of the hips' height.
fn leg_length(transfer: &Transfer, legs: &[LegContacts]) -> f64 {
    let rest = &transfer.alignment.target;
    let length = |LegContacts { leg, .. }: &LegContacts| rest.position(leg.hip).distance(rest.position(leg.ankle));
    legs.first().map_or(0.0, length).max(1e-9)
}

/// Legs of which hip, knee and ankle are mapped, and how the ground moves below the source.
fn legs_in_contact(transfer: &Transfer, soles: &Soles, times: &[f32]) -> (Vec<LegContacts>, Ground) {
    let legs = Leg::mapped(transfer).into_iter().zip(&soles.feet);
    let legs = legs.filter_map(|(leg, sole)| Some((leg?, sole.clone()?)));
    let (legs, feet): (Vec<_>, Vec<_>) = legs.map(|((leg, toes), sole)| ((leg, sole), toes)).unzip();
    let SourceContacts { touching, ground } = contacts_of(transfer, &feet, times);
    let legs = legs.into_iter().zip(touching);
    let legs =
        legs.map(|((leg, sole), touching)| LegContacts { leg, sole, touching, spread: vec![DVec3::ZERO; times.len()] });
    (legs.collect(), ground)
}

/// How far the ground has moved below the target at each time: it does below a source in place, and where travel was removed.
fn ground_travel(transfer: &Transfer, times: &[f32], source: &Ground) -> Vec<DVec3> {
    let removed = removed_travel(transfer, times);
    let scale = transfer.scale();
    source.travel.iter().enumerate().map(|(at, &travel)| scale * travel - removed.horizontal(at)).collect()
}

/// How far the hips come down at each time for all legs to reach, smooth over time.
fn drops(stage: Stage, plans: &[Plan], shifts: &[DVec3]) -> Vec<f64> {
    let Stage { times, poses, height, .. } = stage;
    let needed = |(at, pose): (usize, &WorldPose)| {
        let drops = plans.iter().map(|plan| drop_to_reach(&plan.leg, pose, plan.moves[at].after(shifts[at])));
        drops.fold(0.0, f64::max).min(MAX_DROP * height)
    };
    let needed: Vec<f64> = poses.iter().enumerate().map(needed).collect();
    // The mean of the neighbourhood's maxima is never less than what is needed.
    let max = |at: usize| needed[near(times, at, EASE_SECS)].iter().copied().fold(0.0, f64::max);
    let max: Vec<f64> = (0..times.len()).map(max).collect();
    means(times, &max, EASE_SECS)
}

/// Local rotations of the legs' joints at each time.
fn leg_rotations(
    transfer: &Transfer,
    stage: Stage,
    plans: &[Plan],
    shifts: &[DVec3],
    drops: &[f64],
    own: Range<usize>,
) -> Vec<(JointIndex, Vec<DQuat>)> {
    let [max_turn, max_rate] = [MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC].map(f64::to_radians);
    let mut rotations: Vec<(JointIndex, Vec<DQuat>)> = Vec::new();
    for Plan { leg, moves } in plans {
        let moves = moves.iter().zip(shifts).map(|(foot, shift)| foot.after(*shift));
        let steps = stage.poses.iter().zip(moves).zip(drops);
        let solved = steps.map(|((pose, by), &drop)| solve_leg(leg, pose, by, drop));
        let (mut thighs, mut shins): (Vec<DQuat>, Vec<DQuat>) = solved.map(|turns| (turns.thigh, turns.shin)).unzip();
        limit_turns(stage.times, &mut thighs, max_turn, max_rate);
        limit_turns(stage.times, &mut shins, max_turn, max_rate);
        let joints = [leg.hip, leg.knee, leg.ankle];
        let turns = [&thighs[own.clone()], &shins[own.clone()]];
        rotations.extend(limb_rotations(transfer.target_skeleton, joints, &stage.poses[own.clone()], turns));
    }
    rotations
}
