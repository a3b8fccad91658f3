//! What a valid file loads as: attributes, indices, nodes, materials, clips.

use gaitway_character::asset::{Asset, CameraProjection, LightKind};
use gaitway_character::mesh::{Filter, Geometry, MipFilter, Topology, Wrap, add_tangents};
use glam::{Mat4, Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::build_gltf::{Build, F32, I8, I16, U8, U16, U32, floats, shorts};
use crate::examples::textured_square;

fn read(build: Build) -> Asset {
    build.loaded()
}

fn geometry(asset: &Asset) -> &Geometry {
    &asset.meshes[0].primitives[0]
}

fn codes(asset: &Asset) -> Vec<&'static str> {
    asset.warnings.iter().map(|warning| warning.code()).collect()
}

#[test]
fn triangle_without_indices() {
    let asset = read(Build::triangle());
    let geometry = geometry(&asset);
    assert_eq!(geometry.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((geometry.topology, geometry.indices.as_slice()), (Topology::Triangles, &[0, 1, 2][..]));
    assert!(geometry.normals.is_empty() && geometry.influences.is_empty());
    assert_eq!((asset.format, asset.instances.len(), asset.scenes.len()), ("glb", 1, 0));
    assert_eq!(codes(&asset), [""; 0]);
}

#[test]
fn strips_fans_and_loops_become_lists() {
    let cases: [(u32, Topology, &[u32]); 7] = [
        (0, Topology::Points, &[0, 1, 2, 3, 4]),
        (1, Topology::Lines, &[0, 1, 2, 3]),
        (2, Topology::Lines, &[0, 1, 1, 2, 2, 3, 3, 4, 4, 0]),
        (3, Topology::Lines, &[0, 1, 1, 2, 2, 3, 3, 4]),
        (4, Topology::Triangles, &[0, 1, 2]),
        (5, Topology::Triangles, &[0, 1, 2, 1, 3, 2, 2, 3, 4]),
        (6, Topology::Triangles, &[1, 2, 0, 2, 3, 0, 3, 4, 0]),
    ];
    for (mode, topology, indices) in cases {
        let mut build = Build::triangle();
        build.accessor(F32, "VEC3", 5, &floats(&[0.5; 15]));
        build.attribute("POSITION", 1);
        build.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let asset = read(build);
        assert_eq!(
            (geometry(&asset).topology, geometry(&asset).indices.as_slice()),
            (topology, indices),
            "mode {mode}"
        );
    }
}

#[test]
fn interleaved_data_is_read_with_its_stride() {
    let mut build = Build::triangle();
    let rows: Vec<f32> = (0..3).flat_map(|row| [row as f32, 0.0, 0.0, 0.0, 0.0, 1.0]).collect();
    let view = build.view(&floats(&rows));
    build.json["bufferViews"][view]["byteStride"] = json!(24);
    for (at, semantic) in ["POSITION", "NORMAL"].into_iter().enumerate() {
        let accessor =
            json!({ "bufferView": view, "byteOffset": 12 * at, "componentType": F32, "type": "VEC3", "count": 3 });
        build.json["accessors"].as_array_mut().unwrap().push(accessor);
        build.attribute(semantic, 1 + at);
    }
    let asset = read(build);
    assert_eq!(geometry(&asset).positions, [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X]);
    assert_eq!(geometry(&asset).normals, [Vec3::Z; 3]);
}

#[test]
fn sparse_entries_replace_elements_or_zeros() {
    for base in [true, false] {
        let mut build = Build::triangle();
        let indices = build.view(&[2]);
        let values = build.view(&floats(&[7.0, 8.0, 9.0]));
        build.json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": indices, "componentType": U8 },
            "values": { "bufferView": values },
        });
        if !base {
            build.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        }
        let second = if base { Vec3::X } else { Vec3::ZERO };
        assert_eq!(geometry(&read(build)).positions, [Vec3::ZERO, second, Vec3::new(7.0, 8.0, 9.0)]);
    }
}

