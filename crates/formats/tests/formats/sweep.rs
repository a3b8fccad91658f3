//! Every real file: valid ones load, others are rejected with a reason, and nothing panics.

use std::panic::{AssertUnwindSafe, catch_unwind};

use gaitway_character::asset::Asset;
use gaitway_formats::{LoadError, load};

use crate::data_folder::data_folder;
use crate::file_set::{file_set, prepared};
use crate::model_files::models_under;

pub const GLTF: [&str; 4] = ["glb", "gltf", "vrm", "vrma"];

/// Loads every model and reports all that `check` rejects, and all panics.
fn sweep(folders: &[&str], extensions: &[&str], check: impl Fn(&str, Result<Asset, LoadError>) -> Result<(), String>) {
    let Some(data) = data_folder() else { return };
    let mut paths = Vec::new();
    for folder in folders {
        models_under(&data.join(folder), extensions, &mut paths);
    }
    assert!(!paths.is_empty(), "no models in {folders:?}");
    let mut failures = Vec::new();
    for path in &paths {
        let name = path.strip_prefix(&data).expect("found there").to_string_lossy().into_owned();
        match catch_unwind(AssertUnwindSafe(|| check(&name, prepared(path).and_then(|files| load(&files))))) {
            Ok(Ok(())) => {}
            Ok(Err(problem)) => failures.push(format!("{name}: {problem}")),
            Err(_) => failures.push(format!("{name}: panicked")),
        }
    }
    println!("{} models of {folders:?}", paths.len());
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), paths.len(), failures.join("\n"));
}

/// Checks what the loader guarantees for every asset: lengths agree and all indices are in range.
fn consistent(asset: &Asset) -> Result<(), String> {
    for (index, mesh) in asset.meshes.iter().enumerate() {
        let smallest_skin = asset
            .instances
            .iter()
            .filter(|instance| instance.mesh == index)
            .filter_map(|instance| Some(asset.skins[instance.skin?].joints().len()))
            .min();
        for geometry in &mesh.primitives {
            geometry.validate(smallest_skin).map_err(|problem| format!("mesh {index}: {problem}"))?;
            if geometry.morph_targets.len() != mesh.target_names.len() {
                return Err(format!("mesh {index}: targets and names differ in number"));
            }
            if geometry.file_vertices > geometry.positions.len() {
                return Err(format!("mesh {index}: fewer vertices than the file has"));
            }
        }
    }
    Ok(())
}

/// The unsupported extension that a file of the collection requires.
fn unreadable(name: &str) -> Option<&'static str> {
    let has = |part: &str| name.contains(part);
    if has("Compatibility_05") { Some("FAKE_materials_quantumRendering") } else { None }
}

#[test]
fn real_models_load_or_name_the_extension_they_need() {
    let folders = [
        "asset-generator",
        "khronos",
        "threejs",
        "kaykit",
        "mesh2motion",
        "misc",
        "playcanvas",
        "blender-io",
        "cosc422",
        "vrm",
        "compressed",
    ];
    sweep(&folders, &GLTF, |name, result| match (result, unreadable(name)) {
        (Err(LoadError::RequiredExtension { name: found, advice, .. }), Some(expected)) => {
            if found.contains(expected) || found == "KHR_mesh_quantization" {
                return Ok(());
            }
            Err(format!("needs {found} ({advice}), expected {expected}"))
        }
        (Ok(_), Some(expected)) => Err(format!("loaded, though it needs {expected}")),
        (Err(LoadError::UnsupportedVersion { .. }), None)
            if name.contains("v1.0-unsupported") || name.contains("Compatibility_04") =>
        {
            Ok(())
        }
        (Ok(_), None) if name.contains("v1.0-unsupported") || name.contains("Compatibility_04") => {
            Err("loaded, though its version is not supported".to_owned())
        }
        (Ok(asset), None) => {
            let missing = asset.warnings.iter().find(|warning| warning.code().starts_with("image-"));
            if let Some(warning) = missing {
                return Err(warning.to_string());
            }
            consistent(&asset)
        }
        (Err(problem), None) => Err(problem.to_string()),
        (Err(problem), Some(_)) => Err(format!("refused for another reason: {problem}")),
    });
}

