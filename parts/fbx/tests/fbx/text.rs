//! What the converter makes of ASCII files.

use crate::ascii::{Fbx, SKIN, character, cube, two_joints};
use crate::glb::Glb;

fn assert_near(found: [f64; 3], expected: [f64; 3]) {
    let near = found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(near, "expected {expected:?}, found {found:?}");
}

/// Returns a node's world position.
fn position(glb: &Glb, clip: Option<(usize, f64)>, name: &str) -> [f64; 3] {
    let [x, y, z, _] = glb.pose(clip).worlds[glb.node(name)][3];
    [x, y, z]
}

#[test]
fn centimetres_become_metres_without_scaling_joints() {
    let (glb, warnings) = two_joints().glb();
    assert_near(position(&glb, None, "mixamorig:Spine"), [0.0, 1.0, 0.0]);
    assert!(glb.list("nodes").iter().all(|node| node["scale"].is_null()));
    assert_eq!(warnings, [] as [String; 0]);
}

#[test]
fn the_file_s_unit_counts() {
    let mut fbx = Fbx::new(2.54);
    fbx.node("a", "Null", 0, &[("Lcl Translation", [0.0, 100.0, 0.0])]);
    assert_near(position(&fbx.glb().0, None, "a"), [0.0, 2.54, 0.0]);
}

#[test]
fn z_up_and_left_handed_files_are_turned_and_mirrored() {
    for (axes, expected) in
        [([(2, 1), (1, -1), (0, 1)], [1.0, 3.0, -2.0]), ([(1, 1), (2, -1), (0, 1)], [1.0, 2.0, -3.0])]
    {
        let mut fbx = Fbx::with_axes(100.0, axes);
        let parent = fbx.node("a", "Null", 0, &[("Lcl Translation", [1.0, 2.0, 0.0])]);
        fbx.node("b", "Null", parent, &[("Lcl Translation", [0.0, 0.0, 3.0])]);
        assert_near(position(&fbx.glb().0, None, "b"), expected);
    }
}

#[test]
fn names_and_parents_are_those_of_the_file() {
    let (glb, _) = two_joints().glb();
    let names: Vec<_> = glb.list("nodes").iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 3);
    let hips = &glb.list("nodes")[glb.node("mixamorig:Hips")];
    assert_eq!(hips["children"].as_array().unwrap().len(), 1);
    assert_eq!(hips["children"][0], glb.node("mixamorig:Spine"));
}

#[test]
fn a_skin_bends_and_a_shape_blends() {
    let (glb, _) = two_joints().glb();
    let rest = glb.vertices(&glb.pose(None));
    assert!(rest.iter().any(|p| (p[0] - 0.01).abs() + (p[1] - 0.01).abs() + p[2].abs() < 1e-6), "{rest:?}");
    // The vertex (1, 1, 0) cm, with the shape (1, 1, 5), turned by 90° about X at (0, 100, 0): y - 100 becomes z.
    let bent = glb.vertices(&glb.pose(Some((0, 2.0))));
    let expected = [0.01, 1.0 - 0.05, -0.99];
    let distance = |p: &&[f64; 3]| (0..3).map(|i| (p[i] - expected[i]).abs()).sum::<f64>() < 1e-5;
    assert!(bent.iter().find(distance).is_some(), "{bent:?}");
    assert_eq!(glb.list("meshes")[0]["extras"]["targetNames"][0], "smile");
}

