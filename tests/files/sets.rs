//! Sorting files by content (model, motions, joint map), and opening them from disk.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use gaitway::files::{Disk, Held, OpenError, Role, SortError, open_paths, read_map, read_paths, sort};
use gaitway_formats::limits::MAX_MAP_BYTES;
use gaitway_formats::{FileSet, LoadError};
use gaitway_retarget::MapError;
use gaitway_scene::state::from_link;
use zip::write::SimpleFileOptions;

const BVH: &str = "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
                   Yrotation\n End Site\n {\n OFFSET 0 10 0\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0 0 0 0\n\
                   0 1 0 0 0 0\n";
const MESH: &str = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"}]}"#;
const EMBEDDED_BUFFER: &str = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";
const SKELETON: &str = r#"{"asset":{"version":"2.0"},"nodes":[{"name":"hips"}]}"#;
const MAP: &str = r#"{"gaitway_map":1,"joints":{"hips":{"source":0}}}"#;

fn set(files: &[(&str, &str)]) -> FileSet {
    let mut set = FileSet::default();
    files.iter().for_each(|(name, text)| set.insert(*name, text.as_bytes()));
    set
}

/// Creates an empty folder for one test.
fn temporary_folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("gaitway-sets-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder is created");
    folder
}

fn write(folder: &Path, name: &str, content: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("the folder is created");
    std::fs::write(&path, content).expect("the file is written");
    path
}

fn zipped(files: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in files {
        writer.start_file(*name, SimpleFileOptions::default()).expect("in memory");
        writer.write_all(text.as_bytes()).expect("in memory");
    }
    writer.finish().expect("in memory").into_inner()
}

/// Checks the model, the motions and whether there is a map.
fn check(role: Role, files: &[(&str, &str)], expected: (Option<&str>, &[&str], bool)) {
    let sorted = sort(&set(files), role).unwrap_or_else(|error| panic!("{error}"));
    let model = sorted.models.first().map(|(name, _)| name.as_str());
    let motions: Vec<&str> = sorted.motions.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((model, &motions[..], sorted.map.is_some()), expected, "{role:?}");
}

#[test]
fn a_file_with_a_mesh_is_the_model() {
    let files = [("a.bvh", BVH), ("m.gltf", MESH), ("map.json", MAP), ("s.gltf", SKELETON), ("package.json", "{}")];
    check(Role::Any, &files, (Some("m.gltf"), &["a.bvh"], true));
    check(Role::Model, &files, (Some("m.gltf"), &["a.bvh", "s.gltf"], true));
    check(Role::Motion, &files, (None, &["a.bvh", "m.gltf", "s.gltf"], true));
    check(Role::Any, &[("map.json", MAP)], (None, &[], true));
}

#[test]
fn a_skeleton_without_mesh_and_clips_is_a_model_unless_a_motion_is_wanted() {
    check(Role::Any, &[("s.gltf", SKELETON)], (Some("s.gltf"), &[], false));
    check(Role::Model, &[("s.gltf", SKELETON)], (Some("s.gltf"), &[], false));
    check(Role::Motion, &[("s.gltf", SKELETON)], (None, &["s.gltf"], false));
    let sorted = sort(&set(&[("m.gltf", MESH), ("s.gltf", SKELETON)]), Role::Any).expect("two models");
    assert_eq!((sorted.models.len(), sorted.motions.len()), (2, 0));
}

#[test]
fn a_lone_motion_takes_the_requested_role() {
    check(Role::Any, &[("a.bvh", BVH)], (None, &["a.bvh"], false));
    check(Role::Model, &[("a.bvh", BVH)], (Some("a.bvh"), &[], false));
    check(Role::Motion, &[("a.bvh", BVH)], (None, &["a.bvh"], false));
}

#[test]
fn several_models_are_kept_in_order() {
    let sorted = sort(&set(&[("m.gltf", MESH), ("a.bvh", BVH), ("n.gltf", MESH)]), Role::Any).unwrap();
    let names: Vec<&str> = sorted.models.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((&names[..], sorted.motions.len()), (&["m.gltf", "n.gltf"][..], 1));
}

