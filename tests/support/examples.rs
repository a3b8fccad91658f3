//! Small files of different kinds.

// Each test program uses a part of it.
#![allow(dead_code)]

use serde_json::json;

use crate::build_gltf::{Build, F32, U16, floats, shorts};

/// The header of a PNG of one pixel.
pub const PNG: &[u8] = &[
    0x89, b'P', b'N', b'G', 0x0D, 0x0A, 0x1A, 0x0A, 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0, 1, 0, 0, 0, 1, 8, 6,
    0, 0, 0, 0x1F, 0x15, 0xC4, 0x89,
];

/// Two triangles with normals, texture coordinates, indices and a normal texture, but without tangents. The second
/// triangle's texture is mirrored, so that the two vertices on the seam need two tangents each.
pub fn textured_square() -> Build {
    let mut build = Build::new();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    build.accessor(F32, "VEC3", 4, &floats(&corners));
    build.accessor(F32, "VEC3", 4, &floats(&[0.0, 0.0, 1.0].repeat(4)));
    // Vertices 0 and 2 are on the seam; 1 and 3 each have u on their own side of it.
    build.accessor(F32, "VEC2", 4, &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    build.accessor(U16, "SCALAR", 6, &shorts(&[0, 1, 2, 0, 2, 3]));
    let image = build.view(PNG);
    build.json["images"] = json!([{ "bufferView": image }]);
    build.json["textures"] = json!([{ "source": 0 }]);
    build.json["materials"] = json!([{ "normalTexture": { "index": 0 } }]);
    build.json["meshes"] = json!([{ "primitives": [{
        "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0,
    }] }]);
    build.json["nodes"] = json!([{ "mesh": 0 }]);
    build
}

/// A square with an image that takes a while.
pub fn large_image() -> Build {
    let mut build = textured_square();
    build.bytes.resize(300_000, 0);
    let image = build.json["images"][0]["bufferView"].as_u64().expect("an index") as usize;
    let start = build.json["bufferViews"][image]["byteOffset"].as_u64().expect("a number");
    build.json["bufferViews"][image]["byteLength"] = json!(300_000 - start);
    build
}

pub const PLACE: &str = "/nodes/0/translation";

pub const MOVES: [f32; 6] = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0];

/// The triangle with a material and a camera; its node moves by a pointer.
pub fn moving() -> Build {
    let mut build = Build::triangle();
    build.json["materials"] = json!([{ "pbrMetallicRoughness": {} }]);
    build.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }]);
    build.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    build.point(PLACE, "LINEAR", "VEC3", &[0.0, 1.0], &MOVES);
    build
}

/// A pointer of every kind, and a hidden node.
pub fn pointers() -> Build {
    let mut build = moving();
    build.json["nodes"][0]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
    build.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]);
    for (pointer, shape, values) in [
        ("/nodes/0/extensions/KHR_node_visibility/visible", "SCALAR", &[0.0, 1.0][..]),
        ("/meshes/0/weights", "SCALAR", &[0.0, 1.0]),
        ("/materials/0/pbrMetallicRoughness/baseColorFactor", "VEC4", &[0.5; 8]),
        ("/cameras/0/perspective/yfov", "SCALAR", &[0.5, 1.0]),
        ("/extensions/KHR_lights_punctual/lights/0/color", "VEC3", &[0.5; 6]),
    ] {
        build.point(pointer, "STEP", shape, &[0.0, 1.0], values);
    }
    build
}

/// A hip with one leg, in metres and of human size, and two frames.
pub const TWO_JOINTS: &str = "HIERARCHY
ROOT hip
{
\tOFFSET 0 1 0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT leg
\t{
\t\tOFFSET 0.5 -1 0
\t\tCHANNELS 3 Xrotation Yrotation Zrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 -0.5 0.5
\t\t}
\t}
}
MOTION
Frames: 2
Frame Time: 0.5
0 1 0 0 0 0 0 0 0
1 2 3 90 0 0 30 40 50
";
