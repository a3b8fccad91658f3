//! BVH: invalid files first, then behaviour, then real files.

use gaitway_character::anim::{Interpolation, JointIndex, Keys, SampleCursor, model_from_joint};
use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, LoadError, LoadOptions, load, load_named, load_with, main_files};
use glam::{Affine3A, Quat, Vec3};

use crate::allocations::allocations_after;
use crate::build_gltf::one;
use crate::data_folder::data_folder;
use crate::examples::TWO_JOINTS;

const METRES: LoadOptions = LoadOptions { bvh_unit_metres: Some(1.0), bvh_z_up: Some(false), awaits_images: false };

fn read_bvh(text: &str) -> Result<Asset, LoadError> {
    load_with(&one("walk.bvh", text.as_bytes().to_vec()), &METRES)
}

fn codes(asset: &Asset) -> Vec<&'static str> {
    asset.warnings.iter().map(|warning| warning.code()).collect()
}

/// World transforms of all joints at a time, in the file's order.
fn world(asset: &Asset, time_secs: f32) -> Vec<Affine3A> {
    let mut pose = asset.skeleton.rest().clone();
    if let Some(clip) = asset.clips.first() {
        clip.sample(&asset.skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    }
    let mut world = vec![Affine3A::IDENTITY; asset.skeleton.len()];
    model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut world);
    (0..world.len()).map(|index| world[asset.skeleton.joint_of_source(index).expect("in range").get()]).collect()
}

fn rotations(asset: &Asset, joint: &str) -> Vec<Quat> {
    let joint = asset.skeleton.find(joint).expect("a joint");
    let keys = asset.clips[0].channels().iter().find_map(|channel| match &channel.keys {
        Keys::Rotation(keys) if channel.joint == joint => Some(keys.clone()),
        _ => None,
    });
    keys.expect("rotation keys")
}

#[test]
fn invalid_files_are_rejected_with_file_line_expected_and_found() {
    // Text, replacement, the line that the message names, and part of what it expected.
    let cases: [(&str, &str, &str, &str); 19] = [
        ("HIERARCHY", "HIERARCHIE", "line 1", "HIERARCHY"),
        ("ROOT hip\n{", "ROOT hip\n", "line 4", "{"),
        ("ROOT hip", "JOINT hip", "line 2", "ROOT"),
        ("OFFSET 0 1 0", "OFFSET 0 1", "line 5", "three finite numbers"),
        ("OFFSET 0 1 0", "OFFSET 0 1 0 7", "line 4", "CHANNELS"),
        ("OFFSET 0 1 0", "OFFSET 0 nan 0", "line 4", "finite"),
        ("OFFSET 0 1 0", "OFFSET 0 1e39 0", "OFFSET of joint 0", "32 bits"),
        ("CHANNELS 6", "CHANNELS six", "line 5", "number of channels"),
        ("CHANNELS 6", "CHANNELS 4000000000", "line 5", "number of channels"),
        ("CHANNELS 6 Xposition", "CHANNELS 6 Wposition", "line 5", "Xposition"),
        ("CHANNELS 3 X", "CHANNELS 3 Yrotation CHANNELS 2 X", "line 9", "a channel"),
        ("OFFSET 0 -0.5 0.5", "CHANNELS 1 Xrotation", "line 12", "End Site"),
        ("\t}\n}\nMOTION", "\t}\nMOTION", "line 15", "}"),
        ("Frame Time: 0.5\n", "", "line 18", "Frame Time"),
        ("Frame Time: 0.5", "Frame Time: soon", "line 18", "Frame Time"),
        ("Frame Time: 0.5", "Frame Time: 0", "line 18", "above 0"),
        ("Frame Time: 0.5", "Frame Time: 1e300", "line 18", "key times"),
        ("1 2 3 90 0", "1 2 3 ninety 0", "line 20, number 4", "finite number"),
        ("0 1 0 0 0 0 0 0 0\n", "0 1 0 0 0 0 0 0\n", "line 20", "9 numbers"),
    ];
    for (good, bad, place, expected) in cases {
        assert!(TWO_JOINTS.contains(good), "{good}");
        let text = TWO_JOINTS.replacen(good, bad, 1);
        let problem = read_bvh(&text).err().unwrap_or_else(|| panic!("{bad:?} was read")).to_string();
        for part in ["walk.bvh", place, expected] {
            assert!(problem.contains(part), "{bad:?}: no {part:?} in {problem:?}");
        }
    }
    for text in ["", "HIERARCHY", "HIERARCHY\nMOTION\nFrames: 0\nFrame Time: 1\n", "\u{FEFF}"] {
        assert!(read_bvh(text).is_err(), "{text:?} was read");
    }
}

