//! What the objects of a file become.

use std::f64::consts::FRAC_1_SQRT_2;

use serde_json::{Value, json};

use crate::encode::{binary, container, packed, text};
use crate::glb::Glb;

const IDENTITY: &str = "1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;;";

/// Two joints, a skinned square of two materials, and a clip with keys of all kinds.
pub const CHARACTER: &str = r#"
template Animation { <3D82AB4F-62DA-11cf-AB39-0020AF71E433> [...] }
// A comment { that is skipped
Frame hips { # another
  FrameTransformMatrix { 1.0,0.0,0.0,0.0, 0.0,1.0,0.0,0.0, 0.0,0.0,1.0,0.0, 0.5,2.0,3.0,1.0;; }
  Frame chest { FrameTransformMatrix { 0.0,1.0,0.0,0.0,-1.0,0.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,1.0,0.0,1.0;; } }
}
Frame body {
  Mesh square {
    4; 0.0;0.0;1.0;, 0.0;1.0;1.0;, 1.0;1.0;1.0;, 1.0;0.0;1.0;;
    2; 3;0,1,2;, 3;0,2,3;;
    MeshNormals { 2; 0.0;0.0;-2.0;, 0.0;0.0;2.0;; 2; 3;0,0,0;, 3;0,0,1;; }
    MeshTextureCoords { 4; 0.0;1.0;, 0.0;0.0;, 1.0;0.0;, 1.0;1.0;; }
    VertexDuplicationIndices { 4; 4; 0,1,2,3; }
    MeshMaterialList {
      2; 2; 0, 1;
      Material skin { 0.5;0.5;0.5;1.0;; 8.0; 1.0;1.0;1.0;; 0.0;0.0;0.0;; TextureFileName { "C:\art\skin#1.png"; } }
      { glass }
    }
    XSkinMeshHeader { 2; 2; 2; }
    SkinWeights { "hips"; 2; 0, 1; 1.0, 0.25; 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,-0.5,-2.0,-3.0,1.0;; }
    SkinWeights { "chest"; 2; 1, 2; 0.75, 3.0; 1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;; }
  }
}
Material glass { 1.0;0.0;1.0;0.5;; 0.0; 0.0;0.0;0.0;; 0.0;1.0;0.0;; }
AnimTicksPerSecond { 10; }
AnimationSet Wave {
  Animation {
    { hips }
    AnimationKey { 2; 3; 0;3;0.0,0.0,0.0;;, 5;3;1.0,2.0,4.0;;, 10;3;1.0,0.0,0.0;;; }
    AnimationKey { 1; 2; 0;3;1.0,1.0,1.0;;, 10;3;2.0,4.0,8.0;;; }
    AnimationKey { 0; 2; 0;4;1.0,0.0,0.0,0.0;;, 10;4;0.5,0.5,0.5,0.5;;; }
    AnimationOptions { 1; 1; }
  }
  Animation {
    AnimationKey { 4; 2; 0;16;1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;;, 10;16;
      0.0,0.0,2.0,0.0,0.0,2.0,0.0,0.0,-2.0,0.0,0.0,0.0,0.0,0.0,5.0,1.0;;; }
    { chest }
  }
}
"#;

/// Converts objects and returns the document and its warnings.
pub fn convert(objects: &str) -> (Glb, Vec<String>) {
    let output = gaitway_x::convert(&text(objects)).unwrap();
    (Glb::new(&output.bytes), output.warnings)
}

/// Converts objects that give no warnings.
fn clean(objects: &str) -> Glb {
    let (glb, warnings) = convert(objects);
    assert_eq!(warnings, [""; 0]);
    glb
}

/// A frame "a" with a mesh of these vertices and faces; `more` is inside the mesh.
fn mesh(vertices: &[[f32; 3]], faces: &[&[u32]], more: &str) -> String {
    let vertices: Vec<String> = vertices.iter().map(|[x, y, z]| format!("{x:?};{y:?};{z:?};")).collect();
    let count = faces.len();
    let faces: Vec<String> = faces
        .iter()
        .map(|face| format!("{};{};", face.len(), face.iter().map(u32::to_string).collect::<Vec<_>>().join(",")))
        .collect();
    format!("Frame a {{ Mesh {{ {};{};{count};{};{more} }} }}", vertices.len(), vertices.join(","), faces.join(","))
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]];

fn attribute(glb: &Glb, primitive: usize, name: &str) -> Vec<f64> {
    glb.accessor(&glb.list("meshes")[0]["primitives"][primitive]["attributes"][name])
}