/// The files of the Khronos validator that must be refused, each with the place that the message must name. All others
/// must load: many have errors that cost nothing (unused objects, alignment, bounds that are not needed), and refusing
/// them would only keep people from their models.
///
/// One has no error by the validator's own report: `non_relative_uri.gltf` needs a file from the web.
const REFUSED: &[(&str, &str)] = &[
    ("accessor/empty_object.gltf", "accessors[0]"),
    ("buffer/invalid_object.gltf", "buffers[0]"),
    ("buffer/invalid_uri_data.glb", "buffers[0].uri"),
    ("buffer/invalid_uri_data_bytelength.gltf", "byteLength"),
    ("buffer/invalid_uri_scheme.gltf", "buffers[0].uri"),
    ("buffer/non_relative_uri.gltf", "buffers[0].uri"),
    ("buffer/not_found.gltf", "buffers[0].uri"),
    ("buffer/wrong_bytelength.glb", "buffers[0]"),
    ("glb/chunk_too_big.glb", "GLB"),
    ("glb/empty_file.glb", "glTF"),
    ("glb/empty_json_chunk.glb", "line 1,"),
    ("glb/empty_json_object.glb", "asset.version"),
    ("glb/invalid_json_chunk.glb", "line 1,"),
    ("glb/invalid_magic.glb", "binary data"),
    ("glb/invalid_version.glb", "0.0"),
    ("glb/length_mismatch.glb", "GLB"),
    ("glb/no_header.glb", "binary data"),
    ("glb/only_bin_chunk.glb", "GLB"),
    ("glb/only_header.glb", "GLB"),
    ("glb/truncated_chunk_data.glb", "GLB"),
    ("glb/truncated_chunk_header.glb", "GLB"),
    ("glb/two_bin_chunks.glb", "GLB"),
    ("glb/two_empty_bin_chunks.glb", "GLB"),
    ("glb/two_empty_json_chunks.glb", "line 1,"),
    ("glb/unknown_chunk.glb", "GLB"),
    ("glb/zero_chunk_header.glb", "GLB"),
    ("glb/zero_length.glb", "GLB"),
    ("skin/buffer_view_bytestride.gltf", "buffers[0]"),
    ("skin/empty_joints_array.gltf", "skins[0]"),
    ("skin/empty_object.gltf", "skins[0]"),
    ("skin/ibm_invalid_count.gltf", "skins[2].inverseBindMatrices"),
    ("skin/ibm_invalid_format.gltf", "skins[0].inverseBindMatrices"),
    ("skin/unresolved_ibm.gltf", "skins[0].inverseBindMatrices"),
    ("skin/unresolved_joint.gltf", "skins[0].joints[0]"),
    ("skin/unresolved_skeleton.gltf", "skins[0].skeleton"),
];

#[test]
fn the_validators_broken_files_load_or_are_refused_as_listed() {
    sweep(&["validator-invalid"], &GLTF, |name, result| {
        let name = name.strip_prefix("validator-invalid/").unwrap_or(name);
        let place = REFUSED.iter().find(|(file, _)| *file == name).map(|(_, place)| *place);
        match (result, place) {
            (Ok(asset), None) => consistent(&asset),
            (Ok(_), Some(place)) => Err(format!("loaded, though {place} is broken")),
            (Err(problem), None) => Err(format!("refused, though it is usable: {problem}")),
            (Err(problem), Some(place)) => {
                let file = name.rsplit('/').next().unwrap_or(name);
                let text = problem.to_string();
                // Without the file's name, which may happen to contain the place.
                let named = text.split_once(file).is_some_and(|(_, rest)| rest.contains(place));
                if named { Ok(()) } else { Err(format!("expected the file and {place:?} in: {text}")) }
            }
        }
    });
}

#[test]
fn every_refused_file_of_the_validator_is_in_the_folder() {
    let Some(data) = data_folder() else { return };
    for (file, _) in REFUSED {
        assert!(data.join("validator-invalid").join(file).is_file(), "{file}");
    }
}

#[test]
fn the_validators_valid_files_load() {
    let Some(data) = data_folder() else { return };
    for name in
        ["accessor/valid.gltf", "animation/valid.gltf", "buffer/valid.gltf", "buffer/valid.glb", "glb/valid.glb"]
    {
        let result = load(&file_set(&data.join("validator-invalid").join(name)));
        assert!(result.is_ok(), "{name}: {}", result.unwrap_err());
    }
}

/// The FBX files that can't be converted, each with part of its error message.
const REFUSED_FBX: &[(&str, &str)] = &[
    ("fbx/assimp/transparentTest.fbx", "zero bytes were changed"),
    ("fbx/ufbx/motionbuilder_actor_7700_binary.fbx", "has no objects"),
];

/// parts/fbx tests the conversion itself; here, its result must load, and its format must be FBX.
#[test]
fn fbx_files_load_or_are_refused_as_listed() {
    sweep(&["threejs", "cosc422/original", "fbx"], &["fbx"], |name, result| {
        let reason = REFUSED_FBX.iter().find(|(file, _)| *file == name).map(|(_, reason)| *reason);
        match (result, reason) {
            (Ok(asset), None) if asset.format == "fbx" => consistent(&asset),
            (Ok(asset), None) => Err(format!("its format is {}", asset.format)),
            (Ok(_), Some(reason)) => Err(format!("loaded, though it should be refused: {reason}")),
            (Err(LoadError::Conversion { problem, .. }), Some(reason)) if problem.contains(reason) => Ok(()),
            (Err(problem), Some(reason)) => Err(format!("expected {reason:?} in: {problem}")),
            (Err(problem), None) => Err(format!("refused: {problem}")),
        }
    });
}