#[test]
fn a_file_loads_as_in_other_programs() {
    let asset = read_bvh(TWO_JOINTS).expect("readable");
    let skeleton = &asset.skeleton;
    let (hip, leg) = (JointIndex(0), JointIndex(1));
    assert_eq!((asset.format, skeleton.len(), asset.clips.len()), ("bvh", 2, 1));
    assert_eq!((skeleton.name(hip), skeleton.name(leg), skeleton.parent(leg)), ("hip", "leg", Some(hip)));
    assert_eq!((skeleton.source_index(hip), skeleton.source_index(leg)), (0, 1));
    let rest = |joint: JointIndex| skeleton.rest().local(joint);
    assert_eq!((rest(hip).translation, rest(leg).translation), (Vec3::Y, Vec3::new(0.5, -1.0, 0.0)));
    assert_eq!((rest(hip).rotation, rest(leg).rotation), (Quat::IDENTITY, Quat::IDENTITY));
    let clip = &asset.clips[0];
    assert_eq!((clip.name(), clip.duration_secs(), clip.timelines()), ("walk", 0.5, &[vec![0.0, 0.5]][..]));
    assert!(clip.channels().iter().all(|channel| channel.interpolation == Interpolation::Linear));
    // The hip translates and rotates, the leg only rotates: its OFFSET stays.
    assert_eq!(clip.channels().len(), 3);
    let degrees = |degrees: f32| degrees.to_radians();
    let leg_turn = Quat::from_rotation_x(degrees(30.0))
        * Quat::from_rotation_y(degrees(40.0))
        * Quat::from_rotation_z(degrees(50.0));
    assert!(rotations(&asset, "leg")[1].abs_diff_eq(leg_turn, 1e-6));
    // Rotated by 90° about Z, the leg's offset points along +Y and +X: (0.5, −1) becomes (1, 0.5).
    let at = world(&asset, 0.5);
    assert!(at[0].translation.abs_diff_eq(glam::Vec3A::new(1.0, 2.0, 3.0), 1e-6));
    assert!(at[1].translation.abs_diff_eq(glam::Vec3A::new(2.0, 2.5, 3.0), 1e-6));
    assert_eq!(codes(&asset), [""; 0]);
}

#[test]
fn rotations_multiply_in_channel_order() {
    let about = |letter: char, degrees: f32| match letter {
        'X' => Quat::from_rotation_x(degrees.to_radians()),
        'Y' => Quat::from_rotation_y(degrees.to_radians()),
        _ => Quat::from_rotation_z(degrees.to_radians()),
    };
    for order in ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "ZXZ"] {
        let names: Vec<String> = order.chars().map(|letter| format!("{letter}rotation")).collect();
        let text = TWO_JOINTS.replace("Xrotation Yrotation Zrotation\n", &format!("{}\n", names.join(" ")));
        let expected = order.chars().zip([30.0, 40.0, 50.0]).map(|(letter, degrees)| about(letter, degrees));
        let expected = expected.fold(Quat::IDENTITY, |product, turn| product * turn);
        let found = rotations(&read_bvh(&text).expect("readable"), "leg")[1];
        assert!(found.dot(expected).abs() > 1.0 - 1e-6, "{order}: {found} is not {expected}");
    }
}

