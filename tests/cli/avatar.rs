//! Animations of avatars.

use gaitway_formats::load;

use crate::build_gltf::one;
use crate::data_folder::data_folder;
use crate::program::run;

#[test]
fn expressions_repeat_with_the_loops_of_a_retargeted_clip() {
    let Some(data) = data_folder() else { return };
    let path = |name: &str| data.join(name).to_str().expect("a plain path").to_owned();
    let (avatar, motion) =
        (path("vrm/vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm"), path("vrm/three-vrm_test.vrma"));
    let out = std::env::temp_dir().join(format!("gaitway-loops-{}.vrma", std::process::id()));
    let last_keys = |loops: &str| {
        let arguments = ["retarget", "--model", &avatar, "--motion", &motion, "--loops", loops, "--out"];
        let done = run(&[&arguments[..], &[out.to_str().expect("a plain path")]].concat());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let written = load(&one("out.vrma", std::fs::read(&out).expect("is written"))).expect("is readable");
        std::fs::remove_file(&out).expect("is there");
        let clip = &written.clips[0];
        clip.property_timelines().iter().filter_map(|times| times.last().copied()).fold(0.0, f32::max)
    };
    let (once, twice) = (last_keys("1"), last_keys("2"));
    assert!(once > 0.0 && twice > 1.5 * once, "{once}, {twice}");
}
