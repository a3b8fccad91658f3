//! A model with everything in it, built here, and what has to be in its file.

use std::collections::BTreeSet;

use gaitway_character::asset::{Asset, CameraProjection, LightKind};
use gaitway_fbx_writer::{FbxOptions, FbxRecipient, fbx};
use serde_json::{Value, json};
use ufbx::{Interpolation, Scene};

use crate::read::{asset, compare};

/// A grey pixel.
const PNG: &[u8] =
    b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0:~\x9bU\0\0\0\nIDATx\x9ch\0\0\0\x82\0\x81w\xcdr\xb6\
\0\0\0\0IEND\xaeB`\x82";

/// A glTF under construction.
struct Model {
    json: Value,
    binary: Vec<u8>,
}

impl Model {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        self.binary.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    }

    fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let view = self.view(&values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>());
        let mut accessor =
            json!({ "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind });
        let bound = |start: f32, pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..width).map(|at| values.iter().skip(at).step_by(width).copied().fold(start, pick)).collect()
        };
        accessor["min"] = json!(bound(f32::INFINITY, f32::min));
        accessor["max"] = json!(bound(f32::NEG_INFINITY, f32::max));
        self.push("accessors", accessor)
    }

    fn bytes(&mut self, kind: &str, width: usize, values: &[u8]) -> usize {
        let view = self.view(values);
        let accessor =
            json!({ "bufferView": view, "componentType": 5121, "count": values.len() / width, "type": kind });
        self.push("accessors", accessor)
    }

    fn channel(
        &mut self,
        clip: &mut Value,
        (node, path): (usize, &str),
        kind: (&str, usize),
        interpolation: &str,
        keys: [&[f32]; 2],
    ) {
        let input = self.floats("SCALAR", 1, keys[0]);
        let output = self.floats(kind.0, kind.1, keys[1]);
        let samplers = clip["samplers"].as_array_mut().unwrap();
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        let sampler = samplers.len() - 1;
        let channel = json!({ "sampler": sampler, "target": { "node": node, "path": path } });
        clip["channels"].as_array_mut().unwrap().push(channel);
    }

    fn glb(mut self) -> Vec<u8> {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        let mut json = serde_json::to_vec(&self.json).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut glb = b"glTF".to_vec();
        let length = 12 + 8 + json.len() + 8 + self.binary.len();
        [2, length as u32, json.len() as u32].iter().for_each(|word| glb.extend(word.to_le_bytes()));
        glb.extend(b"JSON");
        glb.extend(json);
        glb.extend((self.binary.len() as u32).to_le_bytes());
        glb.extend(b"BIN\0");
        glb.extend(self.binary);
        glb
    }
}

const NODES: [&str; 14] = [
    "Armature", "Hips", "hips", "Chest", "Head", "Hand", "Body", "Prop", "Mirrored", "Camera", "Wide", "Lamp", "Sun",
    "Spot",
];

/// Returns a GLB with six influences per vertex, uneven and negative scales, all interpolations, a rotation through the pole, names
/// that differ in capitals, two sets of texture coordinates, colours, a blend shape, cameras and lights.
pub fn everything() -> Vec<u8> {
    let mut model = Model { json: scene(), binary: Vec::new() };
    add_mesh(&mut model);
    let matrix = |y: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -y, 0.0, 1.0];
    let matrices: Vec<f32> = [0.5, 0.7, 1.0, 1.3, 0.9].into_iter().flat_map(matrix).chain(matrix(0.0)).collect();
    let matrices = model.floats("MAT4", 16, &matrices);
    model.push("skins", json!({ "name": "Skin", "joints": [1, 2, 3, 4, 5, 0], "inverseBindMatrices": matrices }));
    add_clips(&mut model);
    model.glb()
}

fn scene() -> Value {
    let mut nodes = vec![
        json!({ "children": [1, 6], "rotation": [-0.5, 0.5, 0.5, 0.5], "scale": [0.5, 0.5, 0.5] }),
        json!({ "children": [2], "translation": [0.0, 0.5, 0.1] }),
        json!({ "children": [3], "translation": [0.0, 0.2, 0.0], "scale": [1.0, 1.5, 0.75] }),
        json!({ "children": [4, 5], "translation": [0.1, 0.3, 0.0], "rotation": [0.0, 0.0, 0.382_683_43, 0.923_879_5] }),
        json!({ "children": [7], "translation": [0.0, 0.3, 0.0], "rotation": [0.0, 0.707_106_77, 0.0, 0.707_106_77] }),
        json!({ "translation": [0.4, -0.1, 0.0], "scale": [-1.0, 1.0, 1.0] }),
        json!({ "mesh": 0, "skin": 0, "weights": [0.25] }),
        json!({ "mesh": 1, "translation": [0.0, 0.1, 0.0] }),
        json!({ "mesh": 1, "translation": [1.0, 0.0, 0.0], "scale": [1.0, -2.0, 1.0] }),
        json!({ "camera": 0, "translation": [0.0, 1.0, 3.0], "rotation": [0.0, 0.382_683_43, 0.0, 0.923_879_5] }),
        json!({ "camera": 1, "translation": [0.0, 1.0, 4.0] }),
        json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [0.0, 2.0, 0.0] }),
        json!({ "extensions": { "KHR_lights_punctual": { "light": 1 } }, "rotation": [-0.707_106_77, 0.0, 0.0, 0.707_106_77] }),
        json!({ "extensions": { "KHR_lights_punctual": { "light": 2 } } }),
    ];
    for (node, name) in nodes.iter_mut().zip(NODES) {
        node["name"] = json!(name);
    }
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "point", "intensity": 2.0, "color": [1.0, 0.5, 0.25] },
            { "type": "directional", "intensity": 0.5 },
            { "type": "spot", "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.6 } },
        ] } },
        "scene": 0,
        "scenes": [{ "nodes": [0, 8, 9, 10, 11, 12, 13] }],
        "nodes": nodes,
        "cameras": [
            { "name": "Tele", "type": "perspective", "perspective": { "yfov": 0.6, "znear": 0.1, "zfar": 50.0 } },
            { "name": "Flat", "type": "orthographic", "orthographic": { "xmag": 2.0, "ymag": 1.5, "znear": 0.2, "zfar": 30.0 } },
        ],
        "meshes": [], "skins": [], "animations": [], "accessors": [], "bufferViews": [], "images": [],
        "textures": [{ "source": 0 }],
        "materials": [
            { "name": "Skin", "alphaMode": "BLEND", "pbrMetallicRoughness": {
                "baseColorTexture": { "index": 0, "texCoord": 1 }, "metallicFactor": 0.0, "roughnessFactor": 0.4 } },
            { "name": "Cloth", "emissiveFactor": [0.1, 0.2, 0.3], "pbrMetallicRoughness": {
                "baseColorFactor": [0.2, 0.4, 0.6, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 } },
        ],
    })
}

fn add_mesh(model: &mut Model) {
    let image = model.view(PNG);
    model.push("images", json!({ "name": "../textures/skin.png", "mimeType": "image/png", "bufferView": image }));
    // Two quads that share an edge, with a seam there in the normals.
    let positions = [
        0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.5, 0.1, 0.2, 1.5, 0.1, 0.2, 0.0, 0.0, 0.2, 1.5, 0.1, 0.4, 0.0, 0.1, 0.4,
        1.4, 0.0,
    ];
    let normals = [[0.0, 0.0, 1.0]; 4].into_iter().chain([[0.6, 0.0, 0.8]; 4]).flatten().collect::<Vec<f32>>();
    let uvs: Vec<f32> = (0..16).map(|at| at as f32 / 16.0).collect();
    let others: Vec<f32> = (0..16).map(|at| 1.0 - at as f32 / 32.0).collect();
    let colors: Vec<f32> = (0..32).map(|at| (at % 8) as f32 / 8.0).collect();
    let offsets: Vec<f32> = (0..24).map(|at| if at % 3 == 0 { 0.1 } else { 0.0 }).collect();
    let joints: Vec<u8> = (0..8).flat_map(|_| [0, 1, 2, 3]).collect();
    let more: Vec<u8> = (0..8).flat_map(|_| [4, 5, 0, 0]).collect();
    let weights: Vec<f32> =
        (0..8).flat_map(|at| if at % 2 == 0 { [0.4, 0.3, 0.1, 0.05] } else { [0.1, 0.1, 0.3, 0.3] }).collect();
    let rest: Vec<f32> =
        (0..8).flat_map(|at| if at % 2 == 0 { [0.1, 0.05, 0.0, 0.0] } else { [0.15, 0.05, 0.0, 0.0] }).collect();
    let attributes = json!({
        "POSITION": model.floats("VEC3", 3, &positions),
        "NORMAL": model.floats("VEC3", 3, &normals),
        "TEXCOORD_0": model.floats("VEC2", 2, &uvs),
        "TEXCOORD_1": model.floats("VEC2", 2, &others),
        "COLOR_0": model.floats("VEC4", 4, &colors),
        "JOINTS_0": model.bytes("VEC4", 4, &joints),
        "JOINTS_1": model.bytes("VEC4", 4, &more),
        "WEIGHTS_0": model.floats("VEC4", 4, &weights),
        "WEIGHTS_1": model.floats("VEC4", 4, &rest),
    });
    let target = json!({ "POSITION": model.floats("VEC3", 3, &offsets) });
    let (one, two) = (model.bytes("SCALAR", 1, &[0, 1, 2, 2, 1, 3]), model.bytes("SCALAR", 1, &[4, 6, 5, 5, 6, 7]));
    let primitive = |indices: usize, material: usize| json!({ "attributes": attributes, "indices": indices, "material": material, "targets": [target] });
    let mesh = json!({ "name": "Body", "primitives": [primitive(one, 0), primitive(two, 1)],
        "weights": [0.0], "extras": { "targetNames": ["Smile"] } });
    model.push("meshes", mesh);
    let position = attributes["POSITION"].clone();
    model.push(
        "meshes",
        json!({ "name": "Prop", "primitives": [{ "attributes": { "POSITION": position }, "indices": one }] }),
    );
}

fn add_clips(model: &mut Model) {
    let mut clip = json!({ "name": "Move", "channels": [], "samplers": [] });
    let turn = |degrees: f32, axis: [f32; 3]| {
        let (sin, cos) = (0.5 * degrees).to_radians().sin_cos();
        [axis[0] * sin, axis[1] * sin, axis[2] * sin, cos]
    };
    // Through the pole of Y, and past a full turn.
    let turns: Vec<f32> =
        [0.0, 80.0, 170.0, 260.0, 350.0, 440.0].into_iter().flat_map(|d| turn(d, [0.0, 1.0, 0.0])).collect();
    let times = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25];
    model.channel(&mut clip, (1, "rotation"), ("VEC4", 4), "LINEAR", [&times, &turns]);
    let tilted: Vec<f32> = [10.0, 100.0, -70.0].into_iter().flat_map(|d| turn(d, [0.48, 0.6, 0.64])).collect();
    model.channel(&mut clip, (3, "rotation"), ("VEC4", 4), "LINEAR", [&[0.1, 0.6, 1.25], &tilted]);
    model.channel(
        &mut clip,
        (1, "translation"),
        ("VEC3", 3),
        "STEP",
        [&[0.0, 0.5, 1.0], &[0.0, 0.5, 0.1, 0.2, 0.5, 0.1, 0.0, 0.6, 0.0]],
    );
    let spline = [0.0, 0.0, 0.0, 0.1, 0.3, 0.0, 1.0, 0.5, 0.0, 0.0, -1.0, 0.0, 0.2, 0.4, 0.1, 0.0, 0.0, 0.0];
    model.channel(&mut clip, (3, "translation"), ("VEC3", 3), "CUBICSPLINE", [&[0.2, 1.0], &spline]);
    let of_head: Vec<f32> = [
        [0.0; 4],
        turn(90.0, [0.0, 1.0, 0.0]),
        [0.5, 0.0, 0.5, 0.0],
        [0.0, 0.5, 0.0, -0.5],
        turn(20.0, [1.0, 0.0, 0.0]),
        [0.0; 4],
    ]
    .into_iter()
    .flatten()
    .collect();
    model.channel(&mut clip, (4, "rotation"), ("VEC4", 4), "CUBICSPLINE", [&[0.0, 1.25], &of_head]);
    model.channel(&mut clip, (2, "scale"), ("VEC3", 3), "LINEAR", [&[0.0, 1.0], &[1.0, 1.5, 0.75, 1.2, 1.0, 1.0]]);
    model.channel(&mut clip, (6, "weights"), ("SCALAR", 1), "LINEAR", [&[0.0, 0.5, 1.25], &[0.0, 1.0, 0.5]]);
    model.push("animations", clip);
    let mut nod = json!({ "name": "move", "channels": [], "samplers": [] });
    let nods: Vec<f32> = [0.0, 30.0, 0.0].into_iter().flat_map(|d| turn(d, [1.0, 0.0, 0.0])).collect();
    model.channel(&mut nod, (4, "rotation"), ("VEC4", 4), "LINEAR", [&[0.0, 0.5, 2.0], &nods]);
    model.channel(&mut nod, (9, "translation"), ("VEC3", 3), "LINEAR", [&[0.0, 2.0], &[0.0, 1.0, 3.0, 0.0, 1.0, 5.0]]);
    model.push("animations", nod);
}

fn scene_of(bytes: &[u8]) -> ufbx::SceneRoot {
    ufbx::load_memory(bytes, ufbx::LoadOpts::default()).unwrap()
}

fn names(scene: &Scene) -> Vec<&str> {
    scene.nodes.into_iter().filter(|node| !node.is_root).map(|node| &*node.element.name).collect()
}

#[test]
fn everything_comes_back() {
    let glb = everything();
    let original = asset("model.glb", &glb);
    for recipient in FbxRecipient::ALL {
        let written = fbx(&glb, &FbxOptions { recipient, ..FbxOptions::default() }).unwrap();
        let read = asset("model.fbx", &written.bytes);
        let difference = compare("built", &original, &written, &read);
        // The reader measures its own error at joints.
        assert!(difference.joints < 1e-4 && difference.vertices < 2.5e-4, "{recipient:?}: {difference:?}");
        assert_eq!(written.warnings, [""; 0]);
        check_views(&original, &read);
    }
}

/// Cameras and lights look the same way, from the same place.
fn check_views(original: &Asset, read: &Asset) {
    use crate::read::Posed;
    let [before, after] = [original, read].map(|asset| Posed::new(asset, None));
    assert_eq!((original.cameras.len(), original.lights.len()), (read.cameras.len(), read.lights.len()));
    let view = |posed: &Posed, joint: gaitway_character::anim::JointIndex| {
        let world = posed.worlds[joint.get()];
        [world.translation, -world.matrix3.z_axis.normalize()]
    };
    for (a, b) in original.cameras.iter().zip(&read.cameras) {
        for (a, b) in view(&before, a.joint).iter().zip(view(&after, b.joint)) {
            assert!(a.distance(b) < 1e-4, "{}: {a} {b}", original.cameras[0].name);
        }
        match (a.projection, b.projection) {
            (
                CameraProjection::Perspective { y_fov_radians: a, .. },
                CameraProjection::Perspective { y_fov_radians: b, .. },
            ) => {
                assert!((a - b).abs() < 1e-4, "{a} {b}");
            }
            (CameraProjection::Orthographic { y_mag: a, .. }, CameraProjection::Orthographic { y_mag: b, .. }) => {
                assert!((a - b).abs() < 1e-3, "{a} {b}");
            }
            other => panic!("{other:?}"),
        }
    }
    for (a, b) in original.lights.iter().zip(&read.lights) {
        assert!((a.intensity - b.intensity).abs() < 1e-4 && a.color.distance(b.color) < 1e-4);
        // A point has no direction.
        for (a, b) in view(&before, a.joint).iter().zip(view(&after, b.joint)).take(if a.kind == LightKind::Point {
            1
        } else {
            2
        }) {
            assert!(a.distance(b) < 1e-4, "{a} {b}");
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bytes_without_paths() {
    let glb = everything();
    let [one, two] = [(); 2].map(|()| fbx(&glb, &FbxOptions::default()).unwrap().bytes);
    assert!(one == two);
    let scene = scene_of(&one);
    for texture in &scene.textures {
        assert_eq!(
            (&*texture.filename, &*texture.relative_filename, texture.content.len()),
            ("skin.png", "skin.png", PNG.len())
        );
    }
    assert_eq!(scene.textures.count, 1);
}

#[test]
fn names_are_unique_without_capitals() {
    let written = fbx(&everything(), &FbxOptions::default()).unwrap();
    let scene = scene_of(&written.bytes);
    let all = names(&scene);
    let distinct: BTreeSet<String> = all.iter().map(|name| name.to_lowercase()).collect();
    assert_eq!(distinct.len(), all.len(), "{all:?}");
    assert!(all.contains(&"Hips") && all.contains(&"hips_2"), "{all:?}");
    let stacks: Vec<&str> = scene.anim_stacks.into_iter().map(|stack| &*stack.element.name).collect();
    assert_eq!(stacks, ["Move", "move_2"]);
}

#[test]
fn each_recipient_gets_its_axes_and_unit() {
    for (recipient, up, metres) in [
        (FbxRecipient::AsIs, ufbx::CoordinateAxis::PositiveY, 0.01),
        (FbxRecipient::Unity, ufbx::CoordinateAxis::PositiveY, 0.01),
        (FbxRecipient::Unreal, ufbx::CoordinateAxis::PositiveZ, 0.01),
        (FbxRecipient::Blender, ufbx::CoordinateAxis::PositiveZ, 1.0),
    ] {
        let written = fbx(&everything(), &FbxOptions { recipient, ..FbxOptions::default() }).unwrap();
        let scene = scene_of(&written.bytes);
        assert_eq!((scene.settings.axes.up, scene.settings.unit_meters), (up, metres), "{recipient:?}");
        let armature = scene.nodes.into_iter().find(|node| &*node.element.name == "Armature").unwrap();
        let scale = if recipient == FbxRecipient::AsIs { 0.5 } else { 1.0 };
        assert!((armature.local_transform.scale.x - scale).abs() < 1e-6, "{recipient:?}");
    }
}

#[test]
fn steps_stay_steps_and_weights_stay() {
    let written = fbx(&everything(), &FbxOptions::default()).unwrap();
    let scene = scene_of(&written.bytes);
    let curves = || scene.anim_curves.into_iter();
    let steps = curves()
        .filter(|curve| curve.keyframes.into_iter().any(|key| key.interpolation == Interpolation::ConstantPrev));
    assert_eq!(steps.map(|curve| curve.keyframes.count).collect::<Vec<_>>(), [3, 3, 3]);
    assert!(curves().any(|curve| curve.keyframes.into_iter().any(|key| key.interpolation == Interpolation::Cubic)));
    let skin = scene.skin_deformers.first().unwrap();
    assert_eq!((skin.clusters.count, skin.max_weights_per_vertex), (6, 6));
    let mesh = scene.meshes.into_iter().find(|mesh| mesh.skin_deformers.count > 0).unwrap();
    // Of glTF's eight vertices, two differ in their normals alone.
    assert_eq!((mesh.num_vertices, mesh.num_triangles, mesh.uv_sets.count, mesh.color_sets.count), (7, 4, 2, 1));
    assert_eq!(scene.poses.count, 1);
}

#[test]
fn clips_alone_have_bones_and_nothing_else() {
    let written = fbx(&everything(), &FbxOptions { clips_only: true, ..FbxOptions::default() }).unwrap();
    let scene = scene_of(&written.bytes);
    assert_eq!((scene.meshes.count, scene.materials.count, scene.cameras.count, scene.lights.count), (0, 0, 0, 0));
    assert_eq!((scene.bones.count, scene.anim_stacks.count), (6, 2));
}

/// Written again, a file has the same names, hierarchy, rest, skins and poses.
#[test]
fn a_file_written_again_is_the_same() {
    let first = fbx(&everything(), &FbxOptions::default()).unwrap();
    let between = crate::read::glb_of("model.fbx", &first.bytes);
    let second = fbx(&between, &FbxOptions::default()).unwrap();
    let [a, b] = [&first, &second].map(|written| scene_of(&written.bytes));
    let nodes = |scene: &Scene| -> Vec<(String, String)> {
        let parent =
            |node: &ufbx::Node| node.parent.as_ref().map_or(String::new(), |parent| parent.element.name.to_string());
        let mut nodes: Vec<_> =
            scene.nodes.into_iter().map(|node| (node.element.name.to_string(), parent(node))).collect();
        nodes.sort();
        nodes
    };
    assert_eq!(nodes(&a), nodes(&b));
    for node in &a.nodes {
        let other = b.nodes.into_iter().find(|other| *other.element.name == *node.element.name).unwrap();
        let [one, two] = [node, other].map(|node| node.node_to_world);
        let off = [(one.m03, two.m03), (one.m13, two.m13), (one.m23, two.m23), (one.m00, two.m00), (one.m11, two.m11)];
        assert!(off.iter().all(|(a, b)| (a - b).abs() < 1e-3), "{}: {one:?} {two:?}", &*node.element.name);
    }
    let weights = |scene: &Scene| scene.skin_deformers.first().map(|skin| (skin.clusters.count, skin.weights.count));
    assert_eq!(weights(&a), weights(&b));
    let original = asset("model.fbx", &first.bytes);
    let difference = compare("again", &original, &second, &asset("model.fbx", &second.bytes));
    assert!(difference.joints < 1e-4 && difference.vertices < 2.5e-4, "{difference:?}");
}
