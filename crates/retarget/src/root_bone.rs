//! Moves the travel of a body from its hips to a root joint above them, so that both together stand, turn and move exactly as the
//! hips did.
//!
//! The root stands on the ground below the hips and faces where they face: it has their horizontal travel and their turn about the
//! vertical axis, both from the rest. Between keys, two joints that move don't add up to one that does, so keys are added until
//! the sum is within [`MAX_TURN`] and [`MAX_SHARE`].

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, JointIndex, Keys, Pose, Property, SampleCursor, Skeleton, Transform,
};
use glam::{DAffine3, DQuat, DVec3};

use crate::keys::channel::continuous;
use crate::keys::limits::{ROUNDING, height_or_metre};
use crate::keys::resample::{Curve, Resampled, resample, union};
use crate::math::{angle_between, slerp, yaw_of};

/// How far, in radians, root and hips together may turn away from the hips: 0.01°.
const MAX_TURN: f64 = 1.745e-4;
/// How far they may move away, as a share of the hips' distance from the root at rest: 0.01 mm per metre.
const MAX_SHARE: f64 = 1e-5;

/// What a root joint takes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RootTravel {
    /// Height as well, not only the path over the ground.
    pub vertical: bool,
    /// Drops the travel: the body stays where it is at rest.
    pub in_place: bool,
}

/// Why travel can't be moved to a root joint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RootError {
    /// Something above the root moves.
    #[error("clip “{clip}” already moves “{joint}”, which is above the hips")]
    AboveMoves {
        /// Name of the clip.
        clip: String,
        /// Label of the joint.
        joint: String,
    },
    /// The hips are in a space that is mirrored, or stretched differently along its axes.
    #[error("a joint above the hips is mirrored or has scales that differ by axis, so no root bone can carry them")]
    Stretched,
}

/// Returns a clip with the travel of the `hips` on their parent, the `root`, which rests without a transform and which the clip
/// doesn't animate.
///
/// # Errors
/// If a joint above the root moves, or mirrors or stretches its space.
pub fn with_root_motion(
    skeleton: &Skeleton,
    clip: &Clip,
    hips: JointIndex,
    root: JointIndex,
    travel: RootTravel,
) -> Result<Clip, RootError> {
    let is_of_hips = |joint: JointIndex, property: Property| {
        joint == hips && matches!(property, Property::Translation | Property::Rotation)
    };
    let space = Space::above(skeleton, clip, root)?;
    let mut builder = ClipBuilder::new(clip.name(), skeleton);
    let mut own = ClipBuilder::new("", skeleton);
    for channel in clip.channels() {
        let of_hips = is_of_hips(channel.joint, channel.keys.property());
        let into = if of_hips { &mut own } else { &mut builder };
        let times_secs = &clip.timelines()[channel.timeline as usize];
        // What one clip holds, another one for the same skeleton does as well.
        let _ = into.channel(channel.joint, channel.interpolation, times_secs, channel.keys.clone());
    }
    let own = own.build();
    let sampled = (SampleCursor::default(), skeleton.rest().clone());
    let mut split = Split { own: &own, skeleton, hips, travel, space, sampled };
    let is_stepped = own.channels().iter().all(|channel| channel.interpolation == Interpolation::Step);
    let Resampled { times, values } = split.keys(is_stepped);
    if !times.is_empty() {
        let interpolation = if is_stepped { Interpolation::Step } else { Interpolation::Linear };
        let mut add = |joint, parts: Vec<Local>| {
            let turns = continuous(parts.iter().map(|part| part.turn));
            let places = Keys::Translation(parts.iter().map(|part| part.place.as_vec3()).collect());
            for keys in [places, turns] {
                let _ = builder.channel(joint, interpolation, &times, keys);
            }
        };
        if !travel.in_place {
            add(root, values.iter().map(|parts| parts.root).collect());
        }
        add(hips, values.iter().map(|parts| parts.hips).collect());
    }
    Ok(builder.build().with_properties_of(clip, &Some))
}

/// Where a joint is and how it is turned, without its scale.
#[derive(Clone, Copy)]
struct Local {
    turn: DQuat,
    place: DVec3,
}

impl Local {
    fn of(local: Transform) -> Self {
        Self { turn: local.rotation.as_dquat().normalize(), place: local.translation.as_dvec3() }
    }

    fn after(self, parent: Self) -> Self {
        Self { turn: parent.turn * self.turn, place: parent.turn * self.place + parent.place }
    }

    fn seen_from(self, parent: Self) -> Self {
        let back = parent.turn.conjugate();
        Self { turn: back * self.turn, place: back * (self.place - parent.place) }
    }

