//! Where the hips are: the source's path in the common frame, from its rest, scaled by the ratio of the hips' heights above
//! the ground; kept, brought to a stop or frozen; written below whatever the target's hips hang on.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DAffine3, DQuat, DVec3, Vec3};

use crate::anim::{Interpolation, JointIndex, Keys, Skeleton};
use crate::asset::{Humanoid, Slot};
use crate::retarget::align::rest::{Local, ancestry};
use crate::retarget::align::swing::{Alignment, yaw_of};
use crate::retarget::keys::resample::{Resampled, resample, union};
use crate::retarget::keys::track::{Motion, Track, vector_at};
use crate::retarget::map::ResolvedMap;
use crate::retarget::map::RootPart;
use crate::retarget::transfer::rotation::{NewChannel, RotationLaw, TOLERANCE_RADIANS, Yaw};

/// Where keys had to be put anew, straight interpolation is nearer than this share of the hips' height.
const TOLERANCE_OF_HEIGHT: f64 = 1e-4;

/// Less turn than this from first to last key is sway, not travel, when travel is moved to the root joint.
const LEAST_YAW_TRAVEL_DEGREES: f64 = 5.0;

pub const LEGS: [Slot; 8] = [
    Slot::LeftUpperLeg,
    Slot::LeftLowerLeg,
    Slot::LeftFoot,
    Slot::LeftToes,
    Slot::RightUpperLeg,
    Slot::RightLowerLeg,
    Slot::RightFoot,
    Slot::RightToes,
];

/// How the two hips correspond.
#[derive(Debug, Clone, Copy)]
pub struct Hips {
    /// Index into [`ResolvedMap::pairs`].
    pub pair: usize,
    /// Target units per source unit.
    pub scale: f64,
    /// What the source's path is measured from, common frame, source units.
    pub source_rest: DVec3,
    /// And where the target is then, common frame, target units.
    pub target_rest: DVec3,
    /// Height of the hips above the ground at the aligned rest, target units.
    pub height: f64,
    /// The height of the ground, common frame: of the source in source units, of the target in target units.
    pub source_ground: f64,
    pub target_ground: f64,
}

/// Travel that the clip has been freed of, in target units and the common frame: what the figures add back.
#[derive(Debug, Clone, Default)]
pub struct Removed {
    pub horizontal: Vec<(f32, DVec3)>,
    pub yaw: Option<Yaw>,
}

impl Hips {
    /// None when no pair has to do with the hips. Without a humanoid, the first pair without a mapped ancestor whose source
    /// moves stands in for them.
    pub fn new(
        map: &ResolvedMap,
        alignment: &Alignment,
        [source_slots, target_slots]: [&Humanoid; 2],
        target_skeleton: &Skeleton,
        motion: &Motion,
    ) -> Option<Self> {
        let travels =
            |joint: JointIndex| ancestry(motion.skeleton, joint).any(|joint| motion.translations[joint.get()].moves());
        let is_top = |index: &usize| {
            let target = map.pairs[*index].target;
            !ancestry(target_skeleton, target).skip(1).any(|joint| map.source_of(joint).is_some())
        };
        let pair = alignment.pair_of_slot.get(&Slot::Hips).copied().or_else(|| {
            let none = alignment.pair_of_slot.is_empty();
            (0..map.pairs.len()).filter(|_| none).find(|index| is_top(index) && travels(map.pairs[*index].source))
        })?;
        let source_rest = alignment.source.positions[map.pairs[pair].source.get()];
        let target_rest = alignment.target.positions[map.pairs[pair].target.get()];
        // Both sides look at the same parts, so that a rig without toes is not taken for one with short legs.
        let both = |slot: &Slot| Some((source_slots.joint(*slot)?, target_slots.joint(*slot)?));
        let legs: Vec<_> = LEGS.iter().filter_map(both).collect();
        let lowest = |heights: &mut dyn Iterator<Item = f64>| heights.fold(f64::INFINITY, f64::min);
        let source_height_of = |joint: JointIndex| alignment.source.positions[joint.get()].y;
        let (mut source_ground, mut target_ground) = (
            lowest(&mut legs.iter().map(|(source, _)| source_height_of(*source))),
            lowest(&mut legs.iter().map(|(_, target)| alignment.target.positions[target.get()].y)),
        );
        if legs.is_empty() {
            source_ground = lowest(&mut map.pairs.iter().map(|pair| source_height_of(pair.source)));
            target_ground = lowest(&mut map.pairs.iter().map(|pair| alignment.target.positions[pair.target.get()].y));
        }
        let (source_height, height) = (source_rest.y - source_ground, target_rest.y - target_ground);
        let usable = source_height > 1e-9 && height > 1e-9 && (height / source_height).is_finite();
        let mut hips = Self {
            pair,
            scale: if usable { height / source_height } else { 1.0 },
            source_rest,
            target_rest,
            height: height.max(1e-9),
            source_ground,
            target_ground,
        };
        hips.stand(&legs, alignment, map, motion);
        Some(hips)
    }