fn near(found: &[f64], expected: &[f64]) {
    let same = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(same, "{found:?} instead of {expected:?}");
}

#[test]
fn all_encodings_give_the_same() {
    let as_text = text(CHARACTER);
    let expected = gaitway_x::convert(&as_text).unwrap();
    // Only text files have comments and the GUIDs of templates.
    let plain: String = CHARACTER.lines().skip(3).collect::<Vec<_>>().join("\n").replace("{ # another", "{");
    let (narrow, wide) = (binary(&plain, 4), binary(&plain, 8));
    for file in [&narrow, &wide, &packed(&as_text), &packed(&narrow), &packed(&wide)] {
        assert_eq!(gaitway_x::convert(file).unwrap(), expected, "{}", file[..16].escape_ascii());
    }
}

#[test]
fn a_block_may_refer_to_the_ones_before() {
    let objects = "Frame a { }   ";
    let first = text(objects)[16..].to_vec();
    let length = first.len();
    // A final block with fixed codes: 3 bytes from 1 byte back (codes 0000001 and 00000), then its end (0000000).
    let spaces = vec![0b0000_0011, 0b0000_0010, 0b0000_0000];
    let stream = miniz_oxide::deflate::compress_to_vec(&first, 6);
    let blocks = [(length, stream), (3, spaces)];
    let file = container(b"xof 0303txt 0032", 16 + length + 3, blocks.into_iter());
    let output = gaitway_x::convert(&file).unwrap();
    assert_eq!(Glb::new(&output.bytes).list("nodes")[0]["name"], "a");
}

