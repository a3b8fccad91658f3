//! Conversion from a file's own unit and axes to metres and Y up. A BVH states neither; both are guessed from its skeleton, a
//! warning names the guess, and [`LoadOptions`] overrides it.
//!
//! Unit: the distance from fingertip to toe along the bones is about one and a half times a person's height, in any pose. The
//! unit in common use that brings the height closest to 1.7 m (as a ratio) wins; rarer units have to come closer. Up axis: Z if
//! the rest pose is at least half as tall again along Z as along Y, and the first, middle and last frames are taller along Z
//! too. The rest pose alone is not enough: some lay all bones along one axis.

use gaitway_character::asset::{Warning, Warnings};
use glam::{DQuat, DVec3, Quat, Vec3};

use super::hierarchy::Hierarchy;
use super::motion::Frames;
use crate::LoadOptions;

/// From fingertip to toe along the bones.
const PATH_PER_HEIGHT: f64 = 1.5;
const LIKELY_HEIGHT_METRES: f64 = 1.7;
const REST_RATIO_OF_Z_UP: f64 = 1.5;

struct Unit {
    name: &'static str,
    metres: f64,
    /// Handicap of a rarer unit.
    rarity: f64,
}

const UNITS: [Unit; 5] = [
    Unit { name: "centimetres", metres: 0.01, rarity: 1.0 },
    Unit { name: "metres", metres: 1.0, rarity: 1.0 },
    Unit { name: "millimetres", metres: 0.001, rarity: 1.1 },
    Unit { name: "inches", metres: 0.0254, rarity: 1.25 },
    // The Carnegie Mellon motion capture database: inches divided by 0.45.
    Unit { name: "units of 5.64 cm (as the CMU database has them)", metres: 0.0254 / 0.45, rarity: 1.6 },
];

/// Converts the file's values to the viewer's units and axes.
pub struct FrameOfReference {
    unit_metres: f64,
    z_up: bool,
}

impl FrameOfReference {
    pub fn find(
        hierarchy: &Hierarchy,
        motion: Option<&Frames>,
        options: &LoadOptions,
        warnings: &mut Warnings,
    ) -> Self {
        let mut warn = |code, problem: String| {
            warnings.push(Warning::Other { code, place: "HIERARCHY".to_owned(), problem });
        };
        let given = options.bvh_unit_metres.map(f64::from).filter(|unit| unit.is_finite() && *unit > 0.0);
        let unit_metres = given.unwrap_or_else(|| {
            let height = hierarchy.longest_path() / PATH_PER_HEIGHT;
            let Some(unit) = likely_unit(height) else { return 1.0 };
            let metres = height * unit.metres;
            let name = unit.name;
            warn(
                "unit-guessed",
                format!("BVH files state no unit: assuming {name}, which makes a person about {metres:.2} m tall"),
            );
            unit.metres
        });
        let z_up = options.bvh_z_up.unwrap_or_else(|| {
            let guess = is_z_up(hierarchy, motion);
            if guess {
                warn(
                    "up-axis-guessed",
                    "BVH files state no up axis: this skeleton stands along Z, so Z is taken as up".to_owned(),
                );
            }
            guess
        });
        Self { unit_metres, z_up }
    }

    /// Converts a position or an offset to metres.
    pub fn point(&self, point: DVec3) -> Vec3 {
        let point = point * self.unit_metres;
        (if self.z_up { DVec3::new(point.x, point.z, -point.y) } else { point }).as_vec3()
    }

    /// Converts a rotation to the viewer's axes.
    pub fn rotation(&self, rotation: DQuat) -> Quat {
        let DQuat { x, y, z, w } = rotation;
        (if self.z_up { DQuat::from_xyzw(x, z, -y, w) } else { rotation }).as_quat().normalize()
    }
}

/// `None` if there is nothing to measure.
fn likely_unit(height: f64) -> Option<&'static Unit> {
    if !(height > 0.0 && height.is_finite()) {
        return None;
    }
    let distance = |unit: &Unit| (height * unit.metres / LIKELY_HEIGHT_METRES).ln().abs() + unit.rarity.ln();
    UNITS.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

fn is_z_up(hierarchy: &Hierarchy, motion: Option<&Frames>) -> bool {
    let rest = extent(hierarchy, None);
    if rest.z <= REST_RATIO_OF_Z_UP * rest.y {
        return false;
    }
    let Some(motion) = motion else { return true };
    let last = motion.frame_count - 1;
    [0, last / 2, last].into_iter().all(|frame| {
        let posed = extent(hierarchy, Some(motion.frame(frame)));
        posed.z > posed.y
    })
}

/// Size of the bounding box of all joints and End Sites, at rest or in one frame.
fn extent(hierarchy: &Hierarchy, numbers: Option<&[f64]>) -> DVec3 {
    let (mut min, mut max) = (DVec3::MAX, DVec3::MIN);
    let mut include = |point: DVec3| {
        min = min.min(point);
        max = max.max(point);
    };
    let mut placed: Vec<(DVec3, DQuat)> = Vec::with_capacity(hierarchy.joints.len());
    let mut first = 0;
    for joint in &hierarchy.joints {
        let channels = first..first + joint.channels.len();
        first = channels.end;
        let (at, turn) = match numbers.and_then(|numbers| numbers.get(channels)) {
            Some(numbers) => (joint.position(numbers), joint.rotation(numbers)),
            None => (joint.offset, DQuat::IDENTITY),
        };
        let (origin, parent_turn) = joint.parent.map_or((DVec3::ZERO, DQuat::IDENTITY), |parent| placed[parent]);
        let place = (origin + parent_turn * at, parent_turn * turn);
        include(place.0);
        placed.push(place);
    }
    for &(joint, offset) in &hierarchy.ends {
        include(placed[joint].0 + placed[joint].1 * offset);
    }
    max - min
}
