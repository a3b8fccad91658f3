//! Planted feet: where the source's foot stands, the target's toes stay in one place, on the ground. The whole body comes down
//! (or up) to where its feet stand lowest; for the rest the legs reach with two bones (law of cosines), the knee keeping its
//! plane and the foot its direction; hips come down further when a leg would have to be longer than it is.

use std::ops::Range;

use glam::{DMat3, DQuat, DVec3};

use crate::anim::{Interpolation, JointIndex, Keys, Pose, Property, SampleCursor};
use crate::asset::Slot;
use crate::retarget::align::rest::{Reference, ancestry, unit};
use crate::retarget::feet::contacts::contacts;
use crate::retarget::retargeting::{RetargetError, Retargeted, Retargeting};
use crate::retarget::transfer::root::Removed;
use crate::retarget::transfer::rotation::NewChannel;

/// Into and out of a stand, seconds.
const EASE_SECS: f64 = 0.12;

/// A leg is never stretched further than this share of its length: a straight knee has no plane. Further than the second only
/// where it is without planting: in a nearly straight leg millimetres of the foot's place turn the knee by degrees.
const MOST_REACH: f64 = 0.999;
const EASY_REACH: f64 = 0.99;

/// Shares of the hips' height above the ground: a body that hovers by more than the first does so on purpose, and a foot that
/// then still is off the ground by more than the second stands on something else.
const MOST_HOVER: f64 = 0.25;
const LEVEL: f64 = 0.08;

/// Keys of a planted clip are at most this far apart.
const MOST_STEP_SECS: f32 = 1.0 / 30.0;

/// One leg: which joints it is made of, in the target.
struct Leg {
    hip: JointIndex,
    knee: JointIndex,
    ankle: JointIndex,
    /// What stays in place: the toes, or the ankle itself.
    toes: JointIndex,
    /// When the source's foot stands: ranges of the times that are looked at.
    stands: Vec<Range<usize>>,
}

/// A leg at all times: how far its foot is to be moved.
struct Plan {
    leg: Leg,
    moves: Vec<DVec3>,
}

