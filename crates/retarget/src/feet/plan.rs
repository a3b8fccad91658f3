//! Where feet go while they are planted: fixed to the ground in contact, and gradually there and away between contacts.

use std::ops::Range;

use glam::DVec3;

use super::leg::Leg;
use super::sole::Sole;
use crate::math::{HORIZONTAL, smooth};
use crate::pose::WorldPose;

/// Transition into and out of a contact.
pub const EASE_SECS: f64 = 0.12;

/// Shares of the hips' height: a foot in contact that is less off the ground than the first is put on it, and one that is more
/// than the second stands on something else.
const GROUND_OFFSET: [f64; 2] = [0.12, 0.2];

/// A foot that goes further than this share of the hips' height during one contact is dragged along instead of held.
const MAX_HOLD: f64 = 0.3;

/// The same for a clip in place, where feet rarely move at a constant speed.
const MAX_HOLD_IN_PLACE: f64 = 0.1;

/// A foot that would be deeper in the ground than this share of the hips' height is not lifted all the way.
const MAX_LIFT: f64 = 0.2;

/// A leg, and whether the source's foot is in contact at each time.
#[derive(Debug)]
pub struct LegContacts {
    pub leg: Leg,
    pub sole: Sole,
    pub touching: Vec<bool>,
    /// Sideways offset of the foot at each time, in contact or not.
    pub spread: Vec<DVec3>,
}

/// What feet are planted on, and how the clip moves over it.
#[derive(Debug, Clone, Copy)]
pub struct Stage<'a> {
    pub times: &'a [f32],
    /// Unplanted, as high as they will be.
    pub poses: &'a [WorldPose],
    /// Height of the ground.
    pub ground: f64,
    /// How far the ground has moved at each time.
    pub travel: &'a [DVec3],
    /// Whether it moves below a figure in place.
    pub is_moving: bool,
    /// Of the hips at rest.
    pub height: f64,
}

/// How far a leg's foot is moved at each time.
#[derive(Debug)]
pub struct Plan {
    pub leg: Leg,
    pub moves: Vec<FootMove>,
}

/// Where a foot should go while the body stays where it is.
#[derive(Debug, Clone, Copy, Default)]
pub struct FootMove {
    pub by: DVec3,
    /// How firmly it is held there: 1 in contact, 0 where it goes with the body.
    pub hold: f64,
    /// Minimum of `by.y`, which keeps the sole out of the ground.
    pub lift: f64,
}

impl FootMove {
    /// How far the leg must move the foot once the body has moved by `shift`.
    pub fn after(self, shift: DVec3) -> DVec3 {
        let by = self.by - self.hold * shift;
        DVec3 { y: by.y.max(self.lift - shift.y), ..by }
    }
}

/// Moves a foot so that, during each contact, its toes stay in one place on the ground.
pub fn plan(stage: Stage, leg: &LegContacts, contacts: &[Range<usize>]) -> Plan {
    let mut moves = vec![FootMove::default(); stage.times.len()];
    for (index, contact) in contacts.iter().enumerate() {
        let offsets = contact_offsets(stage, leg, contact.clone());
        for (at, by) in contact.clone().zip(offsets) {
            moves[at] = FootMove { by, hold: 1.0, lift: 0.0 };
        }
        let after = contacts.get(index + 1).map_or(moves.len(), |next| next.start);
        let before = index.checked_sub(1).map_or(0, |before| contacts[before].end);
        ease(stage.times, &mut moves, contact.start, before..contact.start);
        ease(stage.times, &mut moves, contact.end - 1, contact.end..after);
    }
    for (at, (foot, pose)) in moves.iter_mut().zip(stage.poses).enumerate() {
        let depth = stage.ground - leg.sole.lowest(pose);
        foot.lift = depth.min(MAX_LIFT * stage.height);
        foot.by += leg.spread[at];
    }
    Plan { leg: leg.leg, moves }
}

/// Fades the move at one end of a contact out over the gap beside it. A gap shorter than one transition is crossed in a single
/// blend: the weights from both sides add up to 1.
fn ease(times: &[f32], moves: &mut [FootMove], end: usize, gap: Range<usize>) {
    let secs = |at: usize| (f64::from(times[at]) - f64::from(times[end])).abs();
    let across = if gap.start > end { gap.end } else { gap.start.wrapping_sub(1) };
    let ease_secs = if across < times.len() { secs(across).min(EASE_SECS) } else { EASE_SECS };
    let by = moves[end].by;
    for at in gap {
        let share = smooth(1.0 - secs(at) / ease_secs.max(1e-9));
        moves[at].by += by * share;
        moves[at].hold += share;
    }
}

/// How far the foot is moved at each time of a contact.
fn contact_offsets(stage: Stage, leg: &LegContacts, contact: Range<usize>) -> Vec<DVec3> {
    let toes = |at: usize| (stage.poses[at].position(leg.leg.toes) + leg.spread[at] - stage.travel[at]) * HORIZONTAL;
    let toes: Vec<DVec3> = contact.clone().map(toes).collect();
    let heights: Vec<f64> = stage.poses[contact].iter().map(|pose| leg.sole.lowest(pose) - stage.ground).collect();
    let height = heights.iter().sum::<f64>() / heights.len() as f64;
    let [near, far] = GROUND_OFFSET.map(|share| share * stage.height);
    let support = height * smooth((height.abs() - near) / (far - near));
    let max_hold = if stage.is_moving { MAX_HOLD_IN_PLACE } else { MAX_HOLD };
    let places = places(&toes, max_hold * stage.height);
    let offset = |((place, toes), low): ((DVec3, &DVec3), &f64)| place - *toes + DVec3::Y * (support - low);
    places.into_iter().zip(&toes).zip(&heights).map(offset).collect()
}

/// Where a foot is held: at its mean position or, if it goes further than `reach` from there, on a rope of that length.
fn places(toes: &[DVec3], reach: f64) -> Vec<DVec3> {
    let mean = toes.iter().sum::<DVec3>() / toes.len() as f64;
    if toes.iter().all(|toes| toes.distance(mean) <= reach) {
        return vec![mean; toes.len()];
    }
    let mut place = toes[0];
    let follow = |toes: &DVec3| {
        place = *toes + (place - *toes).clamp_length_max(reach);
        place
    };
    toes.iter().map(follow).collect()
}