#[test]
fn harmless_deviations_load_with_a_warning() {
    // Text, replacement, and the resulting warnings.
    let cases: [(&str, &str, &[&str]); 23] = [
        ("\n", "\r\n", &[]),
        ("\n", "\r", &[]),
        ("\n", "\n \t\n", &[]),
        ("ROOT hip\n{", "root   hip {", &[]),
        ("End Site\n", "End site\n", &[]),
        ("HIERARCHY", "\u{FEFF}hierarchy", &[]),
        ("Frames: 2", "Frames:\t2", &[]),
        ("Frame Time: 0.5", "FRAME  TIME :.5", &[]),
        ("Frames: 2", "Frames: 18446744073709551615", &["bvh-motion"]),
        ("Frames: 2", "Frames: 1", &["bvh-motion"]),
        ("Frames: 2\n", "", &[]),
        ("30 40 50\n", "30 40 50\n9 9 9", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50 7 8", &["bvh-motion"]),
        ("0 1 0 0 0 0 0 0 0\n", "0 1 0 0 0 0 0 0 0 ;\n", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\n\u{1A}", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\u{1A}\nold text", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\0\0\0\0", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\n;\n", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\n// made by hand\n1 2 3\n", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\n1 2 3 four\n", &["bvh-motion"]),
        ("30 40 50\n", "30 40 50\n1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2\n", &["bvh-motion"]),
        ("OFFSET 0 -0.5 0.5", "OFFSET 0 -0.5 0.5\nCHANNELS 0", &["bvh-end-site"]),
        ("OFFSET 0 -0.5 0.5", "CHANNELS 0 OFFSET 0 -0.5 0.5", &["bvh-end-site"]),
    ];
    let plain = read_bvh(TWO_JOINTS).expect("readable");
    for (usual, unusual, warnings) in cases {
        let asset =
            read_bvh(&TWO_JOINTS.replace(usual, unusual)).unwrap_or_else(|problem| panic!("{unusual:?}: {problem}"));
        assert_eq!(asset.clips[0].channels(), plain.clips[0].channels(), "{unusual:?}");
        assert_eq!(asset.clips[0].timelines(), plain.clips[0].timelines(), "{unusual:?}");
        assert_eq!(codes(&asset), warnings, "{unusual:?}");
    }
}

#[test]
fn text_may_be_utf16() {
    let plain = read_bvh(&TWO_JOINTS.replace("hip", "Hüfte")).expect("readable");
    assert!(plain.skeleton.find("Hüfte").is_some());
    let words: Vec<u16> = TWO_JOINTS.replace("hip", "Hüfte").encode_utf16().collect();
    for (bytes, mark) in
        [(u16::to_le_bytes as fn(u16) -> [u8; 2], true), (u16::to_be_bytes, true), (u16::to_le_bytes, false)]
    {
        let mark = mark.then_some(0xFEFF_u16);
        let text: Vec<u8> = mark.into_iter().chain(words.iter().copied()).flat_map(bytes).collect();
        // The content decides: the name has no extension.
        let asset = load_named(&one("walk", text), "walk", &METRES).expect("readable");
        assert!(asset.skeleton.find("Hüfte").is_some());
        assert_eq!(asset.clips[0].channels(), plain.clips[0].channels());
        assert_eq!(codes(&asset), [""; 0]);
    }
}

/// A line that holds more than its frame isn't the layout of a file whose lines are filled regardless of frames.
#[test]
fn lines_regardless_of_frames_are_not_guessed() {
    let filled =
        TWO_JOINTS.replace("Frames: 2", "Frames: 3").replace("0 1 0 0 0 0 0 0 0\n1 2 3 ", "0 1 0 0 0 0 0 0 0 1 2 3\n");
    let problem = read_bvh(&filled).expect_err("refused").to_string();
    assert!(problem.contains("line 19") && problem.contains("9 numbers"), "{problem}");
}

#[test]
fn a_frame_may_span_several_lines() {
    let wrapped = TWO_JOINTS.replace("0 1 0 0 0 0 0 0 0\n1 2 3", "0 1 0 0 0\n0 0 0 0\n1 2 3\n");
    let asset = read_bvh(&wrapped).expect("readable");
    assert_eq!(asset.clips[0].channels(), read_bvh(TWO_JOINTS).expect("readable").clips[0].channels());
}

#[test]
fn one_frame_no_frames_and_no_motion() {
    let (start, _) = TWO_JOINTS.split_once("1 2 3 90").expect("two frames");
    let one_frame = read_bvh(&start.replace("Frames: 2", "Frames: 1").replace("0.5\n0", "0\n0")).expect("readable");
    assert_eq!((one_frame.clips[0].duration_secs(), one_frame.warnings.len()), (0.0, 0));
    let (start, _) = TWO_JOINTS.split_once("0 1 0 0 0 0").expect("frames");
    assert_eq!(read_bvh(start).expect("readable").clips.len(), 0);
    let (start, _) = TWO_JOINTS.split_once("MOTION").expect("a motion");
    let still = read_bvh(start).expect("readable");
    assert_eq!((still.clips.len(), still.skeleton.len(), codes(&still)), (0, 2, vec!["bvh-motion"]));
}

#[test]
fn positions_replace_the_offset_unless_all_are_zero() {
    let channels = "\t\tCHANNELS 3 X";
    let moved = TWO_JOINTS.replace(channels, "\t\tCHANNELS 6 Xposition Yposition Zposition X");
    let with = |first: &str, second: &str| {
        let text = moved.replace("0 1 0 0 0 0 0 0 0", &format!("0 1 0 0 0 0 {first} 0 0 0"));
        read_bvh(&text.replace("90 0 0 30", &format!("90 0 0 {second} 30"))).expect("readable")
    };
    let asset = with("0.5 -1 0", "0.25 -2 0");
    assert!(world(&asset, 0.0)[1].translation.abs_diff_eq(glam::Vec3A::new(0.5, 0.0, 0.0), 1e-6));
    assert!(world(&asset, 0.5)[1].translation.abs_diff_eq(glam::Vec3A::new(3.0, 2.25, 3.0), 1e-6));
    let asset = with("0 0 0", "0 0 0");
    assert_eq!(codes(&asset), ["channel-ignored"]);
    assert!(world(&asset, 0.0)[1].translation.abs_diff_eq(glam::Vec3A::new(0.5, 0.0, 0.0), 1e-6));
    // Axes without a channel keep the OFFSET.
    let text = TWO_JOINTS.replace(channels, "\t\tCHANNELS 4 Yposition X").replace("0 0 0 0 0\n1", "0 0 0 0 0 0\n1");
    let asset = read_bvh(&text.replace("90 0 0 30", "90 0 0 -3 30")).expect("readable");
    assert!(world(&asset, 0.5)[1].translation.abs_diff_eq(glam::Vec3A::new(4.0, 2.5, 3.0), 1e-6));
}

#[test]
fn consecutive_rotations_take_the_short_arc() {
    let text = TWO_JOINTS.replace("0 1 0 0 0 0 0 0 0", "0 1 0 -170 0 0 0 0 0").replace("90 0 0 30", "170 0 0 30");
    let asset = read_bvh(&text).expect("readable");
    let keys = rotations(&asset, "hip");
    assert!(keys[0].dot(keys[1]) > 0.9, "{keys:?}");
    let halfway = world(&asset, 0.25)[0].matrix3.x_axis;
    assert!(halfway.abs_diff_eq(-glam::Vec3A::X, 1e-6), "{halfway}");
}

#[test]
fn joints_may_nest_to_any_depth() {
    const DEPTH: usize = 100_000;
    let mut text = "HIERARCHY\nROOT a {\n OFFSET 0 0 0 CHANNELS 0\n".to_owned();
    text += &"JOINT a { OFFSET 0 0 0\n".repeat(DEPTH);
    text += &"}".repeat(DEPTH + 1);
    assert_eq!(read_bvh(&text).expect("readable").skeleton.len(), DEPTH + 1);
    let open = &text[..text.len() - DEPTH];
    assert!(read_bvh(open).is_err());
}

/// Nested or side by side. With 100,000 joints, anything quadratic takes minutes.
#[test]
fn twice_as_many_joints_take_twice_as_many_allocations() {
    const JOINT: &str = "JOINT a { OFFSET 0 1 0 CHANNELS 3 Zrotation Xrotation Yrotation ";
    let nested = |count: usize| JOINT.repeat(count) + &"}".repeat(count);
    let side_by_side = |count: usize| format!("{JOINT}}} ").repeat(count);
    for joints in [&nested as &dyn Fn(usize) -> String, &side_by_side] {
        let allocations = |count: usize| {
            let frame = "1 2 3 ".repeat(count);
            let motion = format!("MOTION\nFrames: 1\nFrame Time: 1\n{frame}\n");
            let text = format!("HIERARCHY\nROOT r {{ OFFSET 0 0 0 CHANNELS 0\n{} }}\n{motion}", joints(count));
            let read = |asset: &mut Option<Asset>| *asset = Some(read_bvh(&text).expect("readable"));
            let mut asset = None;
            let allocations = allocations_after(&mut asset, read, read);
            let asset = asset.expect("it was read");
            assert_eq!((asset.skeleton.len(), asset.clips[0].channels().len()), (count + 1, count));
            allocations
        };
        let [half, whole] = [50_000, 100_000].map(allocations);
        assert!(whole < 2 * half + half / 10, "{half} and {whole}");
    }
}

#[test]
fn several_roots_names_with_spaces_and_an_unnamed_joint() {
    let text = "HIERARCHY ROOT left hand { OFFSET 0 1 0 CHANNELS 0 JOINT\n{ OFFSET 1 0 0 CHANNELS 1 Xrotation } }
        ROOT right hand\n{ OFFSET 0 2 0 CHANNELS 1 Yrotation }
        MOTION\nFrames: 1\nFrame Time: 1\n10 20\n";
    let asset = read_bvh(text).expect("readable");
    let names: Vec<&str> = asset.skeleton.joints().map(|joint| asset.skeleton.name(joint)).collect();
    assert_eq!(names, ["left hand", "", "right hand"]);
    assert_eq!(asset.clips[0].channels().len(), 2);
}

/// A person of 1.8 units in T-pose: 2.7 units from fingertip to toe along the bones.
fn person(size: f64, z_up: bool) -> String {
    let offset = |up: f64, side: f64| {
        let (up, side) = (up * size, side * size);
        if z_up { format!("OFFSET {side} 0 {up}") } else { format!("OFFSET {side} {up} 0") }
    };
    format!(
        "HIERARCHY ROOT hips {{ {} CHANNELS 3 Xposition Yposition Zposition
            JOINT leg {{ {} CHANNELS 0 End Site {{ {} }} }}
            JOINT chest {{ {} CHANNELS 0 JOINT arm {{ {} CHANNELS 0 End Site {{ {} }} }} End Site {{ {} }} }} }}
        MOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n",
        offset(1.0, 0.0),
        offset(-0.5, 0.0),
        offset(-0.5, 0.0),
        offset(0.5, 0.0),
        offset(0.0, 0.2),
        offset(0.0, 0.85),
        offset(0.3, 0.0),
    )
}

