//! What a file means.

use gaitway_part::Output;

use crate::glb::Glb;
use crate::numpy::{array, floats, npy, npz, person, stored};

fn convert(file: &[u8]) -> (Glb, Vec<String>) {
    let Output { bytes, warnings } = gaitway_npz::convert(file).unwrap();
    (Glb::new(&bytes), warnings)
}

fn clean(file: &[u8]) -> Glb {
    let (glb, warnings) = convert(file);
    assert_eq!(warnings, [""; 0]);
    glb
}

/// A joint's position at a time of the clip.
fn position(glb: &Glb, name: &str, time: Option<f64>) -> [f64; 3] {
    let world = glb.pose(time.map(|time| (0, time))).worlds[glb.node(name)];
    [world[3][0], world[3][1], world[3][2]]
}

#[track_caller]
fn near(found: [f64; 3], expected: [f64; 3]) {
    for axis in 0..3 {
        assert!((found[axis] - expected[axis]).abs() < 1e-5, "{found:?} instead of {expected:?}");
    }
}

/// Replaces an array, or adds it.
fn with(mut arrays: Vec<(&'static str, Vec<u8>)>, name: &'static str, bytes: Vec<u8>) -> Vec<(&'static str, Vec<u8>)> {
    arrays.retain(|(other, _)| *other != name);
    arrays.push((name, bytes));
    arrays
}

#[test]
fn joints_turn_and_the_pelvis_moves() {
    let glb = clean(&npz(&person(22)));
    assert_eq!(glb.duration(0), f64::from(0.1_f32));
    near(position(&glb, "pelvis", Some(0.0)), [0.0, 0.95, 0.0]);
    near(position(&glb, "pelvis", Some(0.1)), [0.5, 1.05, 1.0]);
    // Halfway the knee is bent by half of it: what hangs down swings towards -Z.
    let knee = position(&glb, "left_knee", Some(0.05));
    let (sin, cos) = 0.5_f64.sin_cos();
    near(position(&glb, "left_ankle", Some(0.05)), {
        let (y, z) = (-0.40, -0.04);
        [knee[0] - 0.01, knee[1] + cos * y - sin * z, knee[2] + sin * y + cos * z]
    });
    // Only joints that turn have keys.
    assert_eq!(glb.list("animations")[0]["channels"].as_array().unwrap().len(), 3);
}

#[test]
fn the_person_stands_at_rest() {
    let glb = clean(&npz(&person(22)));
    let [toes, head, hand] = ["left_foot", "head", "left_wrist"].map(|name| position(&glb, name, None));
    assert!((0.0..0.05).contains(&toes[1]), "feet are on the ground: {toes:?}");
    assert!((1.4..1.7).contains(&head[1]), "{head:?}");
    assert!((hand[1] - 1.45).abs() < 0.1 && hand[0] > 0.6, "a T-pose: {hand:?}");
    assert!(toes[2] > 0.05, "toes point ahead: {toes:?}");
    let [x, y, z] = hand;
    near(position(&glb, "right_wrist", None), [-x, y, z]);
}

#[test]
fn bodies_have_hands_fingers_and_faces() {
    for (joints, names) in [
        (24, &["left_hand", "right_hand"][..]),
        (52, &["left_index1", "left_thumb3", "right_index1", "right_pinky2"]),
        (55, &["jaw", "right_eye_smplhf", "left_middle1", "right_thumb3"]),
    ] {
        let glb = clean(&npz(&person(joints)));
        assert_eq!(glb.list("nodes").len(), joints);
        for name in names {
            glb.node(name);
        }
    }
    // In the files' order, of which the tables of SMPL+H are an independent record: 22 to 36 left, 37 to 51 right.
    let glb = clean(&npz(&person(52)));
    for (index, name) in
        [(22, "left_index1"), (28, "left_pinky1"), (34, "left_thumb1"), (37, "right_index1"), (51, "right_thumb3")]
    {
        assert_eq!(glb.node(name), index);
    }
}

#[test]
fn z_may_be_up() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut poses = vec![0.0; 2 * 66];
    (poses[0], poses[66]) = (quarter, quarter);
    let arrays = with(person(22), "poses", floats("(2, 66)", &poses));
    let arrays = with(arrays, "trans", floats("(2, 3)", &[0.0, 0.22, 0.92, 1.0, 2.22, 1.92]));
    let glb = clean(&npz(&arrays));
    near(position(&glb, "pelvis", Some(0.0)), [0.0, 0.95, 0.0]);
    near(position(&glb, "pelvis", Some(0.1)), [1.0, 1.95, -2.0]);
    let [_, rest, _] = position(&glb, "head", None);
    near(position(&glb, "head", Some(0.0)), [0.0, rest, position(&glb, "head", None)[2]]);
}