impl Retargeting<'_> {
    /// The clip with its feet planted; as it is where no foot stands or legs are not mapped.
    ///
    /// # Errors
    /// As [`Retargeting::bake`].
    pub fn plant(&self, unplanted: Retargeted) -> Result<Retargeted, RetargetError> {
        let times = self.planted_times();
        let mut cursor = SampleCursor::default();
        let mut pose = Pose::default();
        let mut targets: Vec<Reference> =
            times.iter().map(|&time| self.target_at(&unplanted.clip, time, &mut cursor, &mut pose)).collect();
        let (laws, _) = self.turned_laws();
        let removed = self.root().map(|root| root.removed(&laws, &times)).unwrap_or_default();
        let legs = self.legs(&times);
        let Some(hover) = self.hover(&legs, &targets) else { return Ok(unplanted) };
        self.lower(&mut targets, hover);
        let plans: Vec<Plan> = legs.into_iter().map(|leg| self.plan(leg, &times, &targets, &removed)).collect();
        let drops = self.drops(&times, &targets, &plans);

        let mut rotations: Vec<(JointIndex, Vec<DQuat>)> = Vec::new();
        for plan in &plans {
            let mut keys: [Vec<DQuat>; 3] = Default::default();
            for (index, target) in targets.iter().enumerate() {
                let solved = self.solve(&plan.leg, target, plan.moves[index], drops[index]);
                keys.iter_mut().zip(solved).for_each(|(keys, rotation)| keys.push(rotation));
            }
            rotations.extend([plan.leg.hip, plan.leg.knee, plan.leg.ankle].into_iter().zip(keys));
        }
        let lowered = hover != 0.0 || drops.iter().any(|&drop| drop > 0.0);
        let hips = self.hips.map(|hips| self.map.pairs[hips.pair].target).filter(|_| lowered);
        let replaced = |joint: JointIndex, property: Property| match property {
            Property::Rotation => rotations.iter().any(|(other, _)| *other == joint),
            Property::Translation => hips == Some(joint),
            Property::Scale | Property::MorphWeights => false,
        };
        let clip = &unplanted.clip;
        let kept = clip.channels().iter().filter(|channel| !replaced(channel.joint, channel.keys.property()));
        let mut channels: Vec<NewChannel> = kept
            .map(|channel| NewChannel {
                joint: channel.joint,
                interpolation: channel.interpolation,
                times: clip.timelines()[channel.timeline as usize].clone(),
                keys: channel.keys.clone(),
                resampled: unplanted.resampled.contains(&channel.joint),
            })
            .collect();
        if let Some(hips) = hips {
            let places = targets.iter().zip(&drops).map(|(target, &drop)| {
                let place = target.positions[hips.get()] - DVec3::Y * drop;
                self.frame_above(hips, target).inverse().transform_point3(place).as_vec3()
            });
            channels.push(linear(hips, &times, Keys::Translation(places.collect())));
        }
        for (joint, keys) in rotations {
            channels.push(linear(joint, &times, Keys::Rotation(keys.into_iter().map(DQuat::as_quat).collect())));
        }
        let planted = self.finish(channels, unplanted.nowhere_to_extract)?;
        Ok(Retargeted { unplanted: Some(unplanted.clip), ..planted })
    }

    /// The source's keys, and more where these are far apart.
    fn planted_times(&self) -> Vec<f32> {
        let keys = crate::retarget::keys::resample::union(self.source_clip.timelines().iter().map(Vec::as_slice));
        let mut times: Vec<f32> = Vec::with_capacity(keys.len());
        for &key in &keys {
            if let Some(&before) = times.last() {
                let parts = ((key - before) / MOST_STEP_SECS).ceil().clamp(1.0, 1000.0) as usize;
                let step = (key - before) / parts as f32;
                times.extend((1..parts).map(|part| before + step * part as f32));
            }
            times.push(key);
        }
        times
    }

    /// Legs of which hip, knee and ankle are mapped.
    fn legs(&self, times: &[f32]) -> Vec<Leg> {
        let pair = |slot: Slot| self.alignment.pair_of_slot.get(&slot).map(|&pair| &self.map.pairs[pair]);
        let sides = [
            [Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot, Slot::LeftToes],
            [Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot, Slot::RightToes],
        ];
        let leg = |[hip, knee, ankle, toes]: [Slot; 4]| {
            let (hip, knee, ankle) = (pair(hip)?, pair(knee)?, pair(ankle)?);
            let toes = pair(toes).unwrap_or(ankle);
            let (hip, knee) = (hip.target, knee.target);
            let stands = self.stands(toes.source, times);
            Some(Leg { hip, knee, ankle: ankle.target, toes: toes.target, stands })
        };
        sides.into_iter().filter_map(leg).collect()
    }

    /// When a foot of the source stands.
    fn stands(&self, toes: JointIndex, times: &[f32]) -> Vec<Range<usize>> {
        let source: Vec<DVec3> = times.iter().map(|&time| self.source_at(time).positions[toes.get()]).collect();
        let standing = contacts(times, &source, self.source_height());
        let begins = (0..times.len()).filter(|&at| standing[at] && (at == 0 || !standing[at - 1]));
        let end = |from: usize| (from..times.len()).find(|&at| !standing[at]).unwrap_or(times.len());
        begins.map(|from| from..end(from)).collect()
    }

    /// How high the toes are above where they rest.
    fn height(&self, leg: &Leg, target: &Reference) -> f64 {
        let height = |at: &Reference| at.positions[leg.toes.get()].y;
        height(target) - height(&self.alignment.target)
    }

    /// By how much the body is too high: a quarter of the time that feet stand they are lower. The very lowest stand is often
    /// a slip of the capture. None when no foot ever stands.
    fn hover(&self, legs: &[Leg], targets: &[Reference]) -> Option<f64> {
        let mut heights = Vec::new();
        for leg in legs {
            let standing = leg.stands.iter().flat_map(|stand| &targets[stand.clone()]);
            heights.extend(standing.map(|target| self.height(leg, target)));
        }
        let at = heights.len() / 4;
        if heights.is_empty() {
            return None;
        }
        let hover = *heights.select_nth_unstable_by(at, f64::total_cmp).1;
        let near = self.hips.is_some_and(|hips| hover.abs() < MOST_HOVER * hips.height);
        Some(if near { hover } else { 0.0 })
    }

    /// Lowers the hips and what hangs on them.
    fn lower(&self, targets: &mut [Reference], by: f64) {
        let Some(hips) = self.hips.map(|hips| self.map.pairs[hips.pair].target) else { return };
        let skeleton = &self.model.asset.skeleton;
        let body: Vec<JointIndex> =
            skeleton.joints().filter(|&joint| ancestry(skeleton, joint).any(|above| above == hips)).collect();
        for target in targets {
            body.iter().for_each(|joint| target.positions[joint.get()].y -= by);
        }
    }

    /// How far a foot is to be moved at each time, so that its toes stay where they are on average while it stands, on the
    /// ground where that is near.
    fn plan(&self, leg: Leg, times: &[f32], targets: &[Reference], removed: &Removed) -> Plan {
        // Of a figure walking in one place the ground moves: feet stand on it, so travel is added back.
        let travel = |index: usize| removed.horizontal.get(index).map_or(DVec3::ZERO, |(_, travel)| *travel);
        let toes = |index: usize| targets[index].positions[leg.toes.get()] + travel(index);
        let mut moves = vec![DVec3::ZERO; times.len()];
        for stand in &leg.stands {
            let mut place = stand.clone().map(toes).sum::<DVec3>() / stand.len() as f64;
            let heights = targets[stand.clone()].iter().map(|target| self.height(&leg, target));
            let height = heights.sum::<f64>() / stand.len() as f64;
            if self.hips.is_some_and(|hips| height.abs() < LEVEL * hips.height) {
                place.y -= height;
            }
            let (from, to) = (stand.start, stand.end - 1);
            let (first, last) = (place - toes(from), place - toes(to));
            for (at, by) in moves.iter_mut().enumerate() {
                let secs = |other: usize| (f64::from(times[at]) - f64::from(times[other])).abs();
                *by += match at {
                    at if at < from => first * ease(secs(from)),
                    at if at > to => last * ease(secs(to)),
                    at => place - toes(at),
                };
            }
        }
        if let Some(hips) = self.hips {
            for (by, target) in moves.iter_mut().zip(targets) {
                let height = |joint: JointIndex| target.positions[joint.get()].y;
                by.y = by.y.max(hips.target_ground - height(leg.toes).min(height(leg.ankle)));
            }
        }
        Plan { leg, moves }
    }

    /// How far the hips must come down at each time for all legs to reach, smooth over time.
    fn drops(&self, times: &[f32], targets: &[Reference], plans: &[Plan]) -> Vec<f64> {
        let needed: Vec<f64> = targets
            .iter()
            .enumerate()
            .map(|(index, target)| {
                plans.iter().map(|plan| self.drop_for(&plan.leg, target, plan.moves[index])).fold(0.0, f64::max)
            })
            .collect();
        // The most of the neighbourhood, then its mean: never less than what is needed.
        let near = |index: usize| {
            let from = times.partition_point(|&time| f64::from(times[index] - time) > EASE_SECS);
            let to = times.partition_point(|&time| f64::from(time - times[index]) <= EASE_SECS);
            from..to
        };
        let most: Vec<f64> = (0..times.len()).map(|at| needed[near(at)].iter().copied().fold(0.0, f64::max)).collect();
        (0..times.len()).map(|at| most[near(at)].iter().sum::<f64>() / near(at).len() as f64).collect()
    }

    fn drop_for(&self, leg: &Leg, target: &Reference, by: DVec3) -> f64 {
        let at = |joint: JointIndex| target.positions[joint.get()];
        let (hip, knee, ankle) = (at(leg.hip), at(leg.knee), at(leg.ankle));
        let length = (knee - hip).length() + (ankle - knee).length();
        let reach = (ankle - hip).length().clamp(EASY_REACH * length, MOST_REACH * length);
        let from = ankle + by - hip;
        if by.length() <= 1e-9 || from.length() <= reach {
            return 0.0;
        }
        // |from + drop · Y| = reach, the nearer of the two solutions; when the goal is out of reach at any height, its height.
        let level = from.x * from.x + from.z * from.z;
        let rise = (reach * reach - level).max(0.0).sqrt();
        (-from.y - rise).max(0.0)
    }

    /// Local rotations of hip, knee and ankle that bring the ankle to its place, seen from hips that have come down.
    fn solve(&self, leg: &Leg, target: &Reference, by: DVec3, drop: f64) -> [DQuat; 3] {
        let at = |joint: JointIndex| target.positions[joint.get()];
        let goal = at(leg.ankle) + by + DVec3::Y * drop;
        let (hip, knee, ankle) = (at(leg.hip), at(leg.knee), at(leg.ankle));
        let (thigh, shin, line) = (knee - hip, ankle - knee, ankle - hip);
        let (upper, lower) = (thigh.length(), shin.length());
        let wanted = goal - hip;
        let untouched = (goal - ankle).length() <= 1e-9 || upper <= 0.0 || lower <= 0.0;
        let (thigh_turn, shin_turn) = match (thigh.cross(line).try_normalize(), wanted.try_normalize()) {
            (Some(plane), Some(aim)) if !untouched => {
                let reach = MOST_REACH * (upper + lower);
                let distance = wanted.length().clamp((upper - lower).abs() * 1.001, reach);
                let plane_turn = DQuat::from_rotation_arc(line.normalize_or(aim), aim);
                let new_plane = plane_turn * plane;
                let cos = (upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance);
                let angle = cos.clamp(-1.0, 1.0).acos();
                let new_thigh = DQuat::from_axis_angle(new_plane, -angle) * aim;
                let new_shin = (distance * aim - upper * new_thigh).normalize_or(aim);
                (between(thigh / upper, plane, new_thigh, new_plane), between(shin / lower, plane, new_shin, new_plane))
            }
            _ => (DQuat::IDENTITY, DQuat::IDENTITY),
        };
        let turned = |joint: JointIndex, above: DQuat, own: DQuat| {
            let parent = self.model.asset.skeleton.parent(joint);
            let parent = parent.map_or(self.alignment.target_turn, |parent| target.rotations[parent.get()]);
            unit((above * parent).conjugate() * own * target.rotations[joint.get()])
        };
        [
            turned(leg.hip, DQuat::IDENTITY, thigh_turn),
            turned(leg.knee, thigh_turn, shin_turn),
            turned(leg.ankle, shin_turn, DQuat::IDENTITY),
        ]
    }
}

/// 1 at a stand's end, 0 beyond the ease.
fn ease(secs: f64) -> f64 {
    let left = (1.0 - secs / EASE_SECS).clamp(0.0, 1.0);
    left * left * (3.0 - 2.0 * left)
}

/// The rotation that takes one pair of perpendicular unit vectors to another.
fn between(along: DVec3, across: DVec3, new_along: DVec3, new_across: DVec3) -> DQuat {
    let basis = |along: DVec3, across: DVec3| DMat3::from_cols(along, across, along.cross(across));
    unit(DQuat::from_mat3(&(basis(new_along, new_across) * basis(along, across).transpose())))
}

fn linear(joint: JointIndex, times: &[f32], keys: Keys) -> NewChannel {
    NewChannel { joint, interpolation: Interpolation::Linear, times: times.to_vec(), keys, resampled: true }
}