#[test]
fn the_unit_is_guessed_from_the_size_and_can_be_overridden() {
    for units_per_metre in [1.0, 100.0, 1000.0, 1.0 / 0.0254, 0.45 / 0.0254] {
        // From a child to a giant.
        for height in [0.8, 1.0, 1.2] {
            let files = one("person.bvh", person(units_per_metre * height, false).into_bytes());
            let asset = load(&files).expect("readable");
            assert_eq!(codes(&asset), ["unit-guessed"]);
            let found = f64::from(asset.skeleton.rest().local(JointIndex(0)).translation.y);
            assert!((found - height).abs() < 1e-6, "{units_per_metre} units a metre: {found}, not {height}");
            let chosen = LoadOptions { bvh_unit_metres: Some(0.5), ..LoadOptions::default() };
            let asset = load_with(&files, &chosen).expect("readable");
            let found = f64::from(asset.skeleton.rest().local(JointIndex(0)).translation.y);
            assert!((found / (units_per_metre * height * 0.5) - 1.0).abs() < 1e-6);
            assert_eq!(codes(&asset), [""; 0]);
        }
    }
    // Nothing to measure: no conversion.
    let text = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 0 }";
    assert_eq!(load(&one("a.bvh", text.into())).expect("readable").skeleton.len(), 1);
}