#[test]
fn sorting_errors_say_what_to_do() {
    let fails = |role, files: &[(&str, &str)]| match sort(&set(files), role) {
        Ok(sorted) => panic!("{sorted:?}"),
        Err(error) => error,
    };
    let names: Vec<String> = (0..65).map(|index| format!("{index}.gltf")).collect();
    let models: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), MESH)).collect();
    assert!(matches!(fails(Role::Any, &models[..9]), SortError::TooManyModels { max: 8 }));
    assert!(matches!(fails(Role::Any, &models), SortError::TooManyModels { max: 8 }));
    let none = fails(Role::Model, &[("a.bvh", BVH), ("b.bvh", BVH)]);
    assert!(matches!(&none, SortError::NoModel { .. }), "{none}");
    let maps = fails(Role::Any, &[("a.bvh", BVH), ("a.json", MAP), ("b.json", MAP)]);
    assert!(matches!(&maps, SortError::SeveralMaps { .. }), "{maps}");
    let typo = MAP.replace("source", "sauce");
    let bad = fails(Role::Any, &[("a.bvh", BVH), ("map.json", &typo)]);
    assert!(matches!(&bad, SortError::Map { file, problem: MapError::Json { .. } } if file == "map.json"), "{bad}");
    assert!(bad.to_string().contains("sauce"), "{bad}");
    for text in ["{}", "{\"gaitway"] {
        let no_map = fails(Role::Any, &[("map.json", text)]);
        assert!(matches!(&no_map, SortError::Map { file, .. } if file == "map.json"), "{no_map}");
    }
    let unknown = fails(Role::Any, &[("notes.txt", "hello")]);
    assert!(unknown.to_string().ends_with("or an environment (.hdr)"), "{unknown}");
    assert!(matches!(fails(Role::Any, &[("notes.txt", "hello")]), SortError::Load(_)));
    let many: Vec<(String, &str)> = (0..65).map(|index| (format!("{index}.bvh"), BVH)).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    assert!(matches!(fails(Role::Any, &many), SortError::TooManyMotions { max: 64 }));
}

#[test]
fn files_next_to_a_model_are_read_with_it() {
    let folder = temporary_folder("beside");
    let model = write(&folder, "m.gltf", MESH.replace(EMBEDDED_BUFFER, "data/mesh%20a.bin").as_bytes());
    assert!(matches!(
        open_paths(std::slice::from_ref(&model)),
        Err(OpenError::Files(SortError::Load(LoadError::MissingFile { .. })))
    ));
    write(&folder, "data/mesh a.bin", &[0; 36]);
    let opened = open_paths(std::slice::from_ref(&model)).expect("complete");
    assert_eq!(opened.files, ["m.gltf", "data/mesh a.bin"]);
    assert_eq!((opened.model.origin.as_str(), opened.model.source.as_str()), ("m.gltf", "m.gltf"));
    let whole_folder = open_paths(std::slice::from_ref(&folder)).expect("complete");
    assert_eq!(whole_folder.files, ["data/mesh a.bin", "m.gltf"]);
    assert_eq!(whole_folder.model.source, "m.gltf");
    assert_eq!(Path::new(&whole_folder.model.origin), folder.file_name().expect("it has a name"));
    std::fs::remove_dir_all(&folder).expect("it was created");
}

/// Otherwise a model could name any file on the disk, and a conversion sent back to its author would contain it.
#[test]
fn nothing_outside_the_models_folder_is_read_with_it() {
    let folder = temporary_folder("outside");
    let secret = write(&folder, "secret.bin", &[0; 36]);
    let inner = folder.join("inner");
    let refers_to = |uri: &str| write(&inner, "m.gltf", MESH.replace(EMBEDDED_BUFFER, uri).as_bytes());
    write(&inner, "deep/mesh.bin", &[0; 36]);
    let absolute = secret.to_str().expect("Unicode").to_owned();
    let mut uris = vec!["../secret.bin", "%2e%2e/secret.bin", "deep/../../secret.bin", "..%2Fsecret.bin", &absolute];
    let file_uri = format!("file://{absolute}");
    uris.push(&file_uri);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&secret, inner.join("link.bin")).expect("a link");
        std::os::unix::fs::symlink(&folder, inner.join("up")).expect("a link");
        uris.extend(["link.bin", "up/secret.bin"]);
    }
    for uri in uris {
        let model = refers_to(uri);
        let problem = open_paths(std::slice::from_ref(&model)).map(|opened| opened.files).expect_err(uri);
        assert!(
            matches!(&problem, OpenError::Files(SortError::Load(LoadError::MissingFile { .. }))),
            "{uri}: {problem}"
        );
        if uri.starts_with("..") {
            assert!(problem.to_string().contains("outside the model's folder"), "{problem}");
        }
        // As part of a folder, too.
        open_paths(std::slice::from_ref(&inner)).map(|opened| opened.files).expect_err(uri);
        // Given by the user, it may be anywhere.
        if uri.ends_with("secret.bin") {
            open_paths(&[model, secret.clone()]).unwrap_or_else(|problem| panic!("{uri}: {problem}"));
        }
    }
    for uri in ["deep/mesh.bin", "deep/../deep/./mesh.bin", "../inner/deep/mesh.bin"] {
        open_paths(&[refers_to(uri)]).unwrap_or_else(|problem| panic!("{uri}: {problem}"));
    }
    std::fs::remove_dir_all(&folder).expect("it was created");
}