#[test]
fn frames_become_nodes_of_right_handed_space() {
    let glb = clean(CHARACTER);
    let names: Vec<&Value> = glb.list("nodes").iter().map(|node| &node["name"]).collect();
    assert_eq!(names, [&json!("hips"), &json!("chest"), &json!("body"), &Value::Null]);
    assert_eq!(glb.list("nodes")[0]["translation"], json!([0.5, 2, -3]));
    let turned = &glb.list("nodes")[1];
    assert_eq!(turned["translation"], json!([0, 1, 0]));
    let rotation: Vec<f64> = turned["rotation"].as_array().unwrap().iter().map(|part| part.as_f64().unwrap()).collect();
    near(&rotation, &[0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    // The joints have no common root in the file.
    assert_eq!(glb.json["scenes"][0]["nodes"], json!([3]));
    assert_eq!(glb.list("nodes")[3]["children"], json!([0, 2]));
    let generator = glb.json["asset"]["generator"].as_str().unwrap();
    assert!(generator.ends_with("from .x"), "{generator}");
}

#[test]
fn corners_with_different_normals_are_vertices_of_their_own() {
    let glb = clean(CHARACTER);
    assert_eq!(glb.list("meshes")[0]["name"], "square");
    near(&attribute(&glb, 0, "POSITION"), &[0.0, 0.0, -1.0, 0.0, 1.0, -1.0, 1.0, 1.0, -1.0]);
    near(&attribute(&glb, 1, "POSITION"), &[0.0, 0.0, -1.0, 1.0, 1.0, -1.0, 1.0, 0.0, -1.0]);
    near(&attribute(&glb, 1, "NORMAL"), &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0]);
    near(&attribute(&glb, 0, "TEXCOORD_0"), &[0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let indices = glb.accessor(&glb.list("meshes")[0]["primitives"][0]["indices"]);
    assert_eq!(indices, [0.0, 2.0, 1.0], "the front is counter-clockwise");
    // Equal normals don't split a vertex, whatever their numbers are.
    let normals = "MeshNormals { 4; 0.0;0.0;1.0;,0.0;0.0;1.0;,0.0;0.0;1.0;,1.0;0.0;0.0;; 2; 3;0,1,2;,3;1,2,3;; }";
    let glb = clean(&mesh(&SQUARE, &[&[0, 1, 2], &[0, 2, 3]], normals));
    assert_eq!(attribute(&glb, 0, "POSITION").len(), 3 * 4);
}

#[test]
fn vertices_may_be_declared_as_direct3d_has_them() {
    // A packed tangent, a normal, texture coordinates.
    let words = |vertex: usize| {
        let [x, y, _] = SQUARE[vertex];
        let floats = [0.0, 0.0, -4.0, x, 1.0 - y].map(f32::to_bits).map(|bits| bits.to_string());
        format!("7,{}", floats.join(","))
    };
    let data = |count: usize| {
        let vertices: Vec<String> = (0..count).map(words).collect();
        let elements = "3; 14;0;6;0;, 2;0;3;0;, 1;0;5;0;;";
        mesh(&SQUARE, &[&[0, 1, 2, 3]], &format!("DeclData {{ {elements} {}; {}; }}", 6 * count, vertices.join(",")))
    };
    let glb = clean(&data(4));
    assert_eq!(attribute(&glb, 0, "NORMAL"), [0.0, 0.0, 1.0].repeat(4));
    assert_eq!(attribute(&glb, 0, "TEXCOORD_0"), [0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
    let problem = gaitway_x::convert(&text(&data(3))).unwrap_err();
    assert!(problem.contains("6 values for each of 4 vertices") && problem.contains("found 18"), "{problem}");
}

#[test]
fn faces_of_any_size_become_triangles() {
    // An arrow head: a fan from its first corner would cover area outside it.
    let concave = [[0.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, 0.0], [-1.0, -1.0, 0.0]];
    let area = |vertices: &[[f32; 3]], faces: &[&[u32]]| -> (usize, f64, f64) {
        let glb = clean(&mesh(vertices, faces, ""));
        let positions = attribute(&glb, 0, "POSITION");
        let indices = glb.accessor(&glb.list("meshes")[0]["primitives"][0]["indices"]);
        let at = |index: f64| [positions[3 * index as usize], positions[3 * index as usize + 1]];
        let areas = indices.chunks(3).map(|triangle| {
            let [a, b, c] = [at(triangle[0]), at(triangle[1]), at(triangle[2])];
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        });
        let areas: Vec<f64> = areas.collect();
        (areas.len(), areas.iter().sum(), areas.iter().map(|area| area.abs()).sum())
    };
    // Both are clockwise in the file. The sums agree if no triangle is turned over.
    assert_eq!(area(&SQUARE, &[&[0, 1, 2, 3]]), (2, 1.0, 1.0));
    assert_eq!(area(&concave, &[&[0, 1, 2, 3]]), (2, 1.0, 1.0));
    assert_eq!(area(&SQUARE, &[&[0, 1, 2], &[0, 2, 3], &[], &[1], &[1, 2]]).0, 2, "points and lines have no triangles");
}

#[test]
fn materials_are_metallic_roughness() {
    let glb = clean(CHARACTER);
    let [skin, glass] = glb.list("materials") else { panic!() };
    assert_eq!(skin["name"], "skin");
    let surface = &skin["pbrMetallicRoughness"];
    assert_eq!(surface["baseColorFactor"], json!([1, 1, 1, 1]), "the texture takes the colour's place");
    assert_eq!((&surface["metallicFactor"], &surface["baseColorTexture"]["index"]), (&json!(0), &json!(0)));
    assert!((surface["roughnessFactor"].as_f64().unwrap() - 0.2_f64.sqrt()).abs() < 1e-6);
    assert_eq!((&skin["alphaMode"], &skin["emissiveFactor"]), (&Value::Null, &Value::Null));
    assert_eq!(glb.list("images")[0], json!({ "name": "skin#1.png", "uri": "skin%231.png" }));
    assert_eq!(glass["pbrMetallicRoughness"]["baseColorFactor"], json!([1, 0, 1, 0.5]));
    assert_eq!(glass["pbrMetallicRoughness"]["roughnessFactor"], 1);
    assert_eq!((&glass["alphaMode"], &glass["emissiveFactor"]), (&json!("BLEND"), &json!([0, 1, 0])));
    let of_primitives: Vec<_> = (0..2).map(|at| &glb.list("meshes")[0]["primitives"][at]["material"]).collect();
    assert_eq!(of_primitives, [0, 1]);
    // Faces beyond the list have its last material; emission is seen through the texture.
    let list = r#"MeshMaterialList { 1; 1; 0;
        Material { 1.0;1.0;1.0;1.0;; 0.0; 0.0;0.0;0.0;; 1.0;1.0;1.0;; TextureFilename { "a.png"; } } }"#;
    let glb = clean(&mesh(&SQUARE, &[&[0, 1, 2], &[0, 2, 3]], list));
    assert_eq!(glb.list("meshes")[0]["primitives"].as_array().unwrap().len(), 1);
    assert_eq!(glb.list("materials")[0]["emissiveTexture"]["index"], 0);
}

#[test]
fn vertices_follow_their_joints() {
    let glb = clean(CHARACTER);
    assert_eq!(glb.list("skins")[0]["joints"], json!([0, 1, 2]), "the last is the mesh's own, for what no joint moves");
    let rest = glb.pose(None);
    let vertices = glb.vertices(&rest);
    // In the file's space: the first vertex is bound to the hips where they are; the third follows the chest, which is
    // turned by a quarter about Z and has its bind pose at the origin.
    near(&vertices[0], &[0.0, 0.0, -1.0]);
    near(&vertices[2], &[0.5 - 1.0, 2.0 + 1.0 + 1.0, -(3.0 + 1.0)]);
    let mixed = [0.25 * 0.0 + 0.75 * (0.5 - 1.0), 0.25 * 1.0 + 0.75 * 3.0, -(0.25 * 1.0 + 0.75 * 4.0)];
    near(&vertices[1], &mixed);
    let unbound = vertices.last().unwrap();
    near(unbound, &[1.0, 0.0, -1.0]);
}

#[test]
fn sixteen_influences_are_kept() {
    let joints: String = (0..20).map(|joint| format!("Frame j{joint} {{ }} ")).collect();
    let weights = (0..20).map(|joint| format!("SkinWeights {{ \"j{joint}\"; 1; 0; {}.5; {IDENTITY} }} ", joint + 1));
    let mesh = mesh(&SQUARE, &[&[0, 1, 2]], &weights.collect::<String>());
    let (glb, warnings) = convert(&format!("{joints}{mesh}"));
    assert!(matches!(&warnings[..], [one] if one.contains("20 joints") && one.contains("16")), "{warnings:?}");
    let sums: f64 = (0..4).map(|set| attribute(&glb, 0, &format!("WEIGHTS_{set}"))[..4].iter().sum::<f64>()).sum();
    assert!((sums - 1.0).abs() < 1e-6);
    assert_eq!(attribute(&glb, 0, "JOINTS_0")[..4], [19.0, 18.0, 17.0, 16.0]);
    // A frame that is bound twice.
    let twice = format!("SkinWeights {{ \"j\"; 1; 0; 1.0; {IDENTITY} }} ").repeat(2);
    let glb = clean(&format!("Frame j {{ }} {}", self::mesh(&SQUARE, &[&[0, 1, 2]], &twice)));
    let joints = glb.list("skins")[0]["joints"].as_array().unwrap();
    assert_eq!(joints.len(), 3);
    assert!(joints[0] != joints[1] && glb.list("nodes")[0]["children"] == json!([joints[1]]));
}

#[test]
fn keys_are_turned_mirrored_and_timed() {
    let glb = clean(CHARACTER);
    let [clip] = glb.list("animations") else { panic!() };
    assert_eq!(clip["name"], "Wave");
    assert!((glb.duration(0) - 1.0).abs() < 1e-6, "10 ticks of a tenth of a second");
    let end = glb.pose(Some((0, 1.0)));
    // The quaternion 0.5, 0.5, 0.5, 0.5 is a third of a turn about (1, 1, 1) that takes X to Z there, as rows:
    // Direct3D's quaternions of animation keys turn the other way round. In right-handed space, Z points the other way.
    let hips = end.worlds[0];
    near(&hips[0][..3], &[0.0, 0.0, -2.0]);
    near(&hips[1][..3], &[4.0, 0.0, 0.0]);
    near(&hips[2][..3], &[0.0, -8.0, 0.0]);
    near(&hips[3][..3], &[1.0, 0.0, 0.0]);
    let half = glb.pose(Some((0, 0.5)));
    near(&half.worlds[0][3][..3], &[1.0, 2.0, -4.0]);
    // The same with matrices: rows 0 0 2, 0 2 0, -2 0 0.
    let chest = clean(&CHARACTER.replace("{ hips }", "{ body }")).pose(Some((0, 1.0))).worlds[1];
    near(&chest[0][..3], &[0.0, 0.0, -2.0]);
    near(&chest[1][..3], &[0.0, 2.0, 0.0]);
    near(&chest[2][..3], &[2.0, 0.0, 0.0]);
    near(&chest[3][..3], &[0.5, 2.0, -3.0 - 5.0]);
}

/// A model in one file, and its motion in another.
#[test]
fn animation_alone_is_a_motion_of_the_frames_that_it_names() {
    let (_, animation) = CHARACTER.split_once("AnimTicksPerSecond").unwrap();
    let (glb, warnings) = convert(&format!("AnimTicksPerSecond{animation}"));
    assert!(warnings.len() == 1 && warnings[0].contains("animation alone"), "{warnings:?}");
    let whole = clean(CHARACTER);
    assert_eq!((glb.node("hips"), glb.node("chest"), glb.list("nodes").len()), (0, 1, 2));
    let [found, expected] = [&glb, &whole].map(|glb| glb.list("animations")[0].clone());
    assert_eq!(found["channels"], expected["channels"]);
    for (found, expected) in found["samplers"].as_array().unwrap().iter().zip(expected["samplers"].as_array().unwrap())
    {
        for accessor in ["input", "output"] {
            assert_eq!(glb.accessor(&found[accessor]), whole.accessor(&expected[accessor]));
        }
    }
    // The joints rest where the motion begins.
    assert_eq!(glb.pose(None).worlds, glb.pose(Some((0, 0.0))).worlds);
}

/// Positions at 0, `step` and `end`.
fn moving(ticks: &str, step: u32, end: u32) -> (Glb, Vec<String>) {
    convert(&format!(
        "{ticks} Frame a {{ }} AnimationSet {{ Animation {{ {{a}} AnimationKey {{ 2; 3;
            0;3;0.0,0.0,0.0;;,{step};3;1.0,0.0,0.0;;,{end};3;2.0,0.0,0.0;;; }} }} }}"
    ))
}