#[test]
fn every_refused_fbx_file_is_in_the_folder() {
    let Some(data) = data_folder() else { return };
    for (file, _) in REFUSED_FBX {
        assert!(data.join(file).is_file(), "{file}");
    }
}

/// Joints of the largest skin, vertices in the file, clips, and the first clip's duration in seconds, as counted by
/// other programs. A negative duration isn't compared.
struct Facts {
    path: &'static str,
    joints: usize,
    vertices: usize,
    clips: usize,
    first_secs: f32,
}

const FACTS: &[Facts] = &[
    Facts {
        path: "khronos/CesiumMan/glTF-Binary/CesiumMan.glb",
        joints: 19,
        vertices: 3273,
        clips: 1,
        first_secs: 2.0,
    },
    Facts {
        path: "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
        joints: 19,
        vertices: 370,
        clips: 1,
        first_secs: 1.25,
    },
    Facts {
        path: "khronos/RiggedSimple/glTF-Binary/RiggedSimple.glb",
        joints: 2,
        vertices: 96,
        clips: 1,
        first_secs: 2.083,
    },
    Facts {
        path: "khronos/BrainStem/glTF-Binary/BrainStem.glb",
        joints: 18,
        vertices: 34159,
        clips: 1,
        first_secs: 34.88,
    },
    Facts { path: "khronos/Monster/glTF-Binary/Monster.glb", joints: 32, vertices: 780, clips: 1, first_secs: 3.333 },
    Facts { path: "khronos/Fox/glTF-Binary/Fox.glb", joints: 24, vertices: 1728, clips: 3, first_secs: 3.417 },
    Facts {
        path: "khronos/SimpleSkin/glTF-Embedded/SimpleSkin.gltf",
        joints: 2,
        vertices: 10,
        clips: 1,
        first_secs: 5.5,
    },
    Facts { path: "cosc422/dwarf.glb", joints: 40, vertices: 1479, clips: 1, first_secs: 2.2 },
    Facts { path: "cosc422/ArmyPilot.glb", joints: 63, vertices: 16091, clips: 20, first_secs: -1.0 },
    Facts { path: "cosc422/mannequin.glb", joints: 52, vertices: 9748, clips: 0, first_secs: -1.0 },
    Facts { path: "cosc422/mannequin_run.glb", joints: 0, vertices: 0, clips: 1, first_secs: 0.733 },
    Facts { path: "threejs/Soldier.glb", joints: 49, vertices: 7434, clips: 4, first_secs: 1.967 },
    Facts { path: "threejs/Xbot.glb", joints: 67, vertices: 28374, clips: 7, first_secs: -1.0 },
    Facts { path: "kaykit/Knight.glb", joints: 41, vertices: 7024, clips: 76, first_secs: -1.0 },
    Facts { path: "misc/godot_mannequiny.glb", joints: 45, vertices: 12597, clips: 10, first_secs: -1.0 },
    Facts { path: "mesh2motion/cmu_91_48.glb", joints: 0, vertices: 0, clips: 1, first_secs: 3.633 },
    Facts { path: "vrm/three-vrm_test.vrma", joints: 0, vertices: 0, clips: 1, first_secs: 3.0 },
];

#[test]
fn real_models_have_the_contents_that_other_programs_report() {
    let Some(data) = data_folder() else { return };
    let mut failures = Vec::new();
    for facts in FACTS {
        let asset = load(&file_set(&data.join(facts.path))).unwrap_or_else(|problem| panic!("{problem}"));
        let joints = asset.skins.iter().map(|skin| skin.joints().len()).max().unwrap_or(0);
        let vertices: usize =
            asset.meshes.iter().flat_map(|mesh| &mesh.primitives).map(|geometry| geometry.file_vertices).sum();
        let first_secs = asset.clips.first().map_or(-1.0, |clip| clip.duration_secs());
        let agrees = (joints, vertices, asset.clips.len()) == (facts.joints, facts.vertices, facts.clips)
            && (facts.first_secs < 0.0 || (first_secs - facts.first_secs).abs() < 2e-3);
        if !agrees {
            let (path, clips) = (facts.path, asset.clips.len());
            failures.push(format!("{path}: {joints} joints, {vertices} vertices, {clips} clips, {first_secs} s"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