#[test]
fn a_skeleton_with_z_up_is_rotated_to_y_up() {
    let up = load(&one("person.bvh", person(100.0, false).into_bytes())).expect("readable");
    let turned = load(&one("person.bvh", person(100.0, true).into_bytes())).expect("readable");
    assert_eq!(codes(&turned), ["unit-guessed", "up-axis-guessed"]);
    for (up, turned) in up.skeleton.rest().locals().zip(turned.skeleton.rest().locals()) {
        assert!(up.translation.abs_diff_eq(turned.translation, 1e-6), "{up:?} {turned:?}");
    }
    // A motion in Z-up is the same motion, rotated by −90° about X.
    let z_up = LoadOptions { bvh_z_up: Some(true), ..METRES };
    let plain = read_bvh(TWO_JOINTS).expect("readable");
    let turned = load_with(&one("walk.bvh", TWO_JOINTS.into()), &z_up).expect("readable");
    let turn = Affine3A::from_rotation_x(-90.0_f32.to_radians());
    for (plain, turned) in world(&plain, 0.5).iter().zip(world(&turned, 0.5)) {
        assert!((turn * *plain * turn.inverse()).abs_diff_eq(turned, 1e-5));
    }
}

#[test]
fn a_set_may_contain_a_model_and_a_motion() {
    let mut files = one("walk.bvh", TWO_JOINTS.into());
    files.insert("model.glb", crate::build_gltf::Build::triangle().glb());
    assert_eq!(main_files(&files), ["walk.bvh", "model.glb"]);
    assert!(matches!(load(&files), Err(LoadError::SeveralModels { .. })));
    assert_eq!(load_named(&files, "walk.bvh", &METRES).expect("readable").format, "bvh");
    assert_eq!(load_named(&files, "model.glb", &METRES).expect("readable").format, "glb");
    assert!(load_named(&files, "other.glb", &METRES).is_err());
    // Recognized by content, whatever the name.
    let mut files = FileSet::default();
    files.insert("download", TWO_JOINTS.as_bytes().to_vec());
    assert_eq!(load(&files).expect("readable").format, "bvh");
}