#[test]
fn normalized_integers_become_fractions() {
    let check = |component: u32, bytes: &[u8], expected: [f32; 2]| {
        let mut build = Build::triangle();
        let accessor = build.accessor(component, "VEC2", 3, bytes);
        build.json["accessors"][accessor]["normalized"] = json!(true);
        build.attribute("TEXCOORD_0", accessor);
        assert_eq!(geometry(&read(build)).uvs[0][0], Vec2::from(expected), "{component}");
    };
    check(U8, &[255, 51, 0, 0, 0, 0], [1.0, 0.2]);
    check(I8, &[0x80, 127, 0, 0, 0, 0], [-1.0, 1.0]);
    check(U16, &shorts(&[65535, 0, 0, 0, 0, 0]), [1.0, 0.0]);
    check(I16, &shorts(&[0x8000, 32767, 0, 0, 0, 0]), [-1.0, 1.0]);
}

#[test]
fn rgb_colours_are_opaque() {
    let mut build = Build::triangle();
    let accessor = build.accessor(F32, "VEC3", 3, &floats(&[0.25, 0.5, 0.75].repeat(3)));
    build.attribute("COLOR_0", accessor);
    assert_eq!(geometry(&read(build)).colors, [Vec4::new(0.25, 0.5, 0.75, 1.0); 3]);
}

