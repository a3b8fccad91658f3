//! Files that can't be read: each error says where, what was expected and what was found.

use crate::numpy::{array, floats, npy, npz, person};

#[track_caller]
fn check(file: &[u8], expected: &[&str]) {
    let problem = gaitway_npz::convert(file).unwrap_err();
    for part in expected {
        assert!(problem.contains(part), "“{part}” is not in: {problem}");
    }
    assert!(problem.contains("expected ") && problem.ends_with('.'), "{problem}");
}

/// A person of whose arrays one is replaced.
#[track_caller]
fn check_array(name: &'static str, bytes: Vec<u8>, expected: &[&str]) {
    let mut arrays: Vec<_> = person(22).into_iter().filter(|(other, _)| *other != name).collect();
    arrays.push((name, bytes));
    check(&npz(&arrays), &[&[name][..], expected].concat());
}

#[test]
fn archives() {
    check(b"", &["zip archive", "found none"]);
    let whole = npz(&person(22));
    check(&whole[..whole.len() / 2], &["damaged", "zip archive"]);
    check(&npz(&[]), &["\"poses\"", "found nothing"]);
    check(
        &npz(&[("betas", floats("(10,)", &[0.0; 10])), ("verts", floats("(0,)", &[]))]),
        &["\"root_orient\"", "betas, verts"],
    );
    let orient = ("root_orient", floats("(2, 3)", &[0.0; 6]));
    check(&npz(&[orient]), &["\"pose_body\"", "found root_orient"]);
}

#[test]
fn arrays() {
    check_array("poses", b"not an array".to_vec(), &["a NumPy header", "12 other bytes"]);
    check_array(
        "poses",
        npy("{'descr': '|O', 'fortran_order': False, 'shape': (), }", b"\x80\x04."),
        &["pickled", "numpy.savez"],
    );
    check_array("poses", array("<c8", "(1,)", &[0; 8]), &["<c8", "numpy.float32"]);
    check_array("poses", array("<f1", "(1,)", &[0; 1]), &["<f1"]);
    check_array("poses", npy("{'descr': [('x', '<f4')], 'shape': (1,), }", &[0; 4]), &["expected numbers"]);
    check_array("poses", npy("{'descr': '<f8'}", &[]), &["a shape"]);
    check_array("poses", array("<f8", "(2, -66)", &[]), &["a shape"]);
    check_array("poses", array("<f8", "(2, 66)", &[0; 8]), &["[2, 66] numbers of 8 bytes", "found 8 bytes"]);
    check_array("poses", array("<f8", "(99999999999, 99999999999)", &[]), &["numbers of 8 bytes"]);
    check_array(
        "poses",
        array("|i1", "(40000000,)", &vec![0; 40_000_000]),
        &["at most 33554432 numbers", "found 40000000"],
    );
}

/// A `.npy`, and arrays whose names mean nothing.
#[test]
fn arrays_that_hold_something_else() {
    assert_eq!(
        gaitway_npz::convert(&floats("(10, 5)", &[0.0; 50])).unwrap_err(),
        "the array: expected positions (frames × 22, 24, 30, 52, 55 or 77 joints × 3) or rotations (× 3, 4, 6 or 3 × 3), \
         found [10, 5]. Save the motion as the joints' positions, or as the arrays of AMASS."
    );
    check(&floats("(2, 22, 4)", &[0.3; 176]), &["quaternions of length 1", "another in frame 0"]);
    check(&floats("(2, 22, 6)", &[0.3; 264]), &["pairs of axes", "another in frame 0"]);
    // However many frames they have: 17 joints are those of another body.
    for frames in [66, 72, 88, 90, 100, 120] {
        let numbers: Vec<f64> = (0..frames * 17 * 3).map(|at| (at as f64).sin()).collect();
        check(&floats(&format!("({frames}, 17, 3)"), &numbers), &["22, 24", &format!("found [{frames}, 17, 3]")]);
    }
    check(&array("|O", "()", b"\x80\x04N."), &["the array", "pickled", "results.npy", "numpy.save("]);
    check(&floats("(2, 22, 3)", &[f64::NAN; 132]), &["finite numbers", "NaN in frame 0"]);
    check(&floats("(0, 22, 3)", &[]), &["at least one frame"]);
    check(&npz(&[("betas", floats("(2, 22, 4)", &[0.3; 176]))]), &["\"posed_joints\"", "found betas"]);
    let noise: Vec<f64> = (0..40 * 66).map(|place| (1e4 * f64::from(place).sin()).fract()).collect();
    check(
        &npz(&[("joints", floats("(40, 22, 3)", &noise))]),
        &["\"joints\"", "order of SMPL or SOMA", "bones that change"],
    );
    check(
        &npz(&[("joints", floats("(2, 17, 3)", &[0.0; 102]))]),
        &["\"joints\"", "expected positions (frames", "[2, 17, 3]"],
    );
}

#[test]
fn motions() {
    check_array("poses", floats("(2, 67)", &[0.0; 134]), &["expected rotations (frames", "[2, 67]"]);
    check_array("poses", floats("(2, 63)", &[0.0; 126]), &["22, 24, 30, 52, 55 or 77 joints", "found [2, 63]"]);
    check_array("poses", floats("(1, 22, 5, 7)", &[0.0; 770]), &["expected rotations (frames", "[1, 22, 5, 7]"]);
    check_array("poses", floats("(2, 2, 2, 22, 3)", &[0.0; 528]), &["expected rotations (frames", "[2, 2, 2, 22, 3]"]);
    check_array("poses", floats("(300, 2, 22, 3)", &[0.0; 39_600]), &["at most 256 people or samples", "found 300"]);
    check_array("poses", floats("(1, 22, 3, 3)", &[0.0; 198]), &["rotations", "another in frame 0"]);
    check_array(
        "poses",
        floats("(1, 22, 3, 3)", &[[0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]; 22].concat()),
        &["rotations"],
    );
    check_array("smpl_scaling", floats("(1,)", &[0.0]), &["above 0"]);
    check_array("poses", floats("(0, 66)", &[]), &["at least one frame"]);
    let mut poses = [0.0; 132];
    poses[100] = f64::NAN;
    check_array("poses", floats("(2, 66)", &poses), &["finite", "NaN in frame 1"]);
    check_array("trans", floats("(3, 3)", &[0.0; 9]), &["[2, 3]", "[3, 3]"]);
    check_array("trans", floats("(2, 3)", &[f64::INFINITY; 6]), &["inf in frame 0"]);
    check_array("trans", floats("(2, 3)", &[1e300; 6]), &["finite numbers", "in frame 0"]);
    for rate in [0.0, -1.0, 1e-40, f64::NAN] {
        check_array("mocap_framerate", floats("()", &[rate]), &["frames per second"]);
    }
    check_array("mocap_framerate", floats("(2,)", &[1.0, 2.0]), &["frames per second", "found [2]"]);
    let groups = |frames: &str, body: &[f64]| {
        npz(&[("root_orient", floats("(2, 3)", &[0.0; 6])), ("pose_body", floats(&format!("({frames}, 63)"), body))])
    };
    let rootless = [("root_orient", floats("(2, 0)", &[])), ("pose_body", floats("(2, 66)", &[0.0; 132]))];
    check(&npz(&rootless), &["\"root_orient\"", "1 joint", "found [2, 0]"]);
    check(&groups("1", &[0.0; 63]), &["\"pose_body\"", "2 frames", "found 1"]);
}
