//! The skeleton of SMPL bodies, with the proportions of an average adult.

use gaitway_glb::{Glb, Object, numbers};
use glam::DVec3;

/// Position of the pelvis at rest, relative to where `trans` puts the body.
pub const PELVIS: DVec3 = DVec3::new(0.0, -0.22, 0.03);

/// Height of the pelvis while the person stands at rest on the ground.
pub const STANDING: f64 = 0.95;

/// A joint's name, its parent and its position relative to that, in metres.
struct Joint(&'static str, usize, [f64; 3]);

/// The joints that all bodies have. The first one has no parent.
const BODY: [Joint; 22] = [
    Joint("pelvis", 0, [0.0, STANDING, 0.0]),
    Joint("left_hip", 0, [0.07, -0.09, -0.01]),
    Joint("right_hip", 0, [-0.07, -0.09, -0.01]),
    Joint("spine1", 0, [0.0, 0.12, -0.03]),
    Joint("left_knee", 1, [0.04, -0.38, 0.0]),
    Joint("right_knee", 2, [-0.04, -0.38, 0.0]),
    Joint("spine2", 3, [0.0, 0.14, 0.02]),
    Joint("left_ankle", 4, [-0.01, -0.40, -0.04]),
    Joint("right_ankle", 5, [0.01, -0.40, -0.04]),
    Joint("spine3", 6, [0.0, 0.06, 0.0]),
    Joint("left_foot", 7, [0.03, -0.06, 0.12]),
    Joint("right_foot", 8, [-0.03, -0.06, 0.12]),
    Joint("neck", 9, [0.0, 0.21, -0.03]),
    Joint("left_collar", 9, [0.08, 0.11, -0.02]),
    Joint("right_collar", 9, [-0.08, 0.11, -0.02]),
    Joint("head", 12, [0.0, 0.09, 0.05]),
    Joint("left_shoulder", 13, [0.10, 0.04, -0.01]),
    Joint("right_shoulder", 14, [-0.10, 0.04, -0.01]),
    Joint("left_elbow", 16, [0.26, -0.01, -0.03]),
    Joint("right_elbow", 17, [-0.26, -0.01, -0.03]),
    Joint("left_wrist", 18, [0.25, 0.01, 0.0]),
    Joint("right_wrist", 19, [-0.25, 0.01, 0.0]),
];

const HEAD: usize = 15;
const WRISTS: [usize; 2] = [20, 21];

const HANDS: [Joint; 2] =
    [Joint("left_hand", WRISTS[0], [0.08, -0.01, -0.01]), Joint("right_hand", WRISTS[1], [-0.08, -0.01, -0.01])];

const FACE: [Joint; 3] = [
    Joint("jaw", HEAD, [0.0, 0.0, 0.02]),
    Joint("left_eye_smplhf", HEAD, [0.03, 0.06, 0.06]),
    Joint("right_eye_smplhf", HEAD, [-0.03, 0.06, 0.06]),
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

/// The numbers of joints that bodies have: SMPL without and with hands, SMPL+H, SMPL-X.
pub const JOINT_COUNTS: [usize; 4] = [22, 24, 52, 55];

/// Iterates over the joints that all bodies have: the parent, and the position relative to it.
pub fn bones() -> impl Iterator<Item = (usize, DVec3)> {
    BODY.iter().map(|&Joint(_, parent, offset)| (parent, offset.into()))
}

/// Writes the nodes; a joint's index is its node's. `count` is one of [`JOINT_COUNTS`].
pub fn write(count: usize, glb: &mut Glb) {
    let named = |Joint(name, parent, offset): &Joint| ((*name).to_owned(), *parent, *offset);
    let mut joints: Vec<(String, usize, [f64; 3])> = BODY.iter().map(named).collect();
    match count {
        24 => joints.extend(HANDS.iter().map(named)),
        55 => joints.extend(FACE.iter().map(named)),
        _ => (),
    }
    if count > 24 {
        add_fingers("left", WRISTS[0], 1.0, &mut joints);
        add_fingers("right", WRISTS[1], -1.0, &mut joints);
    }
    for (index, (name, _, offset)) in joints.iter().enumerate() {
        let children: Vec<usize> = (1..joints.len()).filter(|&child| joints[child].1 == index).collect();
        let mut node = Object::new().with("name", name.as_str());
        if !children.is_empty() {
            node.set("children", children);
        }
        node.set("translation", numbers(offset));
        glb.nodes.push(node.into());
    }
    glb.scene_roots.push(0);
}

/// Adds the fingers of a hand. `sign` is −1 for the right hand, which mirrors the left one.
fn add_fingers(side: &str, wrist: usize, sign: f64, joints: &mut Vec<(String, usize, [f64; 3])>) {
    for (finger, first, next) in FINGERS {
        let mut parent = wrist;
        for (place, [x, y, z]) in [first, next, next].into_iter().enumerate() {
            joints.push((format!("{side}_{finger}{}", place + 1), parent, [sign * x, y, z]));
            parent = joints.len() - 1;
        }
    }
}
