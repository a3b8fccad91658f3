//! Spreads the turn of limbs about their own axes over their twist joints, in a finished clip: what a hand turns about the forearm
//! begins at the elbow, and what an upper arm turns in the shoulder ends at the elbow. Skin then turns gradually instead of collapsing
//! at one joint. Everything that isn't a twist joint keeps its rotation in model space, except for upper arms and thighs whose elbow
//! or knee hangs on a twist joint: these leave the turn to it.

use std::f64::consts::PI;

use gaitway_character::anim::{Clip, JointIndex, Keys};
use gaitway_character::sort::sort_by_key;
use glam::{DQuat, DVec3};

use super::Transfer;
use super::rotation::resampled_rotation;
use super::turns::is_free;
use crate::body::{Segment, TwistJoint};
use crate::keys::channel::NewChannel;
use crate::keys::limits::MAX_TURN;
use crate::keys::resample::{Resampled, fewest, union};
use crate::keys::tracks::SourceTracks;
use crate::math::{smooth, unit};
use crate::pose::{WorldPose, node_locals};
use crate::times::dense_times;

/// Smaller turns are left to the joint that has them.
const MIN_TWIST_RADIANS: f64 = 1e-3;

/// From this angle on, the turn is spread less and less: at half a turn, both directions are equally right.
const FADE_RADIANS: f64 = PI * 5.0 / 6.0;

/// The same for limbs that point almost opposite to their rest, where the turn about their axis can jump. Cosines of half the angle.
const FADE_SWING: [f64; 2] = [0.1, 0.3];

/// A segment of the target with its twist joints.
struct TwistedSegment<'a> {
    tracks: &'a SourceTracks<'a>,
    /// When the clip is sampled.
    times: &'a [f32],
    /// The model's own rest: it says where the skin isn't turned.
    rest: &'a WorldPose,
    segment: Segment,
    root: JointIndex,
    tip: JointIndex,
    /// The axis, in the root's frame.
    axis: DVec3,
    /// Between root and tip, from above.
    inside: Vec<TwistJoint>,
    /// Beside it, each after its parent.
    leaves: Vec<TwistJoint>,
}

/// Returns the rotations that change in a clip: of twist joints, and of the joints that they lie between.
pub fn twist_channels(transfer: &Transfer, clip: &Clip) -> Vec<NewChannel> {
    let anatomy = transfer.anatomy;
    if anatomy.twists.is_empty() || clip.channels().is_empty() {
        return Vec::new();
    }
    let nodes = node_locals(transfer.target_skeleton);
    let tracks = SourceTracks::new(transfer.target_skeleton, clip, &[], &nodes);
    let times = dense_times(clip);
    let mut channels = Vec::new();
    for &(segment, [root, tip]) in &anatomy.segments {
        let twists: Vec<TwistJoint> = anatomy.twists_of(segment).copied().collect();
        let is_open =
            |twist: &TwistJoint| is_free(transfer.map, twist.joint) && !tracks.rotations[twist.joint.get()].is_moving();
        let turns = transfer.turns.of(root).is_some() && transfer.turns.of(tip).is_some();
        if turns && !twists.is_empty() && twists.iter().all(is_open) {
            let segment = TwistedSegment::new(transfer, &tracks, &times, segment, [root, tip], twists);
            channels.extend(segment.channels());
        }
    }
    channels
}

impl<'a> TwistedSegment<'a> {
    fn new(
        transfer: &'a Transfer,
        tracks: &'a SourceTracks<'a>,
        times: &'a [f32],
        segment: Segment,
        [root, tip]: [JointIndex; 2],
        twists: Vec<TwistJoint>,
    ) -> Self {
        let rest = &transfer.alignment.unaligned_target;
        let (mut inside, mut leaves): (Vec<_>, Vec<_>) = twists.into_iter().partition(|twist| twist.in_chain);
        sort_by_key(&mut inside, |twist| twist.joint);
        sort_by_key(&mut leaves, |twist| twist.joint);
        Self { tracks, times, rest, segment, root, tip, axis: axis(rest, root, tip), inside, leaves }
    }

    fn local(&self, joint: JointIndex, time_secs: f32) -> DQuat {
        self.tracks.rotation(joint, time_secs)
    }

    /// The joints below the root, down to the tip.
    fn below(&self) -> impl Iterator<Item = JointIndex> {
        self.inside.iter().map(|twist| twist.joint).chain([self.tip])
    }

    /// The rotation from the root's frame to the tip's.
    fn root_from_tip(&self, time_secs: f32) -> DQuat {
        self.below().fold(DQuat::IDENTITY, |above, joint| above * self.local(joint, time_secs))
    }

    fn rest_of(&self, joint: JointIndex) -> DQuat {
        self.rest.locals[joint.get()].rotation
    }

    /// The turn about the axis, as far as it is spread.
    fn twist(&self, time_secs: f32) -> f64 {
        let turn = if self.segment.is_upper {
            self.rest_of(self.root).conjugate() * self.local(self.root, time_secs)
        } else {
            let rest = self.below().fold(DQuat::IDENTITY, |above, joint| above * self.rest_of(joint));
            self.root_from_tip(time_secs) * rest.conjugate()
        };
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let along = turn.xyz().dot(self.axis);
        let radians = 2.0 * along.atan2(turn.w);
        let [none, all] = FADE_SWING;
        let spread = smooth((along.hypot(turn.w) - none) / (all - none));
        radians * spread * smooth((PI - radians.abs()) / (PI - FADE_RADIANS))
    }

