//! Arrays that motion models write: positions, and rotations in every form, with axes in any order.

use gaitway_part::Output;

use crate::glb::Glb;
use crate::numpy::{floats, npz};
use crate::person::{Matrix, Person, Vector, transposed};

const FRAMES: usize = 30;

fn convert(file: &[u8]) -> (Glb, Vec<String>) {
    let Output { bytes, warnings } = gaitway_npz::convert(file).unwrap();
    (Glb::new(&bytes), warnings)
}

fn report(glb: &Glb) -> &str {
    glb.json["asset"]["generator"].as_str().unwrap()
}

/// Returns how far joints are from where the person has them, in the worst frame.
fn error(glb: &Glb, clip: usize, person: &Person, frames_per_sec: f64) -> f64 {
    let mut worst = 0.0_f64;
    for frame in 0..person.frames {
        let time = f64::from((frame as f64 / frames_per_sec) as f32);
        let pose = glb.pose(Some((clip, time)));
        for (world, expected) in pose.worlds.iter().zip(person.positions(frame)) {
            for axis in 0..3 {
                worst = worst.max((world[3][axis] - expected[axis]).abs());
            }
        }
    }
    worst
}

fn shape(sides: &[usize]) -> String {
    format!("({})", sides.iter().map(|side| format!("{side}, ")).collect::<String>())
}

#[test]
fn positions_are_solved_whatever_the_order_of_axes() {
    for joints in [22, 24] {
        let person = Person::new(joints, FRAMES, 0.0);
        let (values, sides) = (person.all_positions(), [FRAMES, joints, 3]);
        for order in [[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 2, 1], [1, 0, 2]] {
            let sides_now = order.map(|axis| sides[axis]);
            let file = floats(&shape(&sides_now), &transposed(&values, &sides, &order));
            let (glb, warnings) = convert(&file);
            let rate = if joints == 22 { 20.0 } else { 30.0 };
            assert!(error(&glb, 0, &person, rate) < 1e-5, "{joints} {order:?}: {}", error(&glb, 0, &person, rate));
            assert!(warnings.len() == 1 && warnings[0].contains(&format!("{rate} frames per second")), "{warnings:?}");
            let said = report(&glb);
            assert!(said.contains(&format!(".npy: positions of {joints} joints in 30 frames")), "{said}");
            assert!(said.contains("off by 0.0 mm on average, 0.0 mm at most") && said.ends_with("Y up"), "{said}");
            assert_eq!(said.contains("stored as"), order != [0, 1, 2], "{said}");
        }
    }
}

#[test]
fn single_axes_and_flat_ones_are_read() {
    let person = Person::new(22, FRAMES, 0.0);
    let expected = gaitway_npz::convert(&floats("(30, 22, 3)", &person.all_positions())).unwrap();
    for shape in ["(1, 30, 22, 3)", "(30, 22, 3, 1)", "(30, 66)", "(30, 1, 66)"] {
        assert_eq!(gaitway_npz::convert(&floats(shape, &person.all_positions())).unwrap(), expected, "{shape}");
    }
    let rate = floats("()", &[60.0]);
    for name in ["posed_joints", "joints", "something_else"] {
        let (glb, warnings) =
            convert(&npz(&[("fps", rate.clone()), (name, floats("(30, 22, 3)", &person.all_positions()))]));
        assert_eq!(warnings, [""; 0]);
        assert!(error(&glb, 0, &person, 60.0) < 1e-5);
    }
}

#[test]
fn people_and_samples_are_clips() {
    let people = [Person::new(22, FRAMES, 0.0), Person::new(22, FRAMES, 0.7), Person::new(22, FRAMES, 2.0)];
    let (values, sides) = (people.each_ref().map(Person::all_positions).concat(), [3, FRAMES, 22, 3]);
    // In order, as MDM's samples, and as InterGen's people.
    for order in [[0, 1, 2, 3], [0, 2, 3, 1], [1, 0, 2, 3]] {
        let sides_now = order.map(|axis| sides[axis]);
        let (glb, _) = convert(&floats(&shape(&sides_now), &transposed(&values, &sides, &order)));
        assert_eq!(glb.list("animations").len(), 3);
        for (clip, person) in people.iter().enumerate() {
            assert_eq!(glb.list("animations")[clip]["name"], format!("Sample {}", clip + 1));
            assert!(error(&glb, clip, person, 20.0) < 1e-5, "{order:?}");
        }
        assert!(report(&glb).contains("3 people or samples"), "{}", report(&glb));
    }
}

