//! One body as solids, part by part, with points on its limbs at places that correspond to those of any other.

use std::f64::consts::TAU;

use gaitway_character::anim::JointIndex;
use glam::{DQuat, DVec3};

use super::solid::{Place, Solid};
use crate::feet::{Sole, Soles};
use crate::pose::WorldPose;

/// Points on each part of a limb: heights along its axis and directions about it.
const RINGS: usize = 4;
const SECTORS: usize = 6;
pub const POINTS: usize = RINGS * SECTORS;

/// Where the parts of a body are: the positions of their joints, and their rotations away from the aligned rest.
pub type Frames = Vec<(DVec3, DQuat)>;

/// One side of the retarget. All lists are by part.
#[derive(Debug, Default)]
pub struct Body {
    pub joints: Vec<JointIndex>,
    pub solids: Vec<Solid>,
    /// Rotations of the joints at the aligned rest.
    pub rest: Vec<DQuat>,
    /// Points of the limbs' parts, relative to their joints at the aligned rest.
    pub points: Vec<[DVec3; POINTS]>,
    /// Whether each hand holds something, as in [`Region::arm`](super::parts::Region::arm).
    pub is_holding: [bool; 2],
    /// Whether any solid is fitted to vertices.
    pub has_mesh: bool,
    /// From the lowest to the highest mapped joint, in the body's own unit.
    pub height: f64,
    /// How far kneecaps are in front of their joints: the mean of both, since a solid alone is off by more than knees differ.
    pub knee_radius: f64,
    pub soles: Soles,
}

impl Body {
    pub fn frames(&self, pose: &WorldPose) -> Frames {
        let frame =
            |(&joint, &rest): (&JointIndex, &DQuat)| (pose.position(joint), pose.rotation(joint) * rest.conjugate());
        self.joints.iter().zip(&self.rest).map(frame).collect()
    }

    /// The joints that its motion needs.
    pub fn moving_joints(&self) -> impl Iterator<Item = JointIndex> {
        self.joints.iter().copied().chain(self.soles.feet.iter().flatten().flat_map(Sole::joints))
    }

    /// Where a point of a limb is.
    pub fn point(&self, part: usize, point: usize, frames: &Frames) -> DVec3 {
        let (position, turn) = frames[part];
        position + turn * self.points[part][point]
    }

    pub fn surface(&self, part: usize, place: Place, frames: &Frames) -> DVec3 {
        let (position, turn) = frames[part];
        position + turn * self.solids[part].surface(place)
    }

    /// How high the lowest point of a knee is: of a disc across the beginning of its shin.
    pub fn knee(&self, shin: usize, frames: &Frames) -> f64 {
        let (position, turn) = frames[shin];
        let steepness = (turn * self.solids[shin].axis).y;
        position.y - self.knee_radius * (1.0 - steepness * steepness).max(0.0).sqrt()
    }

    /// The direction away from a part's axis.
    pub fn outward(&self, part: usize, place: Place, frames: &Frames) -> DVec3 {
        frames[part].1 * self.solids[part].outward(place)
    }
}

/// A body at some times.
#[derive(Debug, Default)]
pub struct BodyMotion {
    pub frames: Vec<Frames>,
    /// Heights of the soles' lowest points, by foot.
    pub soles: Vec<Vec<f64>>,
}

impl BodyMotion {
    /// Adds the pose of one more time.
    pub fn push(&mut self, body: &Body, pose: &WorldPose) {
        self.frames.push(body.frames(pose));
        self.soles.resize_with(body.soles.feet.iter().flatten().count(), Vec::new);
        for (heights, sole) in self.soles.iter_mut().zip(body.soles.feet.iter().flatten()) {
            heights.push(sole.lowest(pose));
        }
    }
}

/// Where a point of a limb is on the surface of its part.
pub fn place_of(point: usize) -> Place {
    let share = ((point / SECTORS) as f64 + 0.5) / RINGS as f64;
    Place { share, angle: TAU * (point % SECTORS) as f64 / SECTORS as f64 }
}