    /// How much of the turn the root keeps.
    fn root_share(&self) -> f64 {
        if self.segment.is_upper && self.inside.is_empty() { 1.0 } else { 0.0 }
    }

    /// Shares of the turn of the joints inside: of an upper arm or a thigh, they grow to all of it, since the elbow or knee has it.
    fn inside_shares(&self) -> Vec<f64> {
        let count = self.inside.len() as f64;
        let share = |(at, twist): (usize, &TwistJoint)| match self.segment.is_upper {
            true => (at + 1) as f64 / count,
            false => twist.along,
        };
        self.inside.iter().enumerate().map(share).collect()
    }

    /// As few keys of the turn as restore it by linear interpolation.
    fn keys(&self) -> Resampled<f64> {
        let times = self.times;
        let twists: Vec<f64> = times.iter().map(|&time| self.twist(time)).collect();
        let fits = |from: usize, to: usize| {
            let secs = f64::from(times[to] - times[from]);
            (from + 1..to).all(|at| {
                let share = f64::from(times[at] - times[from]) / secs;
                (twists[from] + share * (twists[to] - twists[from]) - twists[at]).abs() <= MAX_TURN
            })
        };
        let kept = fewest(times.len(), fits);
        Resampled {
            times: kept.iter().map(|&at| times[at]).collect(),
            values: kept.iter().map(|&at| twists[at]).collect(),
        }
    }

    fn channels(&self) -> Vec<NewChannel> {
        let moving: Vec<JointIndex> =
            std::iter::once(self.root).filter(|_| self.segment.is_upper).chain(self.below()).collect();
        let track = |joint: &JointIndex| &self.tracks.rotations[joint.get()];
        let times = union(moving.iter().map(|joint| track(joint).times()));
        let jumps = union(moving.iter().map(|joint| track(joint).jumps()));
        let times = if times.is_empty() { vec![0.0] } else { times };
        let twist = self.keys();
        if twist.values.iter().all(|twist| twist.abs() < MIN_TWIST_RADIANS) {
            return Vec::new();
        }
        // About a fixed axis, rotations are linear in the angle.
        let shared = |joint: JointIndex, at: &dyn Fn(f64) -> DQuat| {
            let rotations = twist.values.iter().map(|&twist| at(twist).as_quat()).collect();
            NewChannel::resampled(joint, twist.times.clone(), Keys::Rotation(rotations))
        };
        let mut channels: Vec<NewChannel> =
            self.leaves.iter().map(|leaf| shared(leaf.joint, &|twist| self.leaf(leaf, twist))).collect();
        // What hangs on a twist joint needs the turn where the clip jumps, too.
        if !self.inside.is_empty() {
            let channel = |joint, at: &dyn Fn(f32) -> DQuat| resampled_rotation(joint, &times, &jumps, at);
            let inside = self.inside.iter().enumerate();
            channels.extend(inside.map(|(at, inside)| channel(inside.joint, &|time| self.inner(at, self.twist(time)))));
            channels.push(channel(self.tip, &|time| self.tip(time)));
            if self.segment.is_upper {
                channels.push(channel(self.root, &|time| self.untwisted_root(time)));
            }
        }
        channels
    }

    /// The rotation that a leaf has from the root's frame for a turn of the segment.
    fn root_from_leaf(&self, leaf: &TwistJoint, twist: f64) -> DQuat {
        let root = self.rest.rotation(self.root);
        let share = leaf.along - self.root_share();
        DQuat::from_axis_angle(self.axis, share * twist) * root.conjugate() * self.rest.rotation(leaf.joint)
    }

    fn leaf(&self, leaf: &TwistJoint, twist: f64) -> DQuat {
        let parent = self.tracks.skeleton.parent(leaf.joint);
        let parent = self.leaves.iter().find(|other| Some(other.joint) == parent);
        let root_from_parent = parent.map_or(DQuat::IDENTITY, |parent| self.root_from_leaf(parent, twist));
        unit(root_from_parent.conjugate() * self.root_from_leaf(leaf, twist))
    }

    /// The local rotation of a joint inside.
    fn inner(&self, at: usize, twist: f64) -> DQuat {
        let shares = self.inside_shares();
        let above = at.checked_sub(1).map_or(0.0, |above| shares[above]);
        let joint = self.inside[at].joint;
        let axis = axis(self.rest, joint, self.tip);
        unit(self.rest_of(joint) * DQuat::from_axis_angle(axis, (shares[at] - above) * twist))
    }

    fn untwisted_root(&self, time_secs: f32) -> DQuat {
        unit(self.local(self.root, time_secs) * DQuat::from_axis_angle(self.axis, -self.twist(time_secs)))
    }

    /// The tip's local rotation, below joints inside that turn: it points where it did.
    fn tip(&self, time_secs: f32) -> DQuat {
        let twist = self.twist(time_secs);
        let inside = (0..self.inside.len()).fold(DQuat::IDENTITY, |above, at| above * self.inner(at, twist));
        let root = if self.segment.is_upper { DQuat::from_axis_angle(self.axis, -twist) } else { DQuat::IDENTITY };
        unit((root * inside).conjugate() * self.root_from_tip(time_secs))
    }
}

/// The direction from one joint to another at rest, in the frame of the first.
fn axis(rest: &WorldPose, from: JointIndex, to: JointIndex) -> DVec3 {
    let along = rest.position(to) - rest.position(from);
    (rest.rotation(from).conjugate() * along).normalize_or(DVec3::Y)
}