    /// Some skeletons rest with their hips in the origin and are moved up by every clip (BVH as a rule). Where the feet go
    /// in the clip tells whether the ground is under the resting feet or in the plane of the origin; in the latter case the
    /// rest is lifted until it stands there.
    fn stand(&mut self, legs: &[(JointIndex, JointIndex)], alignment: &Alignment, map: &ResolvedMap, motion: &Motion) {
        let height = self.source_rest.y - self.source_ground;
        if self.source_ground.abs() < 0.25 * height || legs.is_empty() {
            return;
        }
        let mut times = union(path_timelines(motion, map.pairs[self.pair].source));
        let step = times.len().div_ceil(32).max(1);
        times = times.into_iter().step_by(step).collect();
        if times.is_empty() {
            times.push(0.0);
        }
        let lowest = |time: &f32| {
            let feet = legs.iter().map(|(joint, _)| world_position(motion, alignment.source_turn, *joint, *time).y);
            feet.fold(f64::INFINITY, f64::min)
        };
        let mut lows: Vec<f64> = times.iter().map(lowest).collect();
        lows.sort_by(f64::total_cmp);
        let usual = lows[lows.len() / 2];
        if usual.abs() < (usual - self.source_ground).abs() {
            self.source_rest.y -= self.source_ground;
            self.source_ground = 0.0;
        }
    }

    /// Where the target's hips would be with nothing taken away, common frame.
    fn wanted(&self, source: DVec3) -> DVec3 {
        self.target_rest + self.scale * (source - self.source_rest)
    }
}

/// Where a source joint is, common frame, source units.
pub fn world_position(motion: &Motion, turn: DQuat, joint: JointIndex, time_secs: f32) -> DVec3 {
    let above = above(motion, turn, joint, time_secs);
    above.transform_point3(vector_at(&motion.translations[joint.get()], time_secs))
}

/// The frame that a source joint hangs in.
fn above(motion: &Motion, turn: DQuat, joint: JointIndex, time_secs: f32) -> DAffine3 {
    let mut frame = DAffine3::IDENTITY;
    for ancestor in ancestry(motion.skeleton, joint).skip(1) {
        frame = motion.local(ancestor, time_secs).to_affine() * frame;
    }
    DAffine3::from_quat(turn) * frame
}

/// Timelines of all that moves a joint about.
fn path_timelines<'a>(motion: &'a Motion, joint: JointIndex) -> Vec<&'a [f32]> {
    let own = motion.translations[joint.get()].times();
    let ancestors = ancestry(motion.skeleton, joint).skip(1).flat_map(|joint| {
        let joint = joint.get();
        [motion.translations[joint].times(), motion.rotations[joint].times(), motion.scales[joint].times()]
    });
    ancestors.chain([own]).collect()
}

