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

#[test]
fn motions() {
    check_array("poses", floats("(2, 67)", &[0.0; 134]), &["axis times angle", "[2, 67]"]);
    check_array("poses", floats("(2, 63)", &[0.0; 126]), &["22, 24, 52 or 55 joints", "found 21"]);
    check_array("poses", floats("(1, 22, 3, 4)", &[0.0; 264]), &["axis times angle", "[1, 22, 3, 4]"]);
    check_array("poses", floats("(2, 2, 22, 3)", &[0.0; 264]), &["axis times angle", "[2, 2, 22, 3]"]);
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
    check_array("mocap_framerate", floats("(2,)", &[1.0, 2.0]), &["frames per second", "[1.0, 2.0]"]);
    let groups = |frames: &str, body: &[f64]| {
        npz(&[("root_orient", floats("(2, 3)", &[0.0; 6])), ("pose_body", floats(&format!("({frames}, 63)"), body))])
    };
    let rootless = [("root_orient", floats("(2, 0)", &[])), ("pose_body", floats("(2, 66)", &[0.0; 132]))];
    check(&npz(&rootless), &["\"root_orient\"", "one joint", "found 0"]);
    check(&groups("1", &[0.0; 63]), &["\"pose_body\"", "2 frames", "found 1"]);
}