/// A body that lies on its back: its pelvis isn't turned, and would stand 1.2 m in the ground if Y were up.
#[test]
fn a_person_may_lie() {
    let lying = with(person(22), "poses", floats("(2, 66)", &[0.0; 132]));
    let at = |[x, y, z]: [f64; 3]| floats("(2, 3)", &[x, y, z, x, y, z]);
    let glb = clean(&npz(&with(lying.clone(), "trans", at([2.0, 0.0, 0.15]))));
    near(position(&glb, "pelvis", Some(0.0)), [2.0, 0.18, 0.22]);
    let [_, head, _] = position(&glb, "head", Some(0.0));
    assert!(head < 0.3, "{head}");
    // The same far from the origin shows neither.
    let (_, warnings) = convert(&npz(&with(lying, "trans", at([0.0, -3.0, 4.0]))));
    assert!(warnings.len() == 1 && warnings[0].contains("Y is assumed"), "{warnings:?}");
}

#[test]
fn groups_are_joined_in_the_order_of_the_joints() {
    let mut joints = [0.0; 2 * 66];
    joints[66 + 3 * 4] = 1.0;
    let rows = |from: usize, to: usize| [&joints[from..to], &joints[66 + from..66 + to]].concat();
    let whole = npz(&person(22));
    let others: Vec<_> = person(22).into_iter().filter(|(name, _)| *name != "poses").collect();
    for [root, body] in [["root_orient", "pose_body"], ["global_orient", "body_pose"]] {
        let mut arrays = others.clone();
        arrays.push((root, floats("(2, 3)", &rows(0, 3))));
        arrays.push((body, floats("(2, 63)", &rows(3, 66))));
        assert_eq!(gaitway_npz::convert(&npz(&arrays)), gaitway_npz::convert(&whole));
        arrays.push(("left_hand_pose", floats("(2, 45)", &[0.0; 90])));
        arrays.push(("right_hand_pose", floats("(2, 15, 3)", &[0.1; 90])));
        let glb = clean(&npz(&arrays));
        assert_eq!(glb.list("animations")[0]["channels"].as_array().unwrap().len(), 3 + 15, "right fingers turn");
    }
}

#[test]
fn arrays_of_any_layout_are_equal() {
    let expected = gaitway_npz::convert(&npz(&person(22)));
    assert_eq!(gaitway_npz::convert(&stored(&person(22))), expected);
    let rate = |bytes: Vec<u8>| npz(&with(person(22), "mocap_framerate", bytes));
    for (descr, data) in [
        ("<f4", 10_f32.to_le_bytes().to_vec()),
        (">f8", 10_f64.to_be_bytes().to_vec()),
        ("<i8", 10_i64.to_le_bytes().to_vec()),
        (">i2", 10_i16.to_be_bytes().to_vec()),
        ("|u1", vec![10]),
    ] {
        assert_eq!(gaitway_npz::convert(&rate(array(descr, "(1,)", &data))), expected, "{descr}");
    }
    let by_columns = [0.0, 0.5, 1.17, 1.27, -0.03, 0.97];
    let data: Vec<u8> = by_columns.iter().flat_map(|value: &f64| value.to_le_bytes()).collect();
    let fortran = npy("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", &data);
    assert_eq!(gaitway_npz::convert(&npz(&with(person(22), "trans", fortran))), expected);
    // As Python 2 wrote it on 64-bit Windows.
    let long = npy("{'descr': '<f8', 'fortran_order': True, 'shape': (2L, 3L), }", &data);
    assert_eq!(gaitway_npz::convert(&npz(&with(person(22), "trans", long))), expected);
}

#[test]
fn half_floats_are_read() {
    // Python: numpy.float16([0.5, 2, 16, 6e-8, 1.333, -0.0]).
    let bits = [0x3800_u16, 0x4000, 0x4C00, 0x0001, 0x3D55, 0x8000];
    let data: Vec<u8> = bits.iter().flat_map(|bits| bits.to_le_bytes()).collect();
    let glb = clean(&npz(&with(person(22), "trans", array("<f2", "(2, 3)", &data))));
    near(position(&glb, "pelvis", Some(0.0)), [0.5, 1.78, 16.03]);
    near(position(&glb, "pelvis", Some(0.1)), [5.96e-8, 1.33301 - 0.22, 0.03]);
    let infinite: Vec<u8> = [0x7C00_u16; 6].iter().flat_map(|bits| bits.to_be_bytes()).collect();
    let file = npz(&with(person(22), "trans", array(">f2", "(2, 3)", &infinite)));
    assert!(gaitway_npz::convert(&file).unwrap_err().contains("inf in frame 0"));
}