#[test]
fn nodes_with_a_matrix_or_with_trs() {
    let transform = Mat4::from_scale_rotation_translation(Vec3::splat(2.0), Quat::from_rotation_y(1.0), Vec3::X);
    let nodes = json!([
        { "matrix": transform.to_cols_array(), "children": [1] },
        { "rotation": [0, 0, 0, 2], "translation": [1, 2, 3] },
    ]);
    let asset = read(Build::new().with("/nodes", nodes));
    let skeleton = &asset.skeleton;
    let rest = |source: usize| skeleton.rest().local(skeleton.joint_of_source(source).unwrap());
    assert!(Mat4::from(rest(0).to_affine()).abs_diff_eq(transform, 1e-5));
    assert_eq!((rest(1).rotation, rest(1).translation), (Quat::IDENTITY, Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(codes(&asset), [""; 0]);
    let sheared = Mat4::from_cols(Vec4::X, Vec4::new(0.5, 1.0, 0.0, 0.0), Vec4::Z, Vec4::W).to_cols_array();
    let asset = read(Build::new().with("/nodes", json!([{ "matrix": sheared }])));
    assert_eq!(codes(&asset), ["matrix-not-decomposable"]);
}

/// Children may precede their parents in a file; source indices are the file's.
#[test]
fn node_order_does_not_matter() {
    let nodes = json!([{ "name": "hand" }, { "name": "arm", "children": [0] }, { "name": "hip", "children": [1] }]);
    let asset = read(Build::new().with("/nodes", nodes));
    let skeleton = &asset.skeleton;
    for (source, name, parent) in [(0, "hand", Some(1)), (1, "arm", Some(2)), (2, "hip", None)] {
        let joint = skeleton.joint_of_source(source).unwrap();
        assert_eq!(skeleton.name(joint), name);
        assert_eq!(skeleton.parent(joint).map(|parent| skeleton.source_index(parent)), parent);
    }
}

#[test]
fn several_scenes_and_the_default_one() {
    let scenes = json!([{ "name": "a", "nodes": [0] }, { "name": "b", "nodes": [1] }]);
    let build = || Build::new().with("/nodes", json!([{}, { "children": [2] }, {}])).with("/scenes", scenes.clone());
    let asset = read(build());
    assert_eq!(asset.default_scene, Some(0));
    let asset = read(build().with("/scene", json!(1)));
    assert_eq!((asset.default_scene, asset.scenes.len()), (Some(1), 2));
    let shown = asset.joints_in_scene(asset.default_scene);
    let of_source = |source: usize| shown[asset.skeleton.joint_of_source(source).unwrap().get()];
    assert_eq!([0, 1, 2].map(of_source), [false, true, true]);
}

#[test]
fn morph_weights_of_the_node_override_those_of_the_mesh() {
    let build = |mesh: Value, node: Value| {
        let mut build = Build::triangle();
        let target = json!({ "POSITION": 0 });
        build.json["meshes"][0]["primitives"][0]["targets"] = json!([target.clone(), target]);
        build.json["meshes"][0]["extras"] = json!({ "targetNames": ["smile", "frown"] });
        build.json["meshes"][0]["weights"] = mesh;
        build.json["nodes"] = json!([{ "mesh": 0, "weights": node }]);
        build
    };
    let check = |mesh: Value, node: Value, expected: [f32; 2]| {
        let asset = read(build(mesh, node));
        assert_eq!(asset.skeleton.rest().morph_weights, expected);
        assert_eq!(asset.meshes[0].target_names, ["smile", "frown"]);
    };
    check(json!([]), Value::Null, [0.0, 0.0]);
    check(json!([0.25, 0.5]), Value::Null, [0.25, 0.5]);
    check(json!([0.25, 0.5]), json!([1.0, 0.0]), [1.0, 0.0]);
}

#[test]
fn mikktspace_appends_copies_of_seam_vertices() {
    let asset = read(textured_square());
    let square = geometry(&asset);
    assert_eq!(square.file_vertices, 4);
    assert_eq!(square.positions.len(), 6, "two vertices lie on the seam");
    assert_eq!(square.tangents.len(), 6);
    square.validate(None).unwrap();
    assert_eq!(square.positions[..4], [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    let mut copied: Vec<[f32; 3]> = square.positions[4..].iter().map(|position| position.to_array()).collect();
    copied.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_eq!(copied, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    for tangent in &square.tangents {
        assert!((tangent.truncate().length() - 1.0).abs() < 1e-5 && tangent.w.abs() == 1.0, "{tangent}");
    }
    // The tangent points along growing u; the bitangent, w · (normal × tangent), along growing v in glTF's sense.
    let first = square.indices[1] as usize;
    let along = square.tangents[first];
    assert!(along.truncate().dot(Vec3::new(1.0, -1.0, 0.0)) > 0.0, "{along}");
    let mut given = textured_square();
    let tangents = given.accessor(F32, "VEC4", 4, &floats(&[1.0, 0.0, 0.0, 1.0].repeat(4)));
    given.attribute("TANGENT", tangents);
    let asset = read(given);
    assert_eq!(geometry(&asset).tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4], "given tangents are kept");
}

#[test]
fn copies_for_tangents_stay_within_their_budget() {
    let check = |most_bytes: usize, expected_copies: usize| {
        let asset = read(textured_square().with("/materials/0", json!({})));
        let mut square = geometry(&asset).clone();
        let used_bytes = add_tangents(&mut square, 0, most_bytes);
        assert_eq!(square.positions.len(), 4 + expected_copies, "within {most_bytes} bytes");
        assert_eq!(square.tangents.len(), square.positions.len());
        assert!(used_bytes <= most_bytes && (used_bytes > 0) == (expected_copies > 0), "{used_bytes}");
        square.validate(None).unwrap();
        for vertex in 0..square.positions.len() {
            assert_eq!(square.positions[vertex], square.positions[square.number_in_file(vertex)]);
        }
    };
    check(0, 0);
    check(100, 1);
    check(1000, 2);
}

#[test]
fn texture_transforms_and_uv_sets() {
    let info = json!({ "index": 0, "texCoord": 0, "scale": 0.5, "extensions": { "KHR_texture_transform": {
        "offset": [0.25, 0.5], "rotation": 1.5, "scale": [2, 3], "texCoord": 1 } } });
    let asset = read(textured_square().with("/materials/0/normalTexture", info));
    let texture = asset.materials[0].normal_texture.expect("a normal texture");
    assert_eq!((texture.uv_set, asset.materials[0].normal_scale), (1, 0.5));
    let transform = texture.uv_transform;
    assert_eq!((transform.offset, transform.scale), (Vec2::new(0.25, 0.5), Vec2::new(2.0, 3.0)));
    assert_eq!(transform.rotation_radians, 1.5);
    let asset = read(textured_square().with("/materials/0/normalTexture/texCoord", json!(5)));
    assert_eq!((asset.materials[0].normal_texture.unwrap().uv_set, codes(&asset)), (0, vec!["texcoord-set"]));
}

#[test]
fn webp_is_preferred_if_present_and_ktx2_to_both() {
    let image_used = |extensions: serde_json::Value| {
        let mut build = textured_square();
        let image = build.json["images"][0].clone();
        build.json["images"] = json!([image.clone(), image.clone(), image]);
        build.json["textures"] = json!([{ "source": 0, "extensions": extensions }]);
        read(build).textures[0].image
    };
    assert_eq!(image_used(json!({ "EXT_texture_webp": { "source": 1 } })), Some(1));
    let both = json!({ "EXT_texture_webp": { "source": 1 }, "KHR_texture_basisu": { "source": 2 } });
    assert_eq!(image_used(both), Some(2));
}

/// Natively nothing decodes AVIF, so any alternative is preferred.
#[test]
fn avif_is_known_by_its_content() {
    let with = |texture: serde_json::Value| {
        let mut build = textured_square();
        let view = build.view(include_bytes!("../../../../tests/support/gradients.avif"));
        let other = build.json["images"][0].clone();
        build.json["images"] = json!([other, { "bufferView": view }]);
        build.json["textures"] = json!([texture]);
        read(build.with("/extensionsUsed", json!(["EXT_texture_avif"])))
    };
    let avif = json!({ "EXT_texture_avif": { "source": 1 } });
    let asset = with(json!({ "extensions": avif }));
    assert_eq!((asset.images[1].mime, asset.images[1].width, asset.images[1].height), ("image/avif", 64, 32));
    assert_eq!((asset.textures[0].image, codes(&asset)), (Some(1), Vec::new()));
    assert_eq!(with(json!({ "source": 0, "extensions": avif })).textures[0].image, Some(0));
}

#[test]
fn the_header_of_a_ktx2_image_is_read_and_not_trusted() {
    let file = include_bytes!("../../../../tests/support/ktx2/etc1s.ktx2");
    let image = |change: &dyn Fn(&mut [u8])| {
        let (mut build, mut bytes) = (textured_square(), file.to_vec());
        change(&mut bytes);
        let view = build.view(&bytes);
        build.json["images"] = json!([{ "bufferView": view, "mimeType": "image/ktx2" }]);
        build.json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
        let required = json!(["KHR_texture_basisu"]);
        read(build.with("/extensionsRequired", required.clone()).with("/extensionsUsed", required))
    };
    let asset = image(&|_| ());
    let found = &asset.images[0];
    assert_eq!((found.mime, found.width, found.height), ("image/ktx2", 64, 32));
    assert!(codes(&asset).is_empty());
    for (at, value) in [(12, 97), (20, 65_535), (24, 0), (36, 6)] {
        let asset = image(&|bytes| bytes[at..at + 4].copy_from_slice(&u32::to_le_bytes(value)));
        assert_eq!(codes(&asset), ["image-unreadable"], "byte {at}");
        assert!(asset.images[0].bytes.is_empty());
    }
}

#[test]
fn sampler_codes() {
    let mut build = textured_square();
    build.json["textures"][0]["sampler"] = json!(0);
    build.json["samplers"] = json!([{ "magFilter": 9728, "minFilter": 9985, "wrapS": 33071, "wrapT": 33648 }]);
    let sampler = read(build).textures[0].sampler;
    assert_eq!((sampler.mag, sampler.min, sampler.mip), (Filter::Nearest, Filter::Linear, MipFilter::Nearest));
    assert_eq!((sampler.wrap_u, sampler.wrap_v), (Wrap::ClampToEdge, Wrap::MirroredRepeat));
}

#[test]
fn an_unreadable_image_only_leaves_its_texture_empty() {
    let mut build = textured_square();
    let view = build.view(b"GIF89a, which is not read");
    let ktx = build.view(b"\xABKTX 20\xBB\r\n\x1A\n");
    build.json["images"] = json!([{ "bufferView": view }, { "bufferView": ktx }, { "uri": "skin.png" }, {}]);
    let asset = read(build);
    assert_eq!(codes(&asset), ["image-unreadable", "image-unreadable", "image-missing", "image-unreadable"]);
    assert!(asset.images.iter().all(|image| image.bytes.is_empty()));
    assert_eq!(asset.images.len(), 4, "indices are those of the file");
}

#[test]
fn lights_and_cameras() {
    let mut build = Build::new().with(
        "/nodes",
        json!([{ "camera": 0 }, { "extensions": { "KHR_lights_punctual": { "light": 1 } } },
               { "extensions": { "KHR_lights_punctual": { "light": 0 } } }]),
    );
    build.json["cameras"] = json!([{ "name": "eye", "perspective": { "yfov": 0.5, "znear": 0.1 } }]);
    build.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "color": [1, 0.5, 0], "intensity": 40, "range": 3 },
        { "type": "spot", "spot": { "outerConeAngle": 0.5 } } ] } });
    let asset = read(build);
    let lens = CameraProjection::Perspective { y_fov_radians: 0.5, near: 0.1, far: None };
    assert_eq!((asset.cameras[0].name.as_str(), asset.cameras[0].projection), ("eye", lens));
    let spot = LightKind::Spot { inner_cone_radians: 0.0, outer_cone_radians: 0.5 };
    assert_eq!(asset.lights.iter().map(|light| light.kind).collect::<Vec<_>>(), [spot, LightKind::Point]);
    assert_eq!((asset.lights[1].intensity, asset.lights[1].range), (40.0, Some(3.0)));
    assert_eq!(asset.lights[1].color, Vec3::new(1.0, 0.5, 0.0));
}