#[test]
fn takes_keep_their_names_and_lengths() {
    let mut fbx = two_joints();
    let layer = fbx.take("Armature|Run", 0.5);
    fbx.curve(layer, (1, "Lcl Translation", "d|Y"), 4, &[(0.0, 0.0), (0.5, 50.0)]);
    let (glb, _) = fbx.glb();
    let names: Vec<_> = glb.list("animations").iter().map(|clip| clip["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["mixamo.com", "Armature|Run"]);
    assert_eq!((glb.duration(0), glb.duration(1)), (2.0, 0.5));
    assert_near(position(&glb, Some((1, 0.25)), "mixamorig:Hips"), [0.0, 0.25, 0.0]);
}

#[test]
fn a_pivot_moves_what_turns_about_it() {
    let converted = gaitway_fbx::convert(cube().as_bytes()).unwrap();
    let glb = Glb::new(&converted.bytes);
    for (time, expected) in [(0.0, [0.0, 0.0, 0.0]), (0.5, [0.01, -0.01, 0.0]), (1.0, [0.02, 0.0, 0.0])] {
        assert_near(position(&glb, Some((0, time)), "Cube"), expected);
    }
}

/// A translation about a pivot has the keys of the rotation as well, at the same times.
#[test]
fn keys_of_several_curves_at_the_same_time_count_once() {
    const COUNT: usize = 135_000;
    let mut fbx = Fbx::new(1.0);
    let node = fbx.node("Prop", "Null", 0, &[("RotationPivot", [1.0, 0.0, 0.0])]);
    let layer = fbx.take("long", COUNT as f64 / 120.0);
    let keys = |step: f64| (0..COUNT).map(|key| (key as f64 / 120.0, (key % 7) as f64 * step)).collect::<Vec<_>>();
    fbx.curve(layer, (node, "Lcl Translation", "d|X"), 4, &keys(1.0));
    fbx.curve(layer, (node, "Lcl Rotation", "d|Z"), 4, &keys(10.0));
    let (glb, _) = fbx.glb();
    assert_eq!(glb.duration(0), COUNT as f64 / 120.0);
}

#[test]
fn constant_keys_become_steps() {
    let mut fbx = Fbx::new(100.0);
    let node = fbx.node("a", "Null", 0, &[]);
    let layer = fbx.take("jump", 3.0);
    fbx.curve(layer, (node, "Lcl Translation", "d|X"), 2, &[(0.0, 1.0), (1.0, 2.0), (3.0, 5.0)]);
    let (glb, _) = fbx.glb();
    assert_eq!(glb.list("animations")[0]["samplers"][0]["interpolation"], "STEP");
    for (time, x) in [(0.5, 1.0), (1.0, 2.0), (2.9, 2.0), (3.0, 5.0)] {
        assert_near(position(&glb, Some((0, time)), "a"), [x, 0.0, 0.0]);
    }
}

#[test]
fn several_turns_between_two_keys_are_all_made() {
    let mut fbx = Fbx::new(100.0);
    let node = fbx.node("a", "Null", 0, &[]);
    fbx.node("b", "Null", node, &[("Lcl Translation", [1.0, 0.0, 0.0])]);
    let layer = fbx.take("spin", 1.0);
    fbx.curve(layer, (node, "Lcl Rotation", "d|Z"), 4, &[(0.0, 0.0), (1.0, 1440.0)]);
    let (glb, _) = fbx.glb();
    for eighth in 0..=32 {
        let angle = f64::from(eighth) * std::f64::consts::FRAC_PI_4;
        assert_near(position(&glb, Some((0, f64::from(eighth) / 32.0)), "b"), [angle.cos(), angle.sin(), 0.0]);
    }
}

#[test]
fn geometric_transforms_move_the_mesh_but_not_the_children() {
    let mut fbx = Fbx::new(100.0);
    let node =
        fbx.node("a", "Mesh", 0, &[("GeometricTranslation", [5.0, 0.0, 0.0]), ("GeometricScaling", [1.0, -1.0, 1.0])]);
    fbx.node("b", "Null", node, &[]);
    fbx.quad(node);
    let (glb, _) = fbx.glb();
    assert_near(position(&glb, None, "b"), [0.0; 3]);
    let vertices = glb.vertices(&glb.pose(None));
    assert!(vertices.iter().all(|p| (p[0] - 5.0).abs() < 1.01), "{vertices:?}");
    assert_eq!(glb.list("nodes").len(), 2);
    // Mirrored twice, by the scale and by the order of the corners, the quad still faces +Z.
    let corners = glb.accessor(&glb.list("meshes")[0]["primitives"][0]["indices"]);
    let [a, b, c] = [0, 1, 2].map(|corner| vertices[corners[corner] as usize]);
    assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0);
}

#[test]
fn materials_and_textures_are_carried_over() {
    let mut fbx = Fbx::new(1.0);
    let node = fbx.node("a", "Mesh", 0, &[]);
    fbx.quad(node);
    let material = "ShadingModel: \"phong\"\nProperties70: {\n\
        P: \"DiffuseColor\", \"Color\", \"\", \"A\",0.8,0.8,0.8\n\
        P: \"EmissiveColor\", \"Color\", \"\", \"A\",2,0,0\n\
        P: \"SpecularColor\", \"Color\", \"\", \"A\",1,1,1\n\
        P: \"ShininessExponent\", \"double\", \"Number\", \"\",30\n}";
    let material = fbx.object("Material", "skin", "", material);
    fbx.connect(material, node);
    let texture = "RelativeFilename: \"..\\\\maps\\\\a skin.png\"\nFileName: \"C:\\\\maps\\\\a skin.png\"";
    let texture = fbx.object("Texture", "t", "", texture);
    fbx.connect_property(texture, material, "DiffuseColor");
    let (glb, _) = fbx.glb();
    assert_eq!(glb.list("images")[0]["uri"], "a%20skin.png");
    let material = &glb.list("materials")[0];
    assert_eq!(material["name"], "skin");
    let surface = &material["pbrMetallicRoughness"];
    assert_eq!(
        surface["baseColorFactor"],
        serde_json::json!([1, 1, 1, 1]),
        "the texture takes the place of the colour"
    );
    assert_eq!(surface["metallicFactor"], 0);
    assert_eq!(surface["roughnessFactor"], 0.25);
    assert_eq!(material["emissiveFactor"], serde_json::json!([1, 0, 0]));
    assert_eq!(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 2);
    assert_eq!(glb.list("meshes")[0]["primitives"][0]["material"], 0);
    let uvs = glb.accessor(&glb.list("meshes")[0]["primitives"][0]["attributes"]["TEXCOORD_0"]);
    assert_eq!(uvs[..2], [0.0, 1.0], "V points down in glTF");
}

#[test]
fn a_separate_roughness_map_stays_and_a_metalness_map_goes() {
    let mut fbx = Fbx::new(1.0);
    let node = fbx.node("a", "Mesh", 0, &[]);
    fbx.quad(node);
    // The identity of 3ds Max's metal and roughness material.
    let material = "ShadingModel: \"unknown\"\nProperties70: {\n\
        P: \"3dsMax|ClassIDa\", \"int\", \"Integer\", \"\",-804315648\n\
        P: \"3dsMax|ClassIDb\", \"int\", \"Integer\", \"\",-1099438848\n\
        P: \"3dsMax|main|metalness\", \"Float\", \"\", \"A\",0.7\n\
        P: \"3dsMax|main|roughness\", \"Float\", \"\", \"A\",0.3\n\
        P: \"3dsMax|main|useGlossiness\", \"Integer\", \"\", \"A\",2\n}";
    let material = fbx.object("Material", "steel", "", material);
    fbx.connect(material, node);
    for map in ["metalness", "roughness"] {
        let texture =
            fbx.object("Texture", map, "", &format!("RelativeFilename: \"{map}.png\"\nFileName: \"{map}.png\""));
        fbx.connect_property(texture, material, &format!("3dsMax|main|{map}_map"));
    }
    let (glb, warnings) = fbx.glb();
    let surface = &glb.list("materials")[0]["pbrMetallicRoughness"];
    assert_eq!(surface["metallicFactor"], 0, "{surface}");
    assert_eq!(surface["roughnessFactor"], 1);
    assert_eq!(glb.list("images").len(), 1);
    assert_eq!(glb.list("images")[0]["uri"], "roughness.png");
    assert!(warnings.len() == 1 && warnings[0].contains("metalness map"), "{warnings:?}");
}

#[test]
fn joints_of_separate_trees_get_a_common_root() {
    let mut fbx = two_joints();
    let arm = fbx.node("Arm", "LimbNode", 0, &[]);
    fbx.cluster(SKIN, arm, &[(0, 1.0)], 0.0);
    let (glb, _) = fbx.glb();
    assert_eq!(glb.list("scenes")[0]["nodes"].as_array().unwrap().len(), 1);
    assert_near(position(&glb, None, "Arm"), [0.0; 3]);
}

#[test]
fn vertices_that_no_joint_moves_stay_with_their_mesh() {
    let mut fbx = Fbx::new(100.0);
    let joint = fbx.node("joint", "LimbNode", 0, &[("Lcl Translation", [0.0, 7.0, 0.0])]);
    let body = fbx.node("Body", "Mesh", 0, &[("Lcl Translation", [3.0, 0.0, 0.0])]);
    let mesh = fbx.quad(body);
    let skin = fbx.object("Deformer", "", "Skin", "");
    fbx.connect(skin, mesh);
    fbx.cluster(skin, joint, &[(0, 0.5)], 0.0);
    let (glb, _) = fbx.glb();
    let vertices = glb.vertices(&glb.pose(None));
    for expected in [[-1.0, 6.0, 0.0], [4.0, -1.0, 0.0], [4.0, 1.0, 0.0], [2.0, 1.0, 0.0]] {
        assert!(vertices.contains(&expected), "{expected:?} in {vertices:?}");
    }
}

#[test]
fn more_influences_than_four_take_further_sets() {
    for (count, sets) in [(5, 2), (16, 4), (20, 4)] {
        let mut fbx = Fbx::new(100.0);
        let body = fbx.node("Body", "Mesh", 0, &[]);
        let mesh = fbx.quad(body);
        let skin = fbx.object("Deformer", "", "Skin", "");
        fbx.connect(skin, mesh);
        for joint in 0..count {
            let node = fbx.node(&format!("joint{joint}"), "LimbNode", 0, &[]);
            let weight = f64::from(joint + 1);
            fbx.cluster(skin, node, &[0, 1, 2, 3].map(|vertex| (vertex, weight)), 0.0);
        }
        let (glb, warnings) = fbx.glb();
        let attributes = &glb.list("meshes")[0]["primitives"][0]["attributes"];
        let written = (0..5).filter(|set| !attributes[format!("JOINTS_{set}")].is_null()).count();
        assert_eq!(written, sets, "{count} influences");
        assert_eq!(warnings.len(), usize::from(count > 16), "{warnings:?}");
        assert!(
            glb.accessor(&attributes["WEIGHTS_0"])[0] > glb.accessor(&attributes["WEIGHTS_1"])[0],
            "strongest first"
        );
    }
}

#[test]
fn hidden_meshes_hide_nothing_else() {
    let mut fbx = Fbx::new(1.0);
    let hidden = "Properties70: {\nP: \"Visibility\", \"Visibility\", \"\", \"A\",0\n}";
    let mut nodes = [("lone", 0), ("parent", 0), ("child", 0)];
    for (name, node) in &mut nodes {
        *node = fbx.object("Model", name, "Mesh", if *name == "child" { "" } else { hidden });
        fbx.quad(*node);
    }
    let [(_, lone), (_, parent), (_, child)] = nodes;
    fbx.connect(lone, 0);
    fbx.connect(parent, 0);
    fbx.connect(child, parent);
    let (glb, _) = fbx.glb();
    let hides = |name| !glb.list("nodes")[glb.node(name)]["extensions"]["KHR_node_visibility"].is_null();
    assert_eq!(["lone", "parent", "child"].map(hides), [true, false, false]);
}

#[test]
fn cameras_and_lights_look_along_their_fbx_axes() {
    let mut fbx = Fbx::new(100.0);
    for (name, kind) in [("eye", "Camera"), ("lamp", "Light")] {
        let node = fbx.node(name, kind, 0, &[]);
        let attribute = fbx.object("NodeAttribute", name, kind, "");
        fbx.connect(attribute, node);
    }
    let (glb, _) = fbx.glb();
    let pose = glb.pose(None);
    let forward = |member: fn(&serde_json::Value) -> &serde_json::Value| {
        let index = glb.list("nodes").iter().position(|node| !member(node).is_null()).unwrap();
        let [x, y, z, _] = pose.worlds[index][2];
        [-x, -y, -z]
    };
    assert_near(forward(|node| &node["camera"]), [1.0, 0.0, 0.0]);
    assert_near(forward(|node| &node["extensions"]["KHR_lights_punctual"]), [0.0, -1.0, 0.0]);
}

/// MotionBuilder's own cameras are hidden, and 3ds Max's targets are nodes like any other.
#[test]
fn hidden_cameras_and_targets_are_hidden() {
    let mut fbx = Fbx::new(1.0);
    let hidden = "Properties70: {\nP: \"Visibility\", \"Visibility\", \"\", \"A\",0\n}";
    let hips = fbx.object("Model", "hips", "LimbNode", hidden);
    fbx.connect(hips, 0);
    let bone = fbx.object("NodeAttribute", "", "LimbNode", "TypeFlags: \"Skeleton\"");
    fbx.connect(bone, hips);
    let group = fbx.object("Model", "group", "Null", hidden);
    fbx.connect(group, 0);
    fbx.node("shown", "Null", group, &[]);
    for (name, contents) in [("producer", hidden), ("shot", "")] {
        let node = fbx.object("Model", name, "Camera", contents);
        fbx.connect(node, 0);
        let attribute = fbx.object("NodeAttribute", name, "Camera", "");
        fbx.connect(attribute, node);
        let target = fbx.node(&format!("{name}.Target"), "Null", 0, &[]);
        fbx.connect_property(target, node, "LookAtProperty");
    }
    let (glb, _) = fbx.glb();
    let hides = |name| !glb.list("nodes")[glb.node(name)]["extensions"]["KHR_node_visibility"].is_null();
    let names = ["hips", "group", "shown", "producer", "shot", "producer.Target", "shot.Target"];
    assert_eq!(names.map(hides), [false, false, false, true, false, true, true]);
}

/// What a file leaves out is 1: the same file says so.
#[test]
fn an_inherited_scale_may_be_left_out() {
    let scene = |scale: &[(&str, [f64; 3])], flag: &str, left_handed: bool| {
        let axes = [(1, 1), (2, if left_handed { -1 } else { 1 }), (0, 1)];
        let mut fbx = Fbx::with_axes(1.0, axes);
        let upper =
            fbx.node("upper", "Null", 0, &[("Lcl Scaling", [2.0, 1.0, 1.0]), ("Lcl Rotation", [0.0, 0.0, 30.0])]);
        let mut parent = upper;
        let mut nodes = Vec::new();
        for name in ["middle", "lower", "end"] {
            let own = [&[("Lcl Translation", [10.0, 50.0, 0.0]), ("RotationPivot", [1.0, 2.0, 3.0])], scale].concat();
            parent = fbx.node(name, "Null", parent, &own);
            nodes.push(parent);
        }
        fbx.quad(parent);
        let layer = fbx.take("Take 001", 1.0);
        fbx.curve(layer, (upper, "Lcl Scaling", "d|X"), 4, &[(0.0, 2.0), (1.0, 3.0)]);
        fbx.curve(layer, (nodes[1], "Lcl Translation", "d|X"), 4, &[(0.0, 10.0), (1.0, 30.0)]);
        fbx.curve(layer, (nodes[0], "Lcl Rotation", "d|Z"), 4, &[(0.0, 0.0), (1.0, 60.0)]);
        let text = fbx.text().replace(
            "Properties70: {\nP: \"Lcl",
            &format!("Properties70: {{\nP: \"InheritType\", \"enum\", \"\", \"\",{flag}\nP: \"Lcl"),
        );
        Glb::new(&gaitway_fbx::convert(text.as_bytes()).unwrap().bytes)
    };
    for (flag, left_handed) in [("0", false), ("0", true), ("1", false), ("2", false)] {
        let (short, full) =
            (scene(&[], flag, left_handed), scene(&[("Lcl Scaling", [1.0, 1.0, 1.0])], flag, left_handed));
        for clip in [None, Some((0, 0.0)), Some((0, 0.4)), Some((0, 1.0))] {
            let [short, full] = [&short, &full].map(|glb| glb.vertices(&glb.pose(clip)));
            for (found, expected) in short.iter().zip(&full) {
                assert!(
                    (0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-5),
                    "{flag} {clip:?}: {found:?}, not {expected:?}"
                );
            }
        }
    }
}

/// Paths of sound files are often in another encoding, and are no part of a scene.
#[test]
fn text_that_is_not_used_may_be_damaged() {
    let mut fbx = two_joints();
    fbx.object("Audio", "song", "Clip", "RelativeFilename: \"caf#.wav\"");
    let convert = |text: &str| {
        let bytes: Vec<u8> = text.bytes().map(|byte| if byte == b'#' { 0xE9 } else { byte }).collect();
        gaitway_fbx::convert(&bytes).unwrap().warnings
    };
    assert_eq!(convert(&fbx.text()), [""; 0]);
    let warnings = convert(&fbx.text().replace("mixamorig:Spine", "mixamorig:Spin#"));
    assert!(warnings.len() == 1 && warnings[0].contains("UTF-8"), "{warnings:?}");
}

#[test]
fn clips_keep_what_is_longer() {
    let clip = |stop: f64, keys: &[(f64, f64)]| {
        let mut fbx = Fbx::new(100.0);
        let node = fbx.node("a", "Null", 0, &[]);
        let layer = fbx.take("walk", stop);
        fbx.curve(layer, (node, "Lcl Translation", "d|X"), 4, keys);
        let (glb, warnings) = fbx.glb();
        (glb.duration(0), warnings)
    };
    assert_eq!(clip(1.0, &[(0.0, 0.0), (1.0, 1.0)]), (1.0, Vec::new()));
    // A frame more or less.
    assert_eq!(clip(1.0, &[(0.0, 0.0), (0.96, 1.0)]), (1.0, Vec::new()));
    assert_eq!(clip(1.0, &[(0.0, 0.0), (1.04, 1.0)]), (1.0, Vec::new()));
    let (duration, warnings) = clip(3.0, &[(0.0, 0.0), (1.25, 1.0)]);
    assert!(duration == 3.0 && warnings.len() == 1, "{duration} {warnings:?}");
    assert!(["walk", "1.250 s", "3.000 s"].iter().all(|part| warnings[0].contains(part)), "{warnings:?}");
    let (duration, warnings) = clip(1.0, &[(0.0, 0.0), (2.5, 1.0)]);
    assert!(duration == 2.5 && warnings.len() == 1, "{duration} {warnings:?}");
    assert!(["walk", "LocalStop", "1.000 s", "2.500 s"].iter().all(|part| warnings[0].contains(part)), "{warnings:?}");
}

#[test]
fn repeating_curves_repeat_but_not_for_ever() {
    let repeat = |secs: f64, period: f64| {
        let mut fbx = Fbx::new(100.0);
        let node = fbx.node("a", "Null", 0, &[]);
        let layer = fbx.take("loop", secs);
        fbx.curve(layer, (node, "Lcl Translation", "d|X"), 4, &[(0.0, 0.0), (period, 1.0)]);
        let text =
            fbx.text().replace("KeyVer: 4008", "KeyVer: 4008\nPost-Extrapolation: {\nType: R\nRepetition: -1\n}");
        Glb::new(&gaitway_fbx::convert(text.as_bytes()).unwrap().bytes)
    };
    let glb = repeat(10.0, 2.0);
    for time in [0.5, 2.5, 7.25, 9.75] {
        assert_near(position(&glb, Some((0, time)), "a"), [time % 2.0 / 2.0, 0.0, 0.0]);
    }
    let start = std::time::Instant::now();
    assert_eq!(repeat(80_000.0, 1e-4).duration(0), 80_000.0);
    assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
}

#[test]
fn what_is_not_fbx_says_so() {
    for (bytes, expected) in [
        (&b""[..], "the FBX file is empty"),
        (&b"glTF\x02\0\0\0"[..], "this is not an FBX file"),
        (&b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"[..], "this is not an FBX file"),
        (&b"Dear reader,\nthis is a letter.\n"[..], "this is not an FBX file"),
        (&b"Kaydara FBX Binary  \0\x1a\0\xd0\x07\0\0"[..], "this is FBX version 2000, expected 3000 to 7700"),
        (&b"Kaydara FBX Binary  \0\x1a\0\0\0\0\0"[..], "the FBX file is damaged: it states version 0, expected"),
        (&b"Kaydara FBX Binary   \x1a "[..], "its zero bytes were changed"),
        (&b"Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0"[..], "the FBX file"),
        (&b"; FBX 7.4.0 project file\nObjects: {"[..], "the FBX file"),
    ] {
        let error = gaitway_fbx::convert(bytes).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}

/// As an interrupted download leaves them: where the file ends, what was expected there, what to do.
#[test]
fn a_file_that_is_cut_off_says_where() {
    let text = character();
    let half = &text.as_bytes()[..text.len() / 2];
    let lines = half.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let error = gaitway_fbx::convert(half).unwrap_err();
    assert!(error.starts_with(&format!("the FBX file is cut off in line {lines}: expected ")), "{error}");
    assert!(error.ends_with("found the end of the file. Copy or download it again, or export it again."), "{error}");
    for (version, width) in [(7400_u32, 4), (7700, 8)] {
        let mut bytes = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
        bytes.extend(version.to_le_bytes());
        for place in [1000_u64, 0, 0] {
            bytes.extend(&place.to_le_bytes()[..width]);
        }
        bytes.extend(b"\x07Objects");
        let error = gaitway_fbx::convert(&bytes).unwrap_err();
        let found = bytes.len();
        let expected = format!("cut off in its part \"Objects\": expected at least 1000 bytes, found {found}. Copy");
        assert!(error.contains(&expected), "{error}");
    }
}