/// The arrays of a person under other names and with other sides.
fn laid_out(name: &'static str, shape: &str, trans: (&'static str, &str)) -> Vec<u8> {
    let mut poses = [0.0; 2 * 66];
    poses[66 + 3 * 4] = 1.0;
    let kept = person(22).into_iter().filter(|(other, _)| !["poses", "trans"].contains(other));
    let path = [0.0, 1.17, -0.03, 0.5, 1.27, 0.97];
    npz(&kept.chain([(name, floats(shape, &poses)), (trans.0, floats(trans.1, &path))]).collect::<Vec<_>>())
}

#[test]
fn other_names_and_a_batch_of_one_are_equal() {
    let expected = gaitway_npz::convert(&npz(&person(22)));
    for name in ["poses", "pose", "fullpose", "smpl_poses"] {
        for shape in ["(2, 66)", "(2, 22, 3)", "(1, 2, 66)", "(2, 1, 66)", "(1, 2, 22, 3)", "(2, 1, 22, 3)"] {
            for trans in [("trans", "(2, 3)"), ("transl", "(1, 2, 3)"), ("smpl_trans", "(2, 1, 3)")] {
                assert_eq!(gaitway_npz::convert(&laid_out(name, shape, trans)), expected, "{name} {shape} {trans:?}");
            }
        }
    }
}

/// In units of the body that it scales: what is in metres is what remains.
#[test]
fn the_path_is_scaled() {
    let scaled = [0.0, 1.17, -0.03, 0.5, 1.27, 0.97].map(|value| 90.0 * value);
    let arrays = with(with(person(22), "trans", floats("(2, 3)", &scaled)), "smpl_scaling", floats("(1,)", &[90.0]));
    let glb = clean(&npz(&arrays));
    near(position(&glb, "pelvis", Some(0.1)), [0.5, 1.05, 1.0]);
}

#[test]
fn rotation_matrices_are_read_row_by_row() {
    let (sin, cos) = 1_f64.sin_cos();
    let (still, knee) = ([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos]);
    let mut matrices = [still; 2 * 22];
    matrices[22 + 4] = knee;
    let rows = |from: usize, to: usize| [&matrices[from..to], &matrices[22 + from..22 + to]].concat().concat();
    let expected = clean(&npz(&person(22)));
    let check = |arrays: &[(&'static str, Vec<u8>)]| {
        let glb = clean(&npz(arrays));
        for name in ["left_ankle", "left_foot", "head"] {
            near(position(&glb, name, Some(0.1)), position(&expected, name, Some(0.1)));
        }
    };
    for shape in ["(2, 22, 3, 3)", "(1, 2, 22, 3, 3)", "(2, 22, 9)", "(2, 198)"] {
        check(&with(person(22), "poses", floats(shape, &rows(0, 22))));
    }
    let others: Vec<_> = person(22).into_iter().filter(|(name, _)| *name != "poses").collect();
    for (root, body) in
        [("(2, 3, 3)", "(2, 21, 3, 3)"), ("(2, 1, 3, 3)", "(2, 189)"), ("(1, 2, 1, 3, 3)", "(1, 2, 21, 3, 3)")]
    {
        let arrays = with(others.clone(), "global_orient", floats(root, &rows(0, 1)));
        check(&with(arrays, "body_pose", floats(body, &rows(1, 22))));
    }
}

#[test]
fn negative_integers_are_read() {
    let data = [-1_i8, 2, -128, 127, 0, 1].map(|value| value as u8);
    // That body is in the ground, which is said.
    let (glb, _) = convert(&npz(&with(person(22), "trans", array("|i1", "(2, 3)", &data))));
    near(position(&glb, "pelvis", Some(0.1)), [127.0, -0.22, 1.03]);
}

#[test]
fn what_is_missing_is_said() {
    let without = |name: &str| npz(&person(22).into_iter().filter(|(other, _)| *other != name).collect::<Vec<_>>());
    let (glb, warnings) = convert(&without("trans"));
    assert!(warnings[0].contains("trans") && warnings.len() == 1, "{warnings:?}");
    near(position(&glb, "pelvis", Some(0.1)), [0.0, 0.95, 0.0]);
    let (glb, warnings) = convert(&without("mocap_framerate"));
    assert!(warnings[0].contains("30 frames per second") && warnings.len() == 1, "{warnings:?}");
    assert_eq!(glb.duration(0), f64::from((1.0_f64 / 30.0) as f32));
    // AIST++ has no rates, but a scaling that nothing else has.
    let arrays = with(person(22), "smpl_scaling", floats("(1,)", &[1.0]));
    let arrays: Vec<_> = arrays.into_iter().filter(|(name, _)| *name != "mocap_framerate").collect();
    let (glb, warnings) = convert(&npz(&arrays));
    assert!(warnings[0].contains("60 frames per second") && warnings.len() == 1, "{warnings:?}");
    assert_eq!(glb.duration(0), f64::from((1.0_f64 / 60.0) as f32));
}