/// Joints, frames, seconds from the first to the last, metres per unit, and whether Z is up.
const REAL: [(&str, usize, usize, f32, f64, bool); 15] = [
    ("cosc422/original/Dwarf/avatar_walk.bvh", 21, 14, 0.866671, 0.0254, false),
    ("bvh/animateddrawings_cmu1_jumping_jacks.bvh", 31, 125, 4.13292, 0.0254 / 0.45, false),
    ("bvh/animateddrawings_fair1_dab.bvh", 27, 339, 11.266655, 0.0254, true),
    ("bvh/animateddrawings_fair1_zombie.bvh", 27, 779, 25.933307, 0.0254, true),
    ("bvh/animateddrawings_rokoko_jesse_dance.bvh", 60, 1007, 10.06, 0.01, false),
    // The header says 3069 frames.
    ("bvh/assimp_Boxing_Toes.bvh", 21, 3070, 30.69, 0.01, false),
    ("bvh/cmu_01_01.bvh", 31, 2752, 22.924908, 0.0254 / 0.45, false),
    ("bvh/cosc422_Dance.bvh", 18, 219, 7.266594, 0.0254, false),
    ("bvh/cosc422_Test.bvh", 3, 10, 0.9, 1.0, false),
    ("bvh/cosc422_Walk.bvh", 22, 230, 7.633326, 0.01, false),
    ("bvh/deepmotion_blender_example.bvh", 31, 278, 2.308324, 0.0254 / 0.45, false),
    ("bvh/deepmotion_rest.bvh", 31, 1, 0.0, 0.0254 / 0.45, false),
    ("bvh/deepmotion_xia_depressed_18_000.bvh", 31, 105, 0.866632, 0.0254 / 0.45, false),
    ("bvh/deepmotion_xia_neutral_16_000.bvh", 31, 150, 1.241617, 0.0254 / 0.45, false),
    ("bvh/threejs_pirouette.bvh", 43, 592, 4.924998, 0.01, false),
];