#[test]
fn a_missing_image_is_reported_once() {
    let folder = temporary_folder("image");
    let text = MESH.replace(r#""scene":0,"#, r#""scene":0,"images":[{"uri":"skin.png"}],"textures":[{"source":0}],"#);
    let model = write(&folder, "m.gltf", text.as_bytes());
    let opened = open_paths(std::slice::from_ref(&model)).expect("shown without it");
    let codes: Vec<_> = opened.model.asset.warnings.iter().map(|warning| warning.code()).collect();
    assert_eq!(codes, ["image-missing"]);
    assert_eq!(opened.model.images.shown().len(), 1);
    std::fs::remove_dir_all(&folder).expect("it was created");
}

#[test]
fn files_from_an_archive_have_its_name_as_origin() {
    let folder = temporary_folder("archive");
    let archive = write(&folder, "two.zip", &zipped(&[("a/m.gltf", MESH), ("b/n.gltf", MESH), ("c/a.bvh", BVH)]));
    let one = write(&folder, "one.zip", &zipped(&[("m.gltf", MESH)]));
    let map = write(&folder, "map.json", MAP.as_bytes());
    let contents = read_paths(&[map.clone(), archive.clone()], Role::Any).expect("two models and a motion");
    let models: Vec<_> =
        contents.models.iter().map(|opened| (opened.model.source.as_str(), opened.model.origin.as_str())).collect();
    assert_eq!(models, [("a/m.gltf", "two.zip"), ("b/n.gltf", "two.zip#!/b/n.gltf")]);
    let motions: Vec<_> =
        contents.motions.iter().flatten().map(|motion| (motion.source.as_str(), motion.origin.as_str())).collect();
    assert_eq!(motions, [("c/a.bvh", "two.zip")]);
    assert!(contents.map.is_some());
    let files = contents.models[1].files.as_ref().expect("it was read from files");
    assert_eq!((files.name.as_str(), files.set.get("a/m.gltf").is_some()), ("b/n.gltf", true));
    assert_eq!(open_paths(&[one]).expect("one model").files, ["one.zip"], "as it was named");
    let several = open_paths(std::slice::from_ref(&archive)).expect_err("two models").to_string();
    assert!(several.contains("a/m.gltf, b/n.gltf"), "{several}");
    let cut = write(&folder, "cut.zip", b"PK\x03\x04 and no more");
    let cut = open_paths(&[cut]).expect_err("it is no archive").to_string();
    assert!(cut.starts_with("cut.zip: expected a zip archive with a list of files at its end, found none"), "{cut}");
    std::fs::remove_dir_all(&folder).expect("it was created");
}

#[test]
fn motions_of_a_folder_have_its_name_as_origin() {
    let folder = temporary_folder("mixed");
    let model = write(&folder, "m.gltf", MESH.as_bytes());
    write(&folder, "moves/a.bvh", BVH.as_bytes());
    let moves = folder.join("moves");
    for paths in [[moves.clone(), model.clone()], [model, moves]] {
        let contents = read_paths(&paths, Role::Any).expect("a model and a motion");
        assert_eq!(contents.models[0].model.origin, "m.gltf");
        let motions: Vec<_> =
            contents.motions.iter().flatten().map(|motion| (&*motion.source, &*motion.origin)).collect();
        assert_eq!(motions, [("a.bvh", "moves")]);
    }
    std::fs::remove_dir_all(&folder).expect("it was created");
}

#[test]
fn folders_with_files_of_the_same_names_lose_none() {
    let folder = temporary_folder("alike");
    write(&folder, "a/m.gltf", MESH.as_bytes());
    write(&folder, "b/m.gltf", MESH.as_bytes());
    let contents = read_paths(&["a", "b"].map(|name| folder.join(name)), Role::Any).expect("two models");
    let origins: Vec<&str> = contents.models.iter().map(|opened| &*opened.model.source).collect();
    assert!(matches!(&origins[..], ["m.gltf", other] if other.ends_with("b/m.gltf")), "{origins:?}");
    std::fs::remove_dir_all(&folder).expect("it was created");
}

#[test]
fn folders_have_a_limit_of_files_together() {
    let folder = temporary_folder("many");
    let folders = ["a", "b"].map(|name| folder.join(name));
    for folder in &folders {
        std::fs::create_dir_all(folder).expect("it can be created");
        (0..2049).for_each(|file| std::fs::write(folder.join(file.to_string()), "").expect("it can be written"));
    }
    let error = read_paths(&folders, Role::Any).expect_err("too many");
    assert!(matches!(&error, OpenError::TooManyFiles { path, max: 4096 } if *path == folders[1]), "{error}");
    std::fs::remove_dir_all(&folder).expect("it was created");
}

#[test]
fn a_view_opens_the_files_it_lists() {
    let folder = temporary_folder("view");
    let path = |name: &str, text: &str| write(&folder, name, text.as_bytes()).to_str().expect("Unicode").to_owned();
    let (model, motion, map) = (path("m.gltf", MESH), path("a.bvh", BVH), path("map.json", MAP));
    let link = format!(
        "v=1&model={model}&motion=file:{motion}&motion=nowhere.bvh&motion=sample:walker&map={map}&map=nowhere.json"
    );
    let (state, errors) = from_link(&link);
    assert!(errors.is_empty(), "{errors:?}");
    let disk = Disk::beside(vec![folder.clone()]);
    let (contents, view) = disk.open_view(state, true, Held::default()).expect("the model is there");
    assert_eq!(contents.models.len(), 1);
    let origins = |contents: &gaitway_scene::editor::Contents| -> Vec<String> {
        contents.motions.iter().flatten().map(|motion| motion.origin.clone()).collect()
    };
    assert_eq!(origins(&contents), ["a.bvh", "sample:walker"]);
    let [no_motion, no_map] = &contents.problems[..] else { panic!("{:?}", contents.problems) };
    assert!(no_motion.contains("nowhere.bvh") && no_map.contains("nowhere.json"), "{:?}", contents.problems);
    // Maps and loaded motions are not read again; the model only on request.
    let held: Vec<_> = contents.motions.into_iter().flatten().collect();
    std::fs::remove_dir_all(&folder).expect("it was created");
    let (contents, view) =
        disk.open_view(view, false, Held { motions: &held, ..Held::default() }).expect("no model was asked for");
    assert_eq!((contents.models.len(), origins(&contents)), (0, vec!["sample:walker".to_owned()]));
    assert_eq!(contents.problems.len(), 2, "both motions that are files: {:?}", contents.problems);
    assert!(contents.problems.iter().all(|problem| problem.contains(".bvh")), "{:?}", contents.problems);
    let opened = disk.open_view(view, true, Held { motions: &held, ..Held::default() });
    assert!(matches!(opened, Err(OpenError::Read { .. })));
}

#[test]
fn a_view_opens_no_more_motions_than_it_holds() {
    let motions: String =
        (0..1000).map(|index| format!("&motion=nowhere-{index}.bvh&map=nowhere-{index}.json")).collect();
    let (state, _) = from_link(&format!("v=1&model=sample:walker{motions}"));
    let (contents, view) = Disk::beside(Vec::new()).open_view(state, false, Held::default()).expect("a view");
    let about = |text: &str| contents.problems.iter().filter(|problem| problem.contains(text)).count();
    assert_eq!((about(".bvh"), about(".json"), contents.problems.len()), (64, 64, 129), "{:?}", contents.problems);
    assert_eq!(about("more than 64 motions at once"), 1);
    assert_eq!(view.character.sources.motion.len(), 1000, "the link stays as it is");
}

#[test]
fn a_view_with_thousands_of_models_is_refused_before_any_is_read() {
    let models: String = (0..1000).map(|index| format!("&model=nowhere-{index}.glb")).collect();
    let (state, _) = from_link(&format!("v=1{models}"));
    let refused = Disk::beside(Vec::new()).open_view(state, true, Held::default());
    assert!(matches!(refused, Err(OpenError::Files(SortError::TooManyModels { max: 8 }))), "{:?}", refused.err());
}

#[test]
fn one_of_several_models_that_cannot_be_read_is_left_out() {
    let folder = temporary_folder("models");
    let model = write(&folder, "m.gltf", MESH.as_bytes()).to_str().expect("Unicode").to_owned();
    let disk = Disk::beside(vec![folder.clone()]);
    let open = |link: &str| disk.open_view(from_link(link).0, true, Held::default());
    for link in [format!("model={model}&model=nowhere.glb"), format!("model=nowhere.glb&model={model}")] {
        let (contents, view) = open(&link).expect("one is there");
        assert_eq!(
            contents.models.iter().map(|opened| &*opened.model.source).collect::<Vec<_>>(),
            ["m.gltf"],
            "{link}"
        );
        assert_eq!(view.character.sources.model.len(), 2, "it may be there when the link is opened again");
        let [problem] = &contents.problems[..] else { panic!("{:?}", contents.problems) };
        assert!(problem.starts_with("nowhere.glb: there is no such file"), "{problem}");
    }
    // Without the .obj, its .skel is nothing.
    let skeleton = write(&folder, "a.skel", b"1").to_str().expect("Unicode").to_owned();
    let error = open(&format!("model=nowhere.obj&model={skeleton}")).expect_err("no model").to_string();
    assert!(error.starts_with("nowhere.obj: "), "{error}");
    let error = open("model=nowhere.glb&model=nor.glb").expect_err("nothing is there").to_string();
    assert!(error.starts_with("nowhere.glb: "), "{error}");
    std::fs::remove_dir_all(&folder).expect("it was created");
}

/// White from all directions: one pixel.
const HDR: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81";

#[test]
fn an_hdr_image_is_an_environment() {
    let files = |bytes: &[u8]| {
        let mut set = FileSet::default();
        set.insert("beach.hdr", bytes);
        set
    };
    let sorted = sort(&files(HDR), Role::Any).expect("a whole file");
    assert!(sorted.models.is_empty() && sorted.motions.is_empty());
    let (name, panorama) = sorted.environment.expect("an environment");
    assert_eq!((name.as_str(), panorama.pixels()), ("beach.hdr", &[glam::Vec3::ONE][..]));
    assert!(sort(&files(HDR), Role::Model).is_err(), "it is no model");
    let broken = sort(&files(&HDR[..HDR.len() - 1]), Role::Any).expect_err("a byte is missing").to_string();
    assert_eq!(broken, "beach.hdr: row 1 of 1: the file ends here");
}

#[test]
fn a_view_opens_what_lights_it() {
    let folder = temporary_folder("light");
    let path = write(&folder, "beach.hdr", HDR).to_str().expect("Unicode").to_owned();
    let (state, _) = from_link(&format!("v=1&model=sample:walker&light={path}"));
    let disk = Disk::beside(vec![folder.clone()]);
    let (contents, view) = disk.open_view(state, false, Held::default()).expect("a view");
    let environments = Vec::from_iter(contents.environment);
    assert_eq!(environments[0].origin, path, "what the view calls it");
    std::fs::remove_dir_all(&folder).expect("it was created");
    let held = Held { environments: &environments, ..Held::default() };
    let (contents, view) = disk.open_view(view, false, held).expect("a view");
    assert!(contents.environment.is_none() && contents.problems.is_empty(), "it is not read again");
    let (contents, _) = disk.open_view(view, false, Held::default()).expect("the rest");
    assert!(contents.problems[0].contains("beach.hdr"), "{:?}", contents.problems);
}

#[test]
fn unknown_sources_say_what_was_expected() {
    let sample = open_paths(&["sample:nobody".into()]).expect_err("no such sample").to_string();
    assert!(sample.starts_with("sample:nobody: ") && sample.contains("sample:walker"), "{sample}");
    assert!(matches!(read_paths(&[], Role::Any), Err(OpenError::Nothing)));
}

#[test]
fn a_joint_map_of_any_size() {
    let problem = read_map("map.json", &vec![b' '; MAX_MAP_BYTES + 1]).expect_err("over the limit").to_string();
    assert!(problem.contains("map.json") && problem.contains("at most 16777216 bytes"), "{problem}");
}
