//! How good a borrowed clip is, in numbers: measured on the finished clip as the player plays it, at the source's keys and
//! halfway between them, in the common frame.

use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::anim::{Clip, JointIndex, Pose, SampleCursor};
use crate::asset::Slot;
use crate::retarget::align::rest::{Local, Reference, unit};
use crate::retarget::align::swing::{compared_segments, degrees_between};
use crate::retarget::feet::contacts::contacts;
use crate::retarget::keys::resample::union;
use crate::retarget::keys::track::angle_between;
use crate::retarget::retargeting::{Retargeted, Retargeting};
use crate::retarget::transfer::root::{Removed, lowest_leg_joint};

/// What cannot be measured is `None`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Per mapped joint, how far its turn away from the aligned rest is from the source's. Of the clip without planting.
    pub orientation_error_degrees_mean: Option<f64>,
    pub orientation_error_degrees_max: Option<f64>,
    /// Angle between a limb's (or the torso's) direction and the source's: what an eye sees, without regard to rests.
    pub limb_direction_error_degrees_mean: Option<f64>,
    pub limb_direction_error_degrees_max: Option<f64>,
    /// Mean horizontal speed of the toes (ankles where there are none) while the source's are in contact, removed travel
    /// added back; and the source's own, scaled.
    pub foot_slide_metres_per_sec: Option<f64>,
    pub foot_slide_source_metres_per_sec: Option<f64>,
    /// The deepest a toe or ankle joint goes below the lowest leg joint of the aligned rest.
    pub ground_penetration_metres_max: Option<f64>,
    /// Mapped parts of the body over the parts that both have.
    pub coverage: Option<f64>,
}

/// One foot over the whole clip, at the times that are measured.
#[derive(Debug, Clone, PartialEq)]
pub struct FootTrack {
    /// The model's toes, or ankle.
    pub joint: JointIndex,
    pub times: Vec<f32>,
    /// The source's foot stands.
    pub touching: Vec<bool>,
    /// How fast the model's foot goes over the ground, from the time before to this one.
    pub metres_per_sec: Vec<f32>,
}

/// A mean and a maximum in the making.
#[derive(Debug, Default)]
struct Spread {
    sum: f64,
    count: usize,
    most: f64,
}

impl Spread {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
        self.most = self.most.max(value);
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    fn max(&self) -> Option<f64> {
        (self.count > 0).then_some(self.most)
    }
}

/// One foot over time: the joints that touch the ground.
pub struct Foot {
    pub source: JointIndex,
    pub target: JointIndex,
}