/// What is asked of the root, and what it is made of.
pub struct RootMotion<'a> {
    pub map: &'a ResolvedMap,
    pub hips: Hips,
    pub alignment: &'a Alignment,
    pub target_skeleton: &'a Skeleton,
    pub motion: &'a Motion<'a>,
}

/// What has been found out about a path: the straight line from its first to its last key.
#[derive(Debug, Clone, Copy)]
struct Travel {
    first_secs: f32,
    first: DVec3,
    /// Per second.
    slope: DVec3,
}

impl Travel {
    fn at(&self, time_secs: f32) -> DVec3 {
        self.slope * f64::from(time_secs - self.first_secs)
    }
}

impl RootMotion<'_> {
    fn source_joint(&self) -> JointIndex {
        self.map.pairs[self.hips.pair].source
    }

    fn target_joint(&self) -> JointIndex {
        self.map.pairs[self.hips.pair].target
    }

    /// The topmost mapped joint at or above the hips: turning it turns the whole figure.
    fn top_pair(&self) -> usize {
        ancestry(self.target_skeleton, self.target_joint())
            .filter_map(|joint| self.map.pairs.iter().position(|pair| pair.target == joint))
            .last()
            .unwrap_or(self.hips.pair)
    }

    fn path_times(&self) -> Vec<f32> {
        union(path_timelines(self.motion, self.source_joint()))
    }

    fn wanted(&self, time_secs: f32) -> DVec3 {
        self.hips.wanted(world_position(self.motion, self.alignment.source_turn, self.source_joint(), time_secs))
    }

    fn travel(&self, times: &[f32]) -> Option<Travel> {
        let (&first_secs, &last_secs) = (times.first()?, times.last()?);
        let first = self.wanted(first_secs);
        let secs = f64::from(last_secs - first_secs);
        let slope = if secs > 0.0 { (self.wanted(last_secs) - first) / secs } else { DVec3::ZERO };
        Some(Travel { first_secs, first, slope })
    }

    /// 1 for the axes that a part of the root's options is about, if it is as given.
    fn axes(&self, part: RootPart) -> DVec3 {
        let root = &self.map.root;
        let on = |chosen: RootPart| f64::from(u8::from(chosen == part));
        DVec3::new(on(root.horizontal), on(root.vertical), on(root.horizontal))
    }

    /// Axes whose travel the hips lose: all that is in place, and what goes to the root joint.
    fn stopped_axes(&self) -> DVec3 {
        let extracted =
            if self.extracts() { self.axes(RootPart::Keep) * DVec3::new(1.0, 0.0, 1.0) } else { DVec3::ZERO };
        self.axes(RootPart::InPlace) + extracted
    }

    fn extracts(&self) -> bool {
        self.map.root.extract && self.extraction_joint().is_some()
    }

    /// The joint that travel is moved to: the one that the hips hang on, if it follows no source itself.
    pub fn extraction_joint(&self) -> Option<JointIndex> {
        let parent = self.target_skeleton.parent(self.target_joint())?;
        self.map.source_of(parent).is_none().then_some(parent)
    }

    /// Whether the options leave the path alone, so that translations may be copied as they are.
    pub fn keeps_all(&self) -> bool {
        let root = &self.map.root;
        [root.horizontal, root.vertical, root.yaw] == [RootPart::Keep; 3] && !root.extract
    }

    /// Sets what turning is taken from the figure. Gives the turn that goes to the root joint, if any.
    pub fn stop_turning(&self, laws: &mut [RotationLaw]) -> Option<Yaw> {
        if self.map.root.yaw == RootPart::Keep && !self.extracts() {
            return None;
        }
        let top = self.top_pair();
        let hips = self.target_joint();
        let rest = self.alignment.target.rotations[hips.get()];
        let heading = |time: f32| {
            let world = ancestry(self.target_skeleton, hips).fold(DQuat::IDENTITY, |below, joint| {
                let pair = self.map.pairs.iter().position(|pair| pair.target == joint);
                let local = pair.map_or(self.alignment.target.locals[joint.get()].rotation, |pair| laws[pair].at(time));
                local * below
            });
            yaw_of(self.alignment.target_turn * world * rest.conjugate())
        };
        let (top_times, top_jumps) = laws[top].times();
        let (hips_times, hips_jumps) = laws[self.hips.pair].times();
        let (times, jumps) = (union([&top_times[..], &hips_times]), union([&top_jumps[..], &hips_jumps]));
        let (&first_secs, &last_secs) = (times.first()?, times.last()?);
        let wrapped = |angle: f64| angle - (angle / TAU).round() * TAU;
        let between = |from: f64, to: f64, factor: f64| from + factor * wrapped(to - from);
        let Resampled { times, values: mut headings } =
            resample(&times, &jumps, TOLERANCE_RADIANS, heading, between, |a, b| wrapped(a - b).abs());
        // Unwrapped, so that several turns are several turns.
        for at in 1..headings.len() {
            headings[at] = headings[at - 1] + wrapped(headings[at] - headings[at - 1]);
        }
        let secs = f64::from(last_secs - first_secs);
        let slope = if secs > 0.0 { (headings[headings.len() - 1] - headings[0]) / secs } else { 0.0 };
        let line = |time: f32| slope * f64::from(time - first_secs);
        let travel_degrees = (slope * secs).to_degrees().abs();
        let extracted =
            self.extracts() && self.map.root.yaw == RootPart::Keep && travel_degrees > LEAST_YAW_TRAVEL_DEGREES;
        let removed: Vec<f64> = match self.map.root.yaw {
            RootPart::Keep if !extracted => return None,
            RootPart::Keep | RootPart::InPlace => times.iter().map(|&time| -line(time)).collect(),
            RootPart::Freeze => headings.iter().map(|heading| headings[0] - heading).collect(),
        };
        laws[top].yaw = Some(Yaw { times: times.clone(), radians: removed });
        extracted.then(|| Yaw { radians: times.iter().map(|&time| line(time)).collect(), times })
    }

    /// The path in the common frame with the options applied.
    fn path(&self, travel: &Travel, time_secs: f32) -> DVec3 {
        let frozen = self.axes(RootPart::Freeze);
        let wanted = self.wanted(time_secs) - self.stopped_axes() * travel.at(time_secs);
        wanted * (DVec3::ONE - frozen) + travel.first * frozen
    }

    /// Channels of the hips' translation, and of the root joint when travel is moved there. `root_turn` is what
    /// [`Self::stop_turning`] gave.
    pub fn channels(&self, laws: &[RotationLaw], root_turn: Option<&Yaw>) -> Vec<NewChannel> {
        let times = self.path_times();
        let joint = self.target_joint();
        let Some(travel) = self.travel(&times) else {
            return self.still_channel(joint).into_iter().collect();
        };
        let mut channels = Vec::new();
        let extraction = self.extraction_joint().filter(|_| self.extracts());
        if let Some(root) = extraction {
            channels.extend(self.root_channels(root, &travel, &times, root_turn));
        }
        channels.extend(self.transformed(&travel).filter(|_| root_turn.is_none()).or_else(|| {
            Some(self.resampled(joint, &times, |time| {
                let frame = self.target_frame(laws, time);
                let moved = match (extraction, root_turn) {
                    (Some(root), Some(turn)) => {
                        // As seen from a root that turns; its travel is not in the path.
                        let pivot = self.alignment.target.positions[root.get()];
                        pivot + DQuat::from_rotation_y(-turn.at(time)) * (self.path(&travel, time) - pivot)
                    }
                    _ => self.path(&travel, time),
                };
                frame.inverse().transform_point3(moved)
            }))
        }));
        channels
    }

    /// A path that does not move may still be elsewhere than the rest.
    fn still_channel(&self, joint: JointIndex) -> Option<NewChannel> {
        let moved =
            ancestry(self.motion.skeleton, self.source_joint()).any(|joint| self.motion.has_channel[joint.get()]);
        let frame = self.rest_frame();
        let translation = frame.inverse().transform_point3(self.wanted(0.0));
        moved.then(|| NewChannel {
            joint,
            interpolation: Interpolation::Step,
            times: vec![0.0],
            keys: Keys::Translation(vec![translation.as_vec3()]),
            resampled: false,
        })
    }

    /// The frame that the target's hips hang in at the aligned rest.
    fn rest_frame(&self) -> DAffine3 {
        self.target_frame(&[], 0.0)
    }

    /// The same at a time: mapped ancestors turn. No laws: at the aligned rest.
    fn target_frame(&self, laws: &[RotationLaw], time_secs: f32) -> DAffine3 {
        let mut frame = DAffine3::IDENTITY;
        for ancestor in ancestry(self.target_skeleton, self.target_joint()).skip(1) {
            let local: Local = self.alignment.target.locals[ancestor.get()];
            let pair = self.map.pairs.iter().position(|pair| pair.target == ancestor);
            let rotation = pair.and_then(|pair| laws.get(pair)).map_or(local.rotation, |law| law.at(time_secs));
            frame = Local { rotation, ..local }.to_affine() * frame;
        }
        DAffine3::from_quat(self.alignment.target_turn) * frame
    }

    /// The source's own keys, where all that hangs between them and the target's is constant.
    fn transformed(&self, travel: &Travel) -> Option<NewChannel> {
        let source = self.source_joint();
        let ancestors_move = ancestry(self.motion.skeleton, source).skip(1).any(|joint| self.motion.joint_moves(joint));
        let target_turns = ancestry(self.target_skeleton, self.target_joint())
            .skip(1)
            .any(|joint| self.map.source_of(joint).is_some());
        let Track::Keys { times, channel } = &self.motion.translations[source.get()] else { return None };
        let Keys::Translation(values) = &channel.keys else { return None };
        let stopped = self.stopped_axes();
        let step = channel.interpolation == Interpolation::Step;
        if ancestors_move || target_turns || (step && stopped * travel.slope != DVec3::ZERO) {
            return None;
        }
        let above = above(self.motion, self.alignment.source_turn, source, 0.0);
        let below = self.rest_frame().inverse();
        let (frozen, free) = (self.axes(RootPart::Freeze), DVec3::ONE - self.axes(RootPart::Freeze));
        let point = |value: &Vec3, time: f32| {
            let wanted = self.hips.wanted(above.transform_point3(value.as_dvec3()));
            let path = (wanted - stopped * travel.at(time)) * free + travel.first * frozen;
            below.transform_point3(path).as_vec3()
        };
        let tangent = |value: &Vec3| {
            let along = self.hips.scale * above.transform_vector3(value.as_dvec3());
            below.transform_vector3((along - stopped * travel.slope) * free).as_vec3()
        };
        let keys = match channel.interpolation {
            Interpolation::CubicSpline => values
                .chunks(3)
                .zip(*times)
                .flat_map(|(entry, &time)| [tangent(&entry[0]), point(&entry[1], time), tangent(&entry[2])])
                .collect(),
            _ => values.iter().zip(*times).map(|(value, &time)| point(value, time)).collect(),
        };
        Some(NewChannel {
            joint: self.target_joint(),
            interpolation: channel.interpolation,
            times: times.to_vec(),
            keys: Keys::Translation(keys),
            resampled: false,
        })
    }

    fn resampled(&self, joint: JointIndex, times: &[f32], at: impl Fn(f32) -> DVec3) -> NewChannel {
        let jumps = ancestry(self.motion.skeleton, self.source_joint()).flat_map(|joint| {
            let tracks = [&self.motion.translations[joint.get()], &self.motion.scales[joint.get()]];
            tracks.into_iter().filter_map(|track| match track {
                Track::Keys { times, channel } if channel.interpolation == Interpolation::Step => Some(*times),
                _ => None,
            })
        });
        let jumps = union(jumps.collect::<Vec<_>>());
        // In the units of the joint's own parent.
        let unit = self.rest_frame().matrix3.x_axis.length().max(1e-12);
        let tolerance = TOLERANCE_OF_HEIGHT * self.hips.height / unit;
        let Resampled { times, values } =
            resample(times, &jumps, tolerance, at, |a: DVec3, b, factor| a.lerp(b, factor), |a, b| a.distance(b));
        NewChannel {
            joint,
            interpolation: Interpolation::Linear,
            times,
            keys: Keys::Translation(values.into_iter().map(DVec3::as_vec3).collect()),
            resampled: true,
        }
    }

    /// Travel, straight, on the joint above the hips.
    fn root_channels(&self, root: JointIndex, travel: &Travel, times: &[f32], turn: Option<&Yaw>) -> Vec<NewChannel> {
        let local = self.alignment.target.locals[root.get()];
        let above = ancestry(self.target_skeleton, root)
            .skip(1)
            .fold(DAffine3::IDENTITY, |frame, joint| self.alignment.target.locals[joint.get()].to_affine() * frame);
        let world_from_above = DAffine3::from_quat(self.alignment.target_turn) * above;
        let along = self.axes(RootPart::Keep) * DVec3::new(1.0, 0.0, 1.0);
        let ends = [times[0], times[times.len() - 1]];
        let position = |time: f32| {
            let step = world_from_above.inverse().transform_vector3(along * travel.at(time));
            (local.translation + step).as_vec3()
        };
        let linear = |joint, times: Vec<f32>, keys, resampled| NewChannel {
            joint,
            interpolation: Interpolation::Linear,
            times,
            keys,
            resampled,
        };
        let end_times = if ends[0] < ends[1] { ends.to_vec() } else { vec![ends[0]] };
        let positions = end_times.iter().map(|&time| position(time)).collect();
        let mut channels = vec![linear(root, end_times, Keys::Translation(positions), false)];
        if let Some(turn) = turn {
            let turned = |&radians: &f64| {
                let frame = crate::retarget::align::rest::unit(DQuat::from_mat3(&orthonormal(&world_from_above)));
                (frame.conjugate() * DQuat::from_rotation_y(radians) * frame * local.rotation).as_quat()
            };
            let rotations = turn.radians.iter().map(turned).collect();
            channels.push(linear(root, turn.times.clone(), Keys::Rotation(rotations), true));
        }
        channels
    }

    /// What the finished clip lacks of the source's travel.
    pub fn removed(&self, laws: &[RotationLaw], times: &[f32]) -> Removed {
        let path = self.path_times();
        let Some(travel) = self.travel(&path) else { return Removed::default() };
        let level = DVec3::new(1.0, 0.0, 1.0);
        let extracted = if self.extracts() { self.axes(RootPart::Keep) * level * travel.slope } else { DVec3::ZERO };
        let taken = |time: f32| {
            let kept = extracted * f64::from(time - travel.first_secs);
            (self.wanted(time) - self.path(&travel, time) - kept) * level
        };
        Removed {
            horizontal: times.iter().map(|&time| (time, taken(time))).collect(),
            yaw: if self.extracts() { None } else { laws[self.top_pair()].yaw.clone() },
        }
    }
}

fn orthonormal(frame: &DAffine3) -> glam::DMat3 {
    let axis = |axis: DVec3| axis.normalize_or_zero();
    glam::DMat3::from_cols(axis(frame.matrix3.x_axis), axis(frame.matrix3.y_axis), axis(frame.matrix3.z_axis))
}

/// Heights of the ground under both figures, for those who look at feet.
pub fn lowest_leg_joint(slots: &Humanoid, positions: &[DVec3]) -> Option<f64> {
    let heights: BTreeMap<Slot, f64> =
        LEGS.iter().filter_map(|&slot| Some((slot, positions[slots.joint(slot)?.get()].y))).collect();
    heights.into_values().reduce(f64::min)
}