/// The bones of motion models vary in length. They get constant lengths, and the report says by how much joints are off.
#[test]
fn bones_keep_their_lengths() {
    let person = Person::new(22, FRAMES, 0.0);
    let mut values = person.all_positions();
    // The left wrist is 2 cm too far from the elbow in every third frame.
    for frame in (0..FRAMES).step_by(3) {
        let at = |joint: usize| (frame * 22 + joint) * 3;
        for axis in 0..3 {
            let bone = values[at(20) + axis] - values[at(18) + axis];
            values[at(20) + axis] += bone * 0.02 / 0.26;
        }
    }
    let (glb, _) = convert(&floats("(30, 22, 3)", &values));
    assert!(error(&glb, 0, &person, 20.0) < 1e-5);
    assert!(report(&glb).contains("20.0 mm at most"), "{}", report(&glb));
}

fn angle(a: &Matrix, b: &Matrix) -> f64 {
    let trace: f64 =
        (0..3).flat_map(|row| (0..3).map(move |column| (row, column))).map(|(r, c)| a[r][c] * b[r][c]).sum();
    ((trace - 1.0) / 2.0).clamp(-1.0, 1.0).acos()
}

/// The rotation of a joint in the world, as rows. Its columns are what the test's evaluator returns.
fn world(glb: &Glb, frame: usize, joint: usize) -> Matrix {
    let world = glb.pose(Some((0, f64::from((frame as f64 / 20.0) as f32)))).worlds[joint];
    std::array::from_fn(|row| std::array::from_fn(|column| world[column][row]))
}

/// Positions don't show how a bone is twisted, but the bend of the next joint does.
#[test]
fn bent_limbs_show_their_twist() {
    let mut person = Person::new(22, FRAMES, 0.0);
    for frame in 0..FRAMES {
        // Around the thigh and the upper arm.
        person.turns[frame][1] = [0.0, 0.6, 0.0];
        person.turns[frame][16] = [0.5, 0.0, 0.0];
        person.turns[frame][4] = [1.2, 0.0, 0.0];
        person.turns[frame][18] = [0.0, -1.2, 0.0];
    }
    let (glb, _) = convert(&floats("(30, 22, 3)", &person.all_positions()));
    for frame in [0, 10, 29] {
        let worlds = person.globals(frame);
        for joint in [1, 16] {
            let off = angle(&world(&glb, frame, joint), &worlds[joint]);
            assert!(off < 0.2, "joint {joint} is off by {off} in frame {frame}");
        }
    }
}

/// While an arm is straight, its bend shows nothing, and just before and after it shows noise. Knees may be overstretched.
#[test]
fn twists_are_smooth() {
    let mut person = Person::new(22, 60, 0.0);
    for frame in 0..60 {
        let swing = (frame as f64 / 60.0 * std::f64::consts::TAU).sin();
        person.turns[frame][18] = [0.0, -0.5 * swing.abs(), 0.02 * (7.0 * frame as f64).sin()];
        person.turns[frame][4] = [0.5 * swing, 0.0, 0.02 * (5.0 * frame as f64).sin()];
    }
    let (glb, _) = convert(&floats("(60, 22, 3)", &person.all_positions()));
    let step = |joint: usize| {
        let steps = (1..60).map(|frame| angle(&world(&glb, frame, joint), &world(&glb, frame - 1, joint)));
        steps.fold(0.0, f64::max)
    };
    for joint in 0..22 {
        assert!(step(joint) < 0.35, "joint {joint} turns by {} in a frame", step(joint));
    }
}