#[test]
fn ticks_become_seconds() {
    for (ticks, step, end, secs, warnings) in [
        ("AnimTicksPerSecond { 30; }", 1, 60, 2.0, 0),
        ("", 160, 9600, 2.0, 0),
        ("AnimTicksPerSecond { 0; }", 160, 9600, 2.0, 0),
        // Keys in frames, without a declaration.
        ("", 1, 50, 2.0, 1),
        ("", 1, 20, 0.8, 1),
    ] {
        let (glb, found) = moving(ticks, step, end);
        assert!((glb.duration(0) - secs).abs() < 1e-6, "{ticks} {step} {end}: {}", glb.duration(0));
        assert_eq!(found.len(), warnings, "{found:?}");
        assert!(found.iter().all(|warning| warning.contains("25 were assumed")), "{found:?}");
    }
}

#[test]
fn keys_in_any_order_ascend() {
    let key = |ticks: u32, x: f32| format!("{ticks};3;{x:?},0.0,0.0;;,");
    let keys: String = [(4800, 3.0), (0, 1.0), (9600, 4.0), (4800, 2.0)].map(|(ticks, x)| key(ticks, x)).concat();
    let set = format!("Frame a {{ }} AnimationSet {{ Animation {{ {{a}} AnimationKey {{ 2; 4; {keys}; }} }} }}");
    let sampler = &clean(&set).list("animations")[0]["samplers"][0].clone();
    let glb = clean(&set);
    assert_eq!(glb.accessor(&sampler["input"]), [0.0, 1.0, 2.0]);
    assert_eq!(glb.accessor(&sampler["output"]), [1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
}

#[test]
fn keys_are_apart_in_seconds_too() {
    let keys = "0;3;0.0,0.0,0.0;;,400000000;3;1.0,0.0,0.0;;,400000001;3;2.0,0.0,0.0;;,500000000;3;3.0,0.0,0.0;;;";
    let glb = clean(&format!("Frame a {{ }} AnimationSet {{ Animation {{ {{a}} AnimationKey {{ 2; 4; {keys} }} }} }}"));
    assert_eq!(glb.accessor(&glb.list("animations")[0]["samplers"][0]["input"]).len(), 3);
}

#[test]
fn what_never_changes_has_two_keys_and_no_scale() {
    let matrix = IDENTITY.replace(";;", "");
    let keys: String = (0..5).map(|at| format!("{};16;{matrix};;,", 480 * at)).collect();
    let glb =
        clean(&format!("Frame a {{ }} AnimationSet {{ Animation {{ {{a}} AnimationKey {{ 4; 5; {keys}; }} }} }}"));
    let paths: Vec<_> = (0..2).map(|at| &glb.list("animations")[0]["channels"][at]["target"]["path"]).collect();
    assert_eq!(paths, ["translation", "rotation"]);
    assert_eq!(glb.list("animations")[0]["channels"].as_array().unwrap().len(), 2);
    near(&glb.accessor(&glb.list("animations")[0]["samplers"][0]["input"]), &[0.0, 0.4]);
    // Unlike a frame that has another scale than its keys.
    let scaled = "FrameTransformMatrix { 2.0,0.0,0.0,0.0,0.0,2.0,0.0,0.0,0.0,0.0,2.0,0.0,0.0,0.0,0.0,1.0;; }";
    let set = format!("AnimationSet {{ Animation {{ {{a}} AnimationKey {{ 4; 5; {keys}; }} }} }}");
    let glb = clean(&format!("Frame a {{ {scaled} }} {set}"));
    near(&glb.pose(Some((0, 0.2))).worlds[0][0][..3], &[1.0, 0.0, 0.0]);
}

#[test]
fn meshes_are_where_frames_show_them() {
    let triangle = "3; 0.0;0.0;0.0;,0.0;1.0;0.0;,1.0;0.0;0.0;; 1; 3;0,1,2;;";
    let glb = clean(&format!(
        "Mesh shared {{ {triangle} }} Mesh alone {{ {triangle} }} Frame a {{ {{ shared }} Mesh own {{ {triangle} }} }}
         Frame b {{ {{ shared <3D82AB4F-62DA-11cf-AB39-0020AF71E433> }} }}"
    ));
    let shown = |node: usize| &glb.list("meshes")[glb.list("nodes")[node]["mesh"].as_u64().unwrap() as usize]["name"];
    let leaf = glb.list("nodes")[0]["children"][0].as_u64().unwrap() as usize;
    assert_eq!([shown(0), shown(leaf), shown(1), shown(2)], ["shared", "own", "shared", "alone"]);
    assert_eq!((glb.list("meshes").len(), &glb.list("nodes")[2]["name"]), (3, &json!("alone")));
}

#[test]
fn a_sheared_frame_keeps_its_matrix() {
    let sheared = "FrameTransformMatrix { 1.0,1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,4.0,1.0;; }";
    let glb = clean(&format!("Frame a {{ {sheared} }}"));
    assert_eq!(glb.list("nodes")[0]["matrix"], json!([1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -4, 1]));
    // Mirroring isn't a shear.
    let mirror = "FrameTransformMatrix { -1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;; }";
    let glb = clean(&format!("Frame a {{ {mirror} }}"));
    near(&glb.pose(None).worlds[0].concat(), &[-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
}

#[test]
fn names_may_be_odd() {
    let mut objects =
        b"xof 0302txt 0064\r\nFrame 12 { Frame Bip01_L-Hand.1 { } Frame \xE4rm { } Frame { } } \x1a".to_vec();
    let output = gaitway_x::convert(&objects).unwrap();
    let names =
        |bytes: &[u8]| Glb::new(bytes).list("nodes").iter().map(|node| node["name"].clone()).collect::<Vec<_>>();
    // A byte in an unknown encoding.
    assert_eq!(names(&output.bytes), [json!("12"), json!("Bip01_L-Hand.1"), json!("\u{F7E4}rm"), Value::Null]);
    objects.retain(|&byte| byte != b'\r');
    assert_eq!(gaitway_x::convert(&objects).unwrap(), output);
}

#[test]
fn what_is_left_out_is_said() {
    let check = |objects: &str, expected: &str| {
        let (_, warnings) = convert(objects);
        assert!(matches!(&warnings[..], [one] if one.contains(expected)), "{expected}: {warnings:?}");
    };
    let set = |target: &str, key: &str| {
        format!("Frame a {{ }} AnimationSet {{ Animation {{ {target} AnimationKey {{ {key} }} }} }}")
    };
    let key = "2; 1; 480;3;0.0,0.0,0.0;;;";
    check("Frame a { Camera { 1.0; Lens { 2.0; } } }", "kind \"Camera\"");
    check(&set("{ b }", key), "\"b\" left out: no frame has that name");
    check(&set("", key), "line 2) left out: it doesn't say what it moves");
    check(&set("{ a } AnimationKey { 2; 1; 480;3;0.0,0.0,0.0;;; }", key), "its frame is animated already");
    let shear = "4; 1; 480;16;1.0,1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;;;";
    check(&set("{ a }", shear), "sheared");
    check(
        &mesh(&SQUARE, &[&[0, 1, 2]], &format!("SkinWeights {{ \"b\"; 1; 0; 1.0; {IDENTITY} }}")),
        "Joint \"b\" left out",
    );
    check(&mesh(&SQUARE, &[&[0, 1, 2]], "MeshNormals { 1; 0.0;0.0;1.0;; 1; 4;0,0,0,0;; }"), "not those of the mesh");
    check(&mesh(&SQUARE, &[&[0, 1, 2]], "").replace("1.0", "-1.#IND00"), "not finite, read as 0: 4");
}
