//! Small files that ask for a lot: every reader counts before it allocates, and the error names the limit.

use gaitway_formats::limits::{
    Limit, MAX_ARCHIVE_FILES, MAX_FOLDER_DEPTH, MAX_FOLDER_FILES, MAX_IMAGE_BYTES, MAX_IMAGE_SIDE, MAX_JSON_OBJECTS,
    MAX_JSON_VALUES, MAX_MAP_BYTES, MAX_READ_BYTES, MAX_WRITTEN_FRAMES, MAX_WRITTEN_POSES,
};
use gaitway_formats::load;
use serde_json::{Value, json};

use crate::build_gltf::{Build, one};

#[track_caller]
fn check(name: &str, file: impl Into<Vec<u8>>, place: &str, limit: Limit) {
    let problem = load(&one(name, file.into())).expect_err("over the limit").to_string();
    let expected = format!("at most {} {} in all", limit.max_in_unit(), limit.name());
    assert!(problem.contains(place) && problem.contains(&expected), "{problem}");
}

fn zeros(component: u32, shape: &str, count: usize) -> Value {
    json!({ "componentType": component, "type": shape, "count": count })
}

#[test]
fn vertices_that_are_drawn_many_times() {
    let with_nodes = |count: usize| {
        let mut build = Build::triangle().with("/accessors/0", zeros(5126, "VEC3", 1 << 16));
        build.json["nodes"] = Value::Array(vec![json!({ "mesh": 0 }); count]);
        build
    };
    with_nodes(1 << 10).load().expect("just within the limit");
    check("m.glb", with_nodes((1 << 10) + 1).glb(), "nodes[1024]", Limit::DrawnVertices);
}

/// A node takes a few bytes, and a draw call several hundred.
#[test]
fn primitives_that_are_drawn_many_times() {
    let with_nodes = |count: usize| {
        let mut build = Build::triangle();
        build.json["meshes"][0]["primitives"] = Value::Array(vec![build.json["meshes"][0]["primitives"][0].clone(); 4]);
        build.json["nodes"] = Value::Array(vec![json!({ "mesh": 0 }); count]);
        build
    };
    with_nodes(1 << 13).load().expect("just within the limit");
    check("m.glb", with_nodes((1 << 13) + 1).glb(), "nodes[8192]", Limit::DrawCalls);
}

#[test]
fn skins_with_many_joints_on_many_nodes() {
    let with_nodes = |count: usize| {
        let mut build = Build::skinned([0; 12], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().expect("12"));
        build.json["nodes"] = Value::Array(vec![json!({ "mesh": 0, "skin": 0 }); count]);
        build.json["skins"] = json!([{ "joints": vec![0; 1 << 12] }]);
        build
    };
    with_nodes(1 << 8).load().expect("just within the limit");
    check("m.glb", with_nodes((1 << 8) + 1).glb(), "nodes[256]", Limit::SkinMatrices);
}

#[test]
fn nodes_of_every_format() {
    let count = Limit::Nodes.max() + 1;
    let nodes = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{}{{}}]}}"#, "{},".repeat(count - 1));
    check("m.gltf", nodes, "nodes", Limit::Nodes);
    let joints = format!("HIERARCHY ROOT r {{ {} }}", "JOINT j { } ".repeat(count));
    check("m.bvh", joints, "line 1", Limit::Nodes);
}

/// Three bytes of text would become a struct of more than a hundred.
#[test]
fn objects_are_counted_before_they_are_built() {
    let text = format!(r#"{{"asset":{{"version":"2.0"}},"samplers":[{}{{}}]}}"#, "{},".repeat(MAX_JSON_OBJECTS));
    let problem = load(&one("m.gltf", text.into_bytes())).expect_err("over the limit").to_string();
    assert!(problem.contains(&format!("at most {MAX_JSON_OBJECTS} objects in all")), "{problem}");
    let text = format!(r#"{{"asset":{{"version":"2.0"}},"materials":[{}{{}}]}}"#, "{},".repeat(MAX_JSON_OBJECTS / 16));
    let problem = load(&one("m.gltf", text.into_bytes())).expect_err("over the limit").to_string();
    assert!(problem.contains(&format!("at most {MAX_JSON_OBJECTS} objects in all")), "{problem}");
    // A text that has to be corrected is held as a tree, whatever it consists of.
    let text = format!(r#"{{"asset":{{"version":2.0}},"extras":[{}0]}}"#, "0,".repeat(MAX_JSON_VALUES));
    let problem = load(&one("m.gltf", text.into_bytes())).expect_err("over the limit").to_string();
    assert!(problem.contains(&format!("at most {MAX_JSON_VALUES} values in all")), "{problem}");
}

/// Images over the limit are left out; the model is shown without them.
#[test]
fn pixels_of_all_images() {
    // Width and height are at bytes 16 to 23 of a PNG.
    let png = |width: u32, height: u32| {
        let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        header.extend(width.to_be_bytes());
        header.extend(height.to_be_bytes());
        header.extend([8, 6, 0, 0, 0, 0, 0, 0, 0]);
        header
    };
    let warnings = |sizes: &[(u32, u32)]| {
        let mut build = Build::triangle();
        let images = sizes.iter().map(|&(width, height)| json!({ "bufferView": build.view(&png(width, height)) }));
        let images: Vec<Value> = images.collect();
        build.json["images"] = json!(images);
        let asset = build.load().expect("readable without images");
        asset.warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let side = MAX_IMAGE_SIDE;
    assert_eq!(warnings(&[(side, side)]), [""; 0]);
    let second = warnings(&[(side, side), (1, 1)]);
    let limit = format!("more than {} pixels of images in all", Limit::ImagePixels.max());
    assert!(
        matches!(&second[..], [warning] if warning.contains("images[1]") && warning.contains(&limit)),
        "{second:?}"
    );
    let wide = warnings(&[(side + 1, 1)]);
    assert!(matches!(&wide[..], [warning] if warning.contains(&format!("1 to {side} each way"))), "{wide:?}");
}

/// The table in docs/limits.md lists every limit with its current value.
#[test]
fn the_limits_are_those_of_the_documentation() {
    let text = std::fs::read_to_string("../../docs/limits.md").expect("the page");
    let counted = Limit::ALL.map(|limit| (limit.name(), limit.max_in_unit() as u64));
    let others = [
        ("MiB of files", MAX_READ_BYTES >> 20),
        ("files in an archive", MAX_ARCHIVE_FILES as u64),
        ("files in folders", MAX_FOLDER_FILES as u64),
        ("folders inside folders", MAX_FOLDER_DEPTH as u64),
        ("pixels of an image's width or height", u64::from(MAX_IMAGE_SIDE)),
        ("MiB of decoded images", MAX_IMAGE_BYTES >> 20),
        ("frames of a clip", MAX_WRITTEN_FRAMES as u64),
        ("joints of a clip's frames", MAX_WRITTEN_POSES as u64),
        ("JSON objects", MAX_JSON_OBJECTS as u64),
        ("MiB of a joint map", MAX_MAP_BYTES as u64 >> 20),
        ("JSON values", MAX_JSON_VALUES as u64),
    ];
    for (name, max) in counted.into_iter().chain(others) {
        let row = text.lines().find(|line| line.starts_with(&format!("| {name} |")));
        let row = row.unwrap_or_else(|| panic!("no row for {name}"));
        let number = row.split('|').nth(2).unwrap_or_default().trim().replace(',', "");
        assert_eq!(number, max.to_string(), "{name}");
    }
}