#[test]
fn lights_beyond_the_limit_are_reported() {
    for (count, expected) in [(8, vec![]), (9, vec!["lights-dropped"])] {
        let node = json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } });
        let mut build = Build::new().with("/nodes", json!(vec![node; count]));
        build.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
        let asset = read(build);
        assert_eq!((asset.lights.len(), codes(&asset)), (count, expected));
    }
}

#[test]
fn clips_keep_the_keys_of_the_file() {
    let values = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0];
    let asset = read(Build::animated("translation", &[0.5, 2.0], "VEC3", 2, &values));
    let clip = &asset.clips[0];
    assert_eq!((clip.name(), clip.duration_secs(), clip.channels().len()), ("move", 2.0, 1));
    assert_eq!(clip.timelines(), [vec![0.5, 2.0]]);
}

#[test]
fn channels_of_extensions_are_ignored_with_a_warning() {
    let build = || Build::animated("translation", &[0.0, 1.0], "VEC3", 2, &[0.0; 6]);
    let target = "/animations/0/channels/0/target";
    let pointer = read(build().with(target, json!({ "path": "pointer" })));
    assert_eq!((pointer.clips[0].channels().len(), codes(&pointer)), (0, vec!["channel-ignored"]));
    let weights = read(build().with(target, json!({ "node": 0, "path": "weights" })));
    assert_eq!((weights.clips[0].channels().len(), codes(&weights)), (0, vec!["channel-ignored"]));
}

#[test]
fn skins_without_bind_matrices_are_bound_at_the_origin() {
    let mut build = Build::skinned([0; 12], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    build.json["nodes"][1]["translation"] = json!([1, 0, 0]);
    let asset = read(build);
    assert_eq!(asset.skins[0].joint_from_bind(), [glam::Affine3A::IDENTITY; 2]);
    let sources: Vec<usize> = asset.skins[0].joints().iter().map(|&joint| asset.skeleton.source_index(joint)).collect();
    assert_eq!(sources, [1, 2]);
}

#[test]
fn a_primitive_without_positions_is_left_empty() {
    let mut build = Build::triangle();
    build.json["meshes"][0]["primitives"][0]["attributes"] = json!({});
    let asset = read(build);
    assert!(geometry(&asset).positions.is_empty());
    assert_eq!(codes(&asset), ["no-positions"]);
}

#[test]
fn indices_of_32_bits() {
    let mut build = Build::triangle();
    let indices: Vec<u8> = [2_u32, 1, 0].iter().flat_map(|index| index.to_le_bytes()).collect();
    let accessor = build.accessor(U32, "SCALAR", 3, &indices);
    build.json["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
    assert_eq!(geometry(&read(build)).indices, [2, 1, 0]);
}
