//! The skeletons of SMPL bodies, with the proportions of an average adult, and of SOMA, whose proportions are the file's.

use gaitway_glb::{Glb, Object, numbers};
use glam::DVec3;

/// Position of the pelvis of an SMPL body at rest, relative to where `trans` puts the body.
pub const PELVIS: DVec3 = DVec3::new(0.0, -0.22, 0.03);

/// Height of the pelvis while the person stands at rest on the ground.
const STANDING: f64 = 0.95;

/// The numbers of joints that SMPL bodies have: SMPL without and with hands, SMPL+H, SMPL-X.
pub const SMPL: [usize; 4] = [22, 24, 52, 55];

/// The numbers of joints that SOMA has: what Kimodo computes with, and what it writes.
pub const SOMA: [usize; 2] = [30, 77];

/// A joint's name, its parent and its position relative to that, in metres.
struct Row(&'static str, usize, [f64; 3]);

/// The joints that all SMPL bodies have.
const BODY: [Row; 22] = [
    Row("pelvis", 0, [0.0, STANDING, 0.0]),
    Row("left_hip", 0, [0.07, -0.09, -0.01]),
    Row("right_hip", 0, [-0.07, -0.09, -0.01]),
    Row("spine1", 0, [0.0, 0.12, -0.03]),
    Row("left_knee", 1, [0.04, -0.38, 0.0]),
    Row("right_knee", 2, [-0.04, -0.38, 0.0]),
    Row("spine2", 3, [0.0, 0.14, 0.02]),
    Row("left_ankle", 4, [-0.01, -0.40, -0.04]),
    Row("right_ankle", 5, [0.01, -0.40, -0.04]),
    Row("spine3", 6, [0.0, 0.06, 0.0]),
    Row("left_foot", 7, [0.03, -0.06, 0.12]),
    Row("right_foot", 8, [-0.03, -0.06, 0.12]),
    Row("neck", 9, [0.0, 0.21, -0.03]),
    Row("left_collar", 9, [0.08, 0.11, -0.02]),
    Row("right_collar", 9, [-0.08, 0.11, -0.02]),
    Row("head", 12, [0.0, 0.09, 0.05]),
    Row("left_shoulder", 13, [0.10, 0.04, -0.01]),
    Row("right_shoulder", 14, [-0.10, 0.04, -0.01]),
    Row("left_elbow", 16, [0.26, -0.01, -0.03]),
    Row("right_elbow", 17, [-0.26, -0.01, -0.03]),
    Row("left_wrist", 18, [0.25, 0.01, 0.0]),
    Row("right_wrist", 19, [-0.25, 0.01, 0.0]),
];

const HEAD: usize = 15;
const WRISTS: [usize; 2] = [20, 21];

const HANDS: [Row; 2] =
    [Row("left_hand", WRISTS[0], [0.08, -0.01, -0.01]), Row("right_hand", WRISTS[1], [-0.08, -0.01, -0.01])];

const FACE: [Row; 3] = [
    Row("jaw", HEAD, [0.0, 0.0, 0.02]),
    Row("left_eye_smplhf", HEAD, [0.03, 0.06, 0.06]),
    Row("right_eye_smplhf", HEAD, [-0.03, 0.06, 0.06]),
];

/// Fingers in the order of the files, each with the position of its first joint relative to the left wrist, and of the other two
/// relative to the previous joint.
const FINGERS: [(&str, [f64; 3], [f64; 3]); 5] = [
    ("index", [0.10, 0.0, 0.02], [0.03, 0.0, 0.0]),
    ("middle", [0.10, 0.0, 0.0], [0.03, 0.0, 0.0]),
    ("pinky", [0.08, -0.01, -0.04], [0.02, 0.0, 0.0]),
    ("ring", [0.09, 0.0, -0.02], [0.03, 0.0, 0.0]),
    ("thumb", [0.04, -0.01, 0.03], [0.02, 0.0, 0.02]),
];

/// SOMA's joints in the order of the files, with the directions of their bones at rest, a T-pose. Those whose name begins with `+` are
/// only in the larger skeleton. Fingers follow the hand; a limb is written for the left side. The names and parents are those of
/// `SOMASkeleton77` and `SOMASkeleton30` in Kimodo's `skeleton/definitions.py`.
const TORSO: [Row; 11] = [
    Row("Hips", 0, [0.0, 1.0, 0.0]),
    Row("Spine1", 0, [0.0, 1.0, 0.0]),
    Row("Spine2", 1, [0.0, 1.0, 0.0]),
    Row("Chest", 2, [0.0, 1.0, -0.1]),
    Row("Neck1", 3, [0.0, 1.0, 0.0]),
    Row("Neck2", 4, [0.0, 1.0, 0.3]),
    Row("Head", 5, [0.0, 1.0, 0.3]),
    Row("+HeadEnd", 6, [0.0, 1.0, 0.0]),
    Row("Jaw", 6, [0.0, 0.1, 1.0]),
    Row("LeftEye", 6, [0.35, 0.6, 1.0]),
    Row("RightEye", 6, [-0.35, 0.6, 1.0]),
];
const ARM: [Row; 4] = [
    Row("Shoulder", 3, [0.3, 1.0, 0.1]),
    Row("Arm", 0, [1.0, 0.0, 0.0]),
    Row("ForeArm", 1, [1.0, 0.0, 0.0]),
    Row("Hand", 2, [1.0, 0.0, 0.0]),
];
const LEG: [Row; 5] = [
    Row("Leg", 0, [1.0, -0.4, 0.0]),
    Row("Shin", 0, [0.0, -1.0, 0.0]),
    Row("Foot", 1, [0.0, -1.0, 0.0]),
    Row("ToeBase", 2, [0.0, -0.4, 1.0]),
    Row("+ToeEnd", 3, [0.0, 0.0, 1.0]),
];
/// The name, how many joints there are, and the direction of the first one and of the others.
const SOMA_FINGERS: [(&str, usize, [f64; 3], [f64; 3]); 5] = [
    ("Thumb", 4, [0.7, 0.0, 0.7], [0.7, 0.0, 0.7]),
    ("Index", 5, [1.0, 0.0, 0.3], [1.0, 0.0, 0.0]),
    ("Middle", 5, [1.0, 0.0, 0.1], [1.0, 0.0, 0.0]),
    ("Ring", 5, [1.0, 0.0, -0.1], [1.0, 0.0, 0.0]),
    ("Pinky", 5, [1.0, 0.0, -0.3], [1.0, 0.0, 0.0]),
];

/// A joint of a skeleton.
#[derive(Clone, PartialEq, Debug)]
pub struct Joint {
    pub name: String,
    /// An earlier joint; of the first one, itself.
    pub parent: usize,
    /// The position relative to the parent at rest, in metres.
    pub offset: DVec3,
}

/// The joints of a body, parents before children.
#[derive(Clone)]
pub struct Skeleton {
    pub joints: Vec<Joint>,
    /// Knees and elbows, and the axes that they bend around.
    pub hinges: Vec<(usize, DVec3)>,
}

impl Skeleton {
    /// Returns the skeleton with that many joints, one of [`SMPL`] or [`SOMA`]. Of SOMA's bones, only the directions are right.
    pub fn of(count: usize) -> Skeleton {
        let mut skeleton = Skeleton { joints: Vec::new(), hinges: Vec::new() };
        if SOMA.contains(&count) {
            skeleton.add_soma(count == 77);
        } else {
            skeleton.add_smpl(count);
        }
        let hinges = [("knee", DVec3::X), ("Shin", DVec3::X), ("elbow", DVec3::NEG_Y), ("ForeArm", DVec3::NEG_Y)];
        for (index, joint) in skeleton.joints.iter().enumerate() {
            let hinge = hinges.iter().find(|(name, _)| joint.name.ends_with(name));
            let mirrored =
                |axis: DVec3| if joint.name.starts_with(['r', 'R']) { DVec3::new(axis.x, -axis.y, 0.0) } else { axis };
            skeleton.hinges.extend(hinge.map(|&(_, axis)| (index, mirrored(axis))));
        }
        skeleton
    }

    fn add(&mut self, name: impl Into<String>, parent: usize, offset: [f64; 3]) -> usize {
        self.joints.push(Joint { name: name.into(), parent, offset: offset.into() });
        self.joints.len() - 1
    }

    fn add_smpl(&mut self, count: usize) {
        let more: &[Row] = match count {
            24 => &HANDS,
            55 => &FACE,
            _ => &[],
        };
        for &Row(name, parent, offset) in BODY.iter().chain(more) {
            self.add(name, parent, offset);
        }
        if count <= 24 {
            return;
        }
        for (side, wrist, sign) in [("left", WRISTS[0], 1.0), ("right", WRISTS[1], -1.0)] {
            for (finger, first, next) in FINGERS {
                let mut parent = wrist;
                for (place, [x, y, z]) in [first, next, next].into_iter().enumerate() {
                    parent = self.add(format!("{side}_{finger}{}", place + 1), parent, [sign * x, y, z]);
                }
            }
        }
    }

    fn add_soma(&mut self, is_whole: bool) {
        // The larger skeleton has one more joint above the jaw, and nothing refers to those after it.
        for &Row(name, parent, offset) in &TORSO {
            self.add_row(is_whole, "", name, parent, offset);
        }
        for (side, sign) in [("Left", 1.0), ("Right", -1.0)] {
            let first = self.joints.len();
            for (place, &Row(name, parent, [x, y, z])) in ARM.iter().enumerate() {
                let parent = if place == 0 { parent } else { first + parent };
                self.add_row(is_whole, side, name, parent, [sign * x, y, z]);
            }
            self.add_soma_fingers(is_whole, side, DVec3::new(sign, 1.0, 1.0));
        }
        for (side, sign) in [("Left", 1.0), ("Right", -1.0)] {
            let first = self.joints.len();
            for (place, &Row(name, parent, [x, y, z])) in LEG.iter().enumerate() {
                let parent = if place == 0 { 0 } else { first + parent };
                self.add_row(is_whole, side, name, parent, [sign * x, y, z]);
            }
        }
    }

    /// Adds the fingers of the hand that was added last. The smaller skeleton has the ends of two of them. `mirror` scales
    /// the directions, which are given for the left side.
    fn add_soma_fingers(&mut self, is_whole: bool, side: &str, mirror: DVec3) {
        let hand = self.joints.len() - 1;
        for (finger, count, first, next) in SOMA_FINGERS {
            let end = format!("{side}Hand{finger}End");
            let [first, next] = [first, next].map(|direction| (mirror * DVec3::from(direction)).to_array());
            if is_whole {
                let mut parent = self.add(format!("{side}Hand{finger}1"), hand, first);
                for place in 2..count {
                    parent = self.add(format!("{side}Hand{finger}{place}"), parent, next);
                }
                self.add(end, parent, next);
            } else if ["Thumb", "Middle"].contains(&finger) {
                self.add(end, hand, first);
            }
        }
    }

    fn add_row(&mut self, is_whole: bool, side: &str, name: &str, parent: usize, offset: [f64; 3]) {
        match name.strip_prefix('+') {
            Some(name) if is_whole => _ = self.add(format!("{side}{name}"), parent, offset),
            Some(_) => (),
            None => _ = self.add(format!("{side}{name}"), parent, offset),
        }
    }

    /// Returns the children of a joint.
    pub fn children(&self, parent: usize) -> Vec<usize> {
        (1..self.joints.len()).filter(|&child| self.joints[child].parent == parent).collect()
    }

    /// Places the first joint so that the body stands on the ground at rest.
    pub fn stand(&mut self) {
        let mut lowest = 0.0_f64;
        let mut placed = vec![DVec3::ZERO];
        for joint in &self.joints[1..] {
            let at = placed[joint.parent] + joint.offset;
            lowest = lowest.min(at.y);
            placed.push(at);
        }
        self.joints[0].offset = DVec3::new(0.0, -lowest, 0.0);
    }

    /// Writes the nodes; a joint's index is its node's.
    pub fn write(&self, glb: &mut Glb) {
        for (index, joint) in self.joints.iter().enumerate() {
            let children = self.children(index);
            let mut node = Object::new().with("name", joint.name.as_str());
            if !children.is_empty() {
                node.set("children", children);
            }
            node.set("translation", numbers(&joint.offset.to_array()));
            glb.nodes.push(node.into());
        }
        glb.scene_roots.push(0);
    }
}