#[test]
fn z_may_be_up_in_positions() {
    let person = Person::new(22, FRAMES, 0.0);
    let z_up: Vec<f64> = person.all_positions().chunks_exact(3).flat_map(|at| [at[0], -at[2], at[1]]).collect();
    let (glb, _) = convert(&floats("(30, 22, 3)", &z_up));
    assert!(error(&glb, 0, &person, 20.0) < 1e-5);
    assert!(report(&glb).ends_with("Z up"), "{}", report(&glb));
}

fn quaternion([x, y, z]: Vector) -> [f64; 4] {
    let angle = (x * x + y * y + z * z).sqrt();
    let part = if angle > 0.0 { (angle / 2.0).sin() / angle } else { 0.5 };
    [(angle / 2.0).cos(), x * part, y * part, z * part]
}

fn sixes(matrix: &Matrix, layout: &str) -> [f64; 6] {
    let [a, b, c] = *matrix;
    match layout {
        "row by row" => [a[0], a[1], b[0], b[1], c[0], c[1]],
        "one column, then another" => [a[0], b[0], c[0], a[1], b[1], c[1]],
        _ => [a[0], a[1], a[2], b[0], b[1], b[2]],
    }
}

/// A person's rotations in every form, with the bones of the file's positions or, without them, of an average adult.
#[test]
fn rotations_are_read_in_every_form() {
    let person = Person::new(22, FRAMES, 0.0);
    let turns = |of: &dyn Fn(Vector) -> Vec<f64>| {
        person.numbers(|frame| person.turns[frame].iter().flat_map(|&turn| of(turn)).collect::<Vec<_>>())
    };
    let matrices = |of: &dyn Fn(&Matrix) -> Vec<f64>| {
        person.numbers(|frame| person.locals(frame).iter().flat_map(of).collect::<Vec<_>>())
    };
    let globals = person.numbers(|frame| person.globals(frame).concat().concat());
    let cases: [(&'static str, usize, Vec<f64>, &str); 8] = [
        ("poses", 3, turns(&|turn| turn.to_vec()), "axis-angle"),
        ("quaternions", 4, turns(&|turn| quaternion(turn).to_vec()), "w first"),
        (
            "rotations",
            4,
            turns(&|turn| {
                let [w, x, y, z] = quaternion(turn);
                vec![x, y, z, w]
            }),
            "w last",
        ),
        ("local_rot_mats", 9, matrices(&|matrix| matrix.concat()), "rotation matrices"),
        ("global_rot_mats", 9, globals, "rotation matrices"),
        ("rot6d", 6, matrices(&|matrix| sixes(matrix, "row by row").to_vec()), "row by row"),
        (
            "rot6d",
            6,
            matrices(&|matrix| sixes(matrix, "one column, then another").to_vec()),
            "one column, then another",
        ),
        ("thetas", 6, matrices(&|matrix| sixes(matrix, "one row, then another").to_vec()), "one row, then another"),
    ];
    let positions = floats("(30, 22, 3)", &person.all_positions());
    let expected = convert(&npz(&[
        ("poses", floats("(30, 66)", &cases[0].2)),
        ("root_positions", person.path_array()),
        ("fps", floats("()", &[20.0])),
    ]));
    for (name, numbers, values, said) in cases {
        let array = floats(&format!("(30, 22, {numbers})"), &values);
        let mut arrays = vec![(name, array), ("root_positions", person.path_array()), ("fps", floats("()", &[20.0]))];
        let (glb, warnings) = convert(&npz(&arrays));
        assert_eq!(warnings, [""; 0], "{name}");
        assert!(report(&glb).contains(said) && report(&glb).contains("average adult"), "{said}: {}", report(&glb));
        for frame in [0, 7, 29] {
            let [found, expected] =
                [&glb, &expected.0].map(|glb| glb.pose(Some((0, f64::from((frame as f64 / 20.0) as f32)))).worlds);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((0..3).all(|axis| (found[3][axis] - expected[3][axis]).abs() < 1e-5), "{name} {said}");
            }
        }
        arrays.push(("posed_joints", positions.clone()));
        let (glb, _) = convert(&npz(&arrays));
        assert!(report(&glb).contains(said) && report(&glb).contains("bones from the positions"), "{}", report(&glb));
        assert!(error(&glb, 0, &person, 20.0) < 1e-5, "{name} {said}: {}", error(&glb, 0, &person, 20.0));
    }
}