#[test]
fn real_files_have_known_contents() {
    let Some(data) = data_folder() else { return };
    for (path, joints, frames, secs, unit_metres, z_up) in REAL {
        let bytes = std::fs::read(data.join(path)).expect("readable");
        let asset = load(&one(path.rsplit('/').next().expect("a name"), bytes)).unwrap_or_else(|p| panic!("{p}"));
        let clip = &asset.clips[0];
        let found = (asset.skeleton.len(), clip.timelines()[0].len());
        assert_eq!(found, (joints, frames), "{path}");
        assert!((clip.duration_secs() - secs).abs() < 1e-5, "{path}: {} s", clip.duration_secs());
        // Every joint rotates, only the root translates.
        assert_eq!(clip.channels().len(), joints + 1, "{path}");
        let text = asset.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        assert_eq!(text.contains("up axis"), z_up, "{path}: {text}");
        assert_eq!(text.contains("3069 frames are announced, 3070"), path.contains("Boxing"), "{text}");
        let told = LoadOptions { bvh_unit_metres: Some(unit_metres as f32), bvh_z_up: Some(z_up), ..METRES };
        let bytes = std::fs::read(data.join(path)).expect("readable");
        let again = load_with(&one("again.bvh", bytes), &told).expect("readable");
        for (guessed, told) in asset.skeleton.rest().locals().zip(again.skeleton.rest().locals()) {
            assert!(guessed.translation.abs_diff_eq(told.translation, 1e-5), "{path}: another unit: {text}");
        }
    }
}

/// Joint positions in the sixth frame, computed independently (matrices in Python), in the file's units.
const AVATAR_WALK_FRAME_5: [(usize, [f32; 3]); 5] = [
    (0, [-0.1148, 42.3072, 2.9681]),
    (5, [0.1752, 61.1665, 4.4765]),
    (10, [11.9379, 35.6393, -3.8397]),
    (14, [-9.6846, 36.426, 13.5087]),
    (20, [-1.6235, 1.115, -5.909]),
];

#[test]
fn avatar_walk_has_the_joint_numbers_of_the_coursework() {
    let Some(data) = data_folder() else { return };
    let bytes = std::fs::read(data.join("cosc422/original/Dwarf/avatar_walk.bvh")).expect("readable");
    let asset = load_with(&one("avatar_walk.bvh", bytes), &METRES).expect("readable");
    let names = [
        "hip",
        "abdomen",
        "chest",
        "neckDummy",
        "neck",
        "head",
        "figureHair",
        "lCollar",
        "lShldr",
        "lForeArm",
        "lHand",
        "rCollar",
        "rShldr",
        "rForeArm",
        "rHand",
        "lThigh",
        "lShin",
        "lFoot",
        "rThigh",
        "rShin",
        "rFoot",
    ];
    for (number, name) in names.into_iter().enumerate() {
        let joint = asset.skeleton.joint_of_source(number).expect("a joint");
        assert_eq!(asset.skeleton.name(joint), name, "channel {number}");
    }
    let at = world(&asset, 5.0 * 0.066_667);
    for (joint, expected) in AVATAR_WALK_FRAME_5 {
        let found = Vec3::from(at[joint].translation);
        assert!(found.abs_diff_eq(Vec3::from_array(expected), 1e-3), "{}: {found}", names[joint]);
    }
}