impl Retargeting<'_> {
    /// The source's keys, and halfway between them.
    pub fn measured_times(&self) -> Vec<f32> {
        let keys = union(self.source_clip.timelines().iter().map(Vec::as_slice));
        let mut times: Vec<f32> = Vec::with_capacity(2 * keys.len());
        for &key in &keys {
            if let Some(&before) = times.last() {
                let middle = before + 0.5 * (key - before);
                if middle > before && middle < key {
                    times.push(middle);
                }
            }
            times.push(key);
        }
        times
    }

    /// The source in the common frame at a time, muted channels left out.
    pub fn source_at(&self, time_secs: f32) -> Reference {
        let skeleton = &self.source.asset.skeleton;
        let locals = skeleton.joints().map(|joint| self.motion.local(joint, time_secs)).collect();
        Reference::new(skeleton, locals, self.alignment.source_turn)
    }

    /// The model with a clip in the common frame at a time, as the player would have it.
    pub fn target_at(&self, clip: &Clip, time_secs: f32, cursor: &mut SampleCursor, pose: &mut Pose) -> Reference {
        let skeleton = &self.model.asset.skeleton;
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time_secs, cursor, pose);
        let local = |local: &crate::anim::Transform| Local {
            translation: local.translation.as_dvec3(),
            rotation: unit(local.rotation.as_dquat()),
            scale: local.scale.as_dvec3(),
        };
        Reference::new(skeleton, pose.locals.iter().map(local).collect(), self.alignment.target_turn)
    }

    /// Feet that both sides have: toes where both have those, else ankles.
    pub fn feet(&self) -> Vec<Foot> {
        let pair = |slot: Slot| self.alignment.pair_of_slot.get(&slot).map(|&pair| &self.map.pairs[pair]);
        [(Slot::LeftFoot, Slot::LeftToes), (Slot::RightFoot, Slot::RightToes)]
            .into_iter()
            .filter_map(|(ankle, toes)| {
                let touching = pair(toes).or_else(|| pair(ankle))?;
                Some(Foot { source: touching.source, target: touching.target })
            })
            .collect()
    }

    /// Height of the source's head (or its highest mapped joint) above its ground at the aligned rest, source units.
    pub fn source_height(&self) -> f64 {
        let heights = self.map.pairs.iter().map(|pair| self.alignment.source.positions[pair.source.get()].y);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        (high - low).max(1e-9)
    }

    /// Measures what [`Retargeting::bake`] has made.
    pub fn figures(&self, made: &Retargeted) -> Figures {
        self.figures_of(&made.clip, made.unplanted.as_ref())
    }

    /// Measures any clip over the model; orientations on `unplanted`, the same without planting, if there is one.
    pub fn figures_of(&self, finished: &Clip, unplanted: Option<&Clip>) -> Figures {
        self.measure(finished, unplanted).0
    }

    /// As [`Self::figures_of`], with what the feet do in between.
    pub fn measure(&self, finished: &Clip, unplanted: Option<&Clip>) -> (Figures, Vec<FootTrack>) {
        let times = self.measured_times();
        let (laws, _) = self.turned_laws();
        let removed = self.root().map(|root| root.removed(&laws, &times)).unwrap_or_default();
        let scale = self.hips.map_or(1.0, |hips| hips.scale);
        let feet = self.feet();
        let segments: Vec<_> = compared_segments()
            .filter_map(|(from, to)| {
                let pair = |slot| self.alignment.pair_of_slot.get(&slot).map(|&pair: &usize| &self.map.pairs[pair]);
                Some((pair(from)?, pair(to)?))
            })
            .collect();
        let ground_joints: Vec<JointIndex> = [Slot::LeftFoot, Slot::LeftToes, Slot::RightFoot, Slot::RightToes]
            .into_iter()
            .filter_map(|slot| self.model.slots.joint(slot))
            .collect();
        let ground = lowest_leg_joint(self.model.slots, &self.alignment.target.positions);

        let (mut orientation, mut direction) = (Spread::default(), Spread::default());
        let mut deepest: Option<f64> = None;
        let mut source_feet: Vec<Vec<DVec3>> = vec![Vec::new(); feet.len()];
        let mut target_feet = source_feet.clone();
        let mut cursors = [SampleCursor::default(), SampleCursor::default()];
        let mut pose = Pose::default();
        for (index, &time) in times.iter().enumerate() {
            let source = self.source_at(time);
            let [cursor, other] = &mut cursors;
            let target = self.target_at(finished, time, cursor, &mut pose);
            let plain = unplanted.map(|unplanted| self.target_at(unplanted, time, other, &mut pose));
            let plain = plain.as_ref().unwrap_or(&target);
            let back = DQuat::from_rotation_y(-removed.yaw.as_ref().map_or(0.0, |yaw| yaw.at(time)));
            for pair in &self.map.pairs {
                let away = |now: &Reference, rest: &Reference, joint: JointIndex| {
                    now.rotations[joint.get()] * rest.rotations[joint.get()].conjugate()
                };
                let target = back * away(plain, &self.alignment.target, pair.target);
                let source = away(&source, &self.alignment.source, pair.source);
                orientation.add(angle_between(target, source).to_degrees());
            }
            for (from, to) in &segments {
                let along = |now: &Reference, from: JointIndex, to: JointIndex| {
                    now.positions[to.get()] - now.positions[from.get()]
                };
                let source = along(&source, from.source, to.source);
                let target = back * along(&target, from.target, to.target);
                if source.length() > 0.0 && target.length() > 0.0 {
                    direction.add(degrees_between(source, target));
                }
            }
            if let Some(ground) = ground {
                for joint in &ground_joints {
                    let depth = ground - target.positions[joint.get()].y;
                    deepest = Some(deepest.unwrap_or(0.0).max(depth));
                }
            }
            for (at, foot) in feet.iter().enumerate() {
                source_feet[at].push(source.positions[foot.source.get()]);
                target_feet[at].push(self.with_travel(&removed, index, back, &target, foot.target));
            }
        }

        let (mut ours, mut theirs) = (Slide::default(), Slide::default());
        let mut tracks = Vec::with_capacity(feet.len());
        for (at, (source, target)) in source_feet.iter().zip(&target_feet).enumerate() {
            let touching = contacts(&times, source, self.source_height());
            ours.add(&times, target, &touching, 1.0);
            theirs.add(&times, source, &touching, scale);
            let metres_per_sec = ground_speeds(&times, target);
            tracks.push(FootTrack { joint: feet[at].target, times: times.clone(), touching, metres_per_sec });
        }
        let figures = Figures {
            orientation_error_degrees_mean: orientation.mean(),
            orientation_error_degrees_max: orientation.max(),
            limb_direction_error_degrees_mean: direction.mean(),
            limb_direction_error_degrees_max: direction.max(),
            foot_slide_metres_per_sec: ours.speed(),
            foot_slide_source_metres_per_sec: theirs.speed(),
            ground_penetration_metres_max: deepest,
            coverage: self.coverage(),
        };
        (figures, tracks)
    }

    /// Where a target joint would be had nothing been taken from the clip's travel.
    fn with_travel(
        &self,
        removed: &Removed,
        index: usize,
        back: DQuat,
        target: &Reference,
        joint: JointIndex,
    ) -> DVec3 {
        let position = target.positions[joint.get()];
        let hips = self.hips.map(|hips| target.positions[self.map.pairs[hips.pair].target.get()]);
        let turned = hips.map_or(position, |hips| hips + back * (position - hips));
        turned + removed.horizontal.get(index).map_or(DVec3::ZERO, |(_, travel)| *travel)
    }

    fn coverage(&self) -> Option<f64> {
        let both: Vec<JointIndex> = Slot::ALL
            .iter()
            .filter_map(|&slot| self.source.slots.joint(slot).and(self.model.slots.joint(slot)))
            .collect();
        let mapped = both.iter().filter(|&&joint| self.map.source_of(joint).is_some()).count();
        (!both.is_empty()).then(|| mapped as f64 / both.len() as f64)
    }
}

fn ground_speeds(times: &[f32], positions: &[DVec3]) -> Vec<f32> {
    let speed = |at: usize| {
        let before = at.saturating_sub(1);
        let secs = f64::from(times[at] - times[before]);
        let way = ((positions[at] - positions[before]) * DVec3::new(1.0, 0.0, 1.0)).length();
        if secs > 0.0 { (way / secs) as f32 } else { 0.0 }
    };
    (0..times.len()).map(speed).collect()
}

/// Horizontal way and time of feet in contact.
#[derive(Debug, Default)]
struct Slide {
    way: f64,
    secs: f64,
}

impl Slide {
    fn add(&mut self, times: &[f32], positions: &[DVec3], touching: &[bool], scale: f64) {
        for at in 1..times.len() {
            if touching[at - 1] && touching[at] {
                let step = (positions[at] - positions[at - 1]) * DVec3::new(1.0, 0.0, 1.0);
                self.way += scale * step.length();
                self.secs += f64::from(times[at] - times[at - 1]);
            }
        }
    }

    fn speed(&self) -> Option<f64> {
        (self.secs > 0.0).then(|| self.way / self.secs)
    }
}