/// As HY-Motion has it: the positions stay where the pelvis rests, and the path is separate.
#[test]
fn positions_may_lack_the_path() {
    let mut person = Person::new(22, FRAMES, 0.0);
    let (path, rest) = (person.path.clone(), [0.0, -0.25, 0.03]);
    person.path.fill(rest);
    let positions = person.all_positions();
    person.path.iter_mut().zip(&path).for_each(|(at, from)| *at = std::array::from_fn(|axis| from[axis] + rest[axis]));
    let rotations = person.numbers(|frame| {
        person.locals(frame).iter().flat_map(|matrix| sixes(matrix, "row by row")).collect::<Vec<_>>()
    });
    let (glb, _) = convert(&npz(&[
        ("rot6d", floats("(1, 30, 22, 6)", &rotations)),
        ("transl", floats("(1, 30, 3)", &path.concat())),
        ("keypoints3d", floats("(1, 30, 22, 3)", &positions)),
    ]));
    assert!(error(&glb, 0, &person, 30.0) < 1e-5, "{}", error(&glb, 0, &person, 30.0));
}

/// Some tools write zeros for unknown positions, which aren't to be taken for bones.
#[test]
fn zeros_are_no_positions() {
    let person = Person::new(22, FRAMES, 0.0);
    let turns = person.numbers(|frame| person.turns[frame].concat());
    let arrays =
        [("poses", floats("(30, 22, 3)", &turns)), ("trans", person.path_array()), ("fps", floats("()", &[20.0]))];
    let zeros = ("keypoints3d", floats("(30, 22, 3)", &[0.0; 30 * 66]));
    let with_zeros = [&arrays[..], &[zeros]].concat();
    assert_eq!(gaitway_npz::convert(&npz(&with_zeros)), gaitway_npz::convert(&npz(&arrays)));
}

/// A still body doesn't show which way its knees bend.
#[test]
fn what_rotations_leave_open_is_said() {
    let identity = [[1.0, 0.0, 0.0, 0.0, 1.0, 0.0]; 2 * 22].concat();
    let (_, warnings) = convert(&npz(&[
        ("rot6d", floats("(2, 22, 6)", &identity)),
        ("trans", floats("(2, 3)", &[0.0, 1.17, 0.0, 0.0, 1.17, 0.0])),
        ("fps", floats("()", &[30.0])),
    ]));
    assert!(warnings.len() == 1 && warnings[0].contains("rows are assumed"), "{warnings:?}");
}

/// As Kimodo writes it, with the bones of the positions.
#[test]
fn soma_has_the_bones_of_its_positions() {
    let person = Person::soma(FRAMES);
    let locals = floats("(30, 77, 3, 3)", &person.numbers(|frame| person.locals(frame).concat().concat()));
    let globals = floats("(30, 77, 3, 3)", &person.numbers(|frame| person.globals(frame).concat().concat()));
    let positions = ("posed_joints", floats("(30, 77, 3)", &person.all_positions()));
    let root = ("root_positions", person.path_array());
    for rotations in [("local_rot_mats", locals.clone()), ("global_rot_mats", globals)] {
        let (glb, warnings) = convert(&npz(&[positions.clone(), rotations, root.clone()]));
        assert!(error(&glb, 0, &person, 30.0) < 1e-5, "{}", error(&glb, 0, &person, 30.0));
        assert!(warnings.len() == 1 && warnings[0].contains("30 frames per second"), "{warnings:?}");
        for (index, name) in
            [(0, "Hips"), (14, "LeftHand"), (38, "LeftHandPinkyEnd"), (47, "RightHandIndex1"), (76, "RightToeEnd")]
        {
            assert_eq!(glb.node(name), index);
        }
    }
    let problem = gaitway_npz::convert(&npz(&[("local_rot_mats", locals), root])).unwrap_err();
    assert!(
        problem.contains("77 joints of SOMA") && problem.contains("expected an array \"posed_joints\""),
        "{problem}"
    );
}