    fn between(self, other: Self, share: f64) -> Self {
        Self { turn: slerp(self.turn, other.turn, share), place: self.place.lerp(other.place, share) }
    }
}

/// The space that root and hips are in.
#[derive(Clone, Copy)]
struct Space {
    model_from_space: DAffine3,
    turn: DQuat,
}

impl Space {
    fn above(skeleton: &Skeleton, clip: &Clip, root: JointIndex) -> Result<Self, RootError> {
        let mut model_from_space = DAffine3::IDENTITY;
        let mut above = skeleton.parent(root);
        while let Some(joint) = above {
            let moves = |property| !matches!(property, Property::MorphWeights);
            if clip.channels().iter().any(|channel| channel.joint == joint && moves(channel.keys.property())) {
                let (clip, joint) = (clip.name().to_owned(), skeleton.label(joint));
                return Err(RootError::AboveMoves { clip, joint });
            }
            let Transform { scale, rotation, translation } = skeleton.rest().local(joint);
            let (scale, rotation) = (scale.as_dvec3(), rotation.as_dquat().normalize());
            let is_even = (scale - DVec3::splat(scale.x)).length() <= 1e-4 * scale.length();
            if !is_even || scale.x <= 0.0 {
                return Err(RootError::Stretched);
            }
            let local = DAffine3::from_scale_rotation_translation(scale, rotation, translation.as_dvec3());
            model_from_space = local * model_from_space;
            above = skeleton.parent(joint);
        }
        let (_, turn, _) = model_from_space.to_scale_rotation_translation();
        Ok(Self { model_from_space, turn })
    }
}

/// Where the hips are, and the two joints that put them there.
#[derive(Clone, Copy)]
struct Parts {
    whole: Local,
    root: Local,
    hips: Local,
}

struct Split<'a> {
    /// The channels of the hips alone.
    own: &'a Clip,
    skeleton: &'a Skeleton,
    hips: JointIndex,
    travel: RootTravel,
    space: Space,
    /// Where the clip is sampled, reused from time to time.
    sampled: (SampleCursor, Pose),
}

impl Split<'_> {
    /// The hips as the clip has them.
    fn at(&mut self, time_secs: f32) -> Local {
        let (cursor, pose) = &mut self.sampled;
        self.own.sample(self.skeleton, time_secs, cursor, pose);
        Local::of(pose.local(self.hips))
    }

    fn parts(&mut self, time_secs: f32) -> Parts {
        let whole = self.at(time_secs);
        let root = self.root(whole);
        Parts { whole, root, hips: whole.seen_from(root) }
    }

    /// The root below hips that are there.
    fn root(&self, hips: Local) -> Local {
        let Space { model_from_space, turn } = self.space;
        let rest = Local::of(self.skeleton.rest().local(self.hips));
        let of_model = |local: Local| (model_from_space.transform_point3(local.place), turn * local.turn);
        let ((at, facing), (rest_at, rest_facing)) = (of_model(hips), of_model(rest));
        let turned = facing * rest_facing.conjugate();
        let yaw = DQuat::from_rotation_y(yaw_of(turned));
        let mut travel = at - yaw * rest_at;
        if !self.travel.vertical {
            travel.y = 0.0;
        }
        let moved = DAffine3::from_rotation_translation(yaw, travel);
        let local = model_from_space.inverse() * moved * model_from_space;
        Local { turn: (turn.conjugate() * yaw * turn).normalize(), place: local.translation }
    }

    /// Keys at the clip's own and, unless it is stepped, between them where that is needed.
    fn keys(&mut self, is_stepped: bool) -> Resampled<Parts> {
        let own = self.own;
        let timelines = own.timelines();
        let times = union(timelines.iter().map(Vec::as_slice));
        if is_stepped {
            let values = times.iter().map(|&time_secs| self.parts(time_secs)).collect();
            return Resampled { times, values };
        }
        let stepped = own.channels().iter().filter(|channel| channel.interpolation == Interpolation::Step);
        let jumps = union(stepped.map(|channel| timelines[channel.timeline as usize].as_slice()));
        let reach = self.skeleton.rest().local(self.hips).translation.as_dvec3().length();
        // The larger error, as a share of what is allowed.
        let error = |from: &Parts, to: &Parts, factor: f64, at: &Parts| {
            let found = from.hips.between(to.hips, factor).after(from.root.between(to.root, factor));
            let turn = angle_between(found.turn, at.whole.turn);
            let allowed = (MAX_SHARE * height_or_metre(reach)).max(ROUNDING * at.whole.place.length());
            (turn / MAX_TURN).max(found.place.distance(at.whole.place) / allowed)
        };
        resample(&times, &jumps, Curve { value: |time_secs: f32| self.parts(time_secs), error, tolerance: 1.0 })
    }
}
