//! How a model finds the files it refers to: next to it, in folders, in archives, embedded in itself.

use std::io::{Cursor, Write};

use base64::Engine;
use gaitway_formats::{FileSet, LoadError, load, missing_files, next_preparation, referred_file};
use zip::write::SimpleFileOptions;

use crate::build_gltf::{Build, one};

fn buffer() -> Vec<u8> {
    Build::triangle().bytes
}

fn set(files: &[(&str, Vec<u8>)]) -> FileSet {
    let mut set = FileSet::default();
    for (name, bytes) in files {
        set.insert(*name, bytes.clone());
    }
    set
}

fn zipped(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        writer
            .start_file(*name, SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated))
            .unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn unpacked(name: &str, archive: Vec<u8>) -> Result<FileSet, LoadError> {
    let mut files = FileSet::default();
    files.add(name, archive)?;
    Ok(files)
}

/// Loads a complete set and returns the codes of its warnings.
#[track_caller]
fn check(files: &FileSet) -> Vec<&'static str> {
    assert_eq!(missing_files(files), [""; 0]);
    let asset = load(files).unwrap_or_else(|problem| panic!("{problem}"));
    assert_eq!(asset.meshes[0].primitives[0].positions.len(), 3);
    asset.warnings.iter().map(|warning| warning.code()).collect()
}

#[test]
fn a_uri_leads_to_the_file_that_loading_finds() {
    let files = set(&[("a/model.gltf", vec![1]), ("a/skin a.png", vec![2]), ("b/100%.bin", vec![3])]);
    let found = |uri| referred_file(&files, "a/model.gltf", uri).map(|bytes| bytes[0]);
    for (uri, file) in [
        ("skin%20a.png", Some(2)),
        ("skin a.png", Some(2)),
        ("../b/100%25.bin", Some(3)),
        ("textures/SKIN%20A.png", Some(2)),
        ("other.bin", None),
        ("https://example.org/a/other.bin", None),
    ] {
        assert_eq!(found(uri), file, "{uri}");
    }
}

#[test]
fn missing_files_are_listed_decoded_and_once() {
    let mut build = Build::triangle();
    build.json["images"] = serde_json::json!([
        { "uri": "skin%20a.png" }, { "uri": "skin%20a.png" }, { "uri": "data:image/png;base64,AAAA" }
    ]);
    let mut files = one("model.gltf", build.gltf("mesh.bin"));
    assert_eq!(missing_files(&files), ["mesh.bin", "skin a.png"]);
    files.insert("mesh.bin", buffer());
    assert_eq!(missing_files(&files), ["skin a.png"]);
}

#[test]
fn percent_encoded_names() {
    for name in ["mesh data.bin", "mesh%20data.bin"] {
        assert_eq!(check(&set(&[("m.gltf", Build::triangle().gltf("mesh%20data.bin")), (name, buffer())])), [""; 0]);
    }
    assert_eq!(check(&set(&[("m.gltf", Build::triangle().gltf("100%.bin")), ("100%.bin", buffer())])), [""; 0]);
}

#[test]
fn relative_paths() {
    let files =
        set(&[("a/models/m.gltf", Build::triangle().gltf("./../data//mesh.bin")), ("a/data/mesh.bin", buffer())]);
    assert_eq!(check(&files), [""; 0]);
    let files = set(&[("m.gltf", Build::triangle().gltf("data\\mesh.bin")), ("data/mesh.bin", buffer())]);
    assert_eq!(check(&files), [""; 0]);
}

#[test]
fn of_two_files_with_the_same_name_the_nearer_one_is_used() {
    let files =
        set(&[("b/mesh.bin", vec![0; 4]), ("a/m.gltf", Build::triangle().gltf("mesh.bin")), ("a/mesh.bin", buffer())]);
    assert_eq!(check(&files), [""; 0]);
}

#[test]
fn a_bare_name_matches_with_a_warning() {
    for uri in ["C:\\export\\Mesh.BIN", "../elsewhere/mesh.bin"] {
        let files = set(&[("m.gltf", Build::triangle().gltf(uri)), ("mesh.bin", buffer())]);
        assert_eq!(check(&files), ["found-by-bare-name"], "{uri}");
    }
}

/// As browsers resolve them.
#[test]
fn a_backslash_in_a_uri_is_a_slash() {
    for uri in ["sub\\my mesh.bin", "sub%5Cmy%20mesh.bin", ".\\sub/my mesh.bin"] {
        let mut files = set(&[("m.gltf", Build::triangle().gltf(uri))]);
        let missing = missing_files(&files);
        assert_eq!(missing.len(), 1, "{uri}");
        assert_eq!(missing[0].trim_start_matches("./"), "sub/my mesh.bin", "{uri}");
        files.insert("sub/my mesh.bin", buffer());
        assert_eq!(check(&files), [""; 0], "{uri}");
    }
}

#[test]
fn data_uris() {
    let padded = base64::engine::general_purpose::STANDARD.encode(buffer());
    for uri in [
        format!("data:application/octet-stream;base64,{padded}"),
        format!("DATA:;BASE64,{padded}"),
        format!("data:;base64,{}", padded.trim_end_matches('=')),
        format!("data:,{}", percent_encoding::percent_encode(&buffer(), percent_encoding::NON_ALPHANUMERIC)),
    ] {
        assert_eq!(check(&one("m.gltf", Build::triangle().gltf(&uri))), [""; 0], "{uri}");
    }
}

#[test]
fn archives_with_folders() {
    let model = Build::triangle().gltf("textures/../mesh.bin");
    let files = [
        ("character/m.gltf", model),
        ("character/mesh.bin", buffer()),
        ("__MACOSX/character/._m.gltf", b"not a model".to_vec()),
        ("character/._m.gltf", b"not a model".to_vec()),
    ];
    let files = unpacked("character.zip", zipped(&files)).expect("a readable archive");
    assert_eq!(files.names().collect::<Vec<_>>(), ["character/m.gltf", "character/mesh.bin"]);
    assert_eq!(check(&files), [""; 0]);
    // An archive is recognized without its file extension.
    let files = unpacked("download", zipped(&[("m.glb", Build::triangle().glb())])).expect("a readable archive");
    assert_eq!(check(&files), [""; 0]);
}

#[test]
fn an_archive_adds_to_the_other_files() {
    let mut files = one("mesh.bin", vec![0; 4]);
    assert_eq!(files.add("./in//m.gltf", Build::triangle().gltf("mesh.bin")).expect("no archive"), "in/m.gltf");
    assert_eq!(files.add("a.zip", zipped(&[("in/mesh.bin", buffer())])).expect("a readable archive"), "a.zip");
    assert_eq!(files.names().collect::<Vec<_>>(), ["mesh.bin", "in/m.gltf", "in/mesh.bin"]);
    assert_eq!(check(&files), [""; 0]);
}

/// A copy would need twice the memory for a moment.
#[test]
fn a_file_is_not_copied() {
    let fbx = b"Kaydara FBX Binary  \0".to_vec();
    let read = fbx.as_ptr();
    let mut files = FileSet::default();
    files.add("m.fbx", fbx).expect("no archive");
    let held = files.get("m.fbx").expect("it was added");
    let preparation = next_preparation(&files).expect("readable").expect("an .fbx is converted");
    assert_eq!((held.as_ptr(), preparation.input.as_ptr()), (read, read));
}

#[test]
fn broken_archives_report_the_problem() {
    let whole = zipped(&[("m.glb", Build::triangle().glb())]);
    let cut = unpacked("a.zip", whole[..whole.len() / 2].to_vec()).unwrap_err();
    assert!(matches!(cut, LoadError::Archive { .. }) && cut.to_string().contains("a.zip"), "{cut}");
    let empty = unpacked("a.zip", zipped(&[("readme.txt", b"hello".to_vec())])).expect("a readable archive");
    let empty = load(&empty).unwrap_err().to_string();
    assert!(empty.contains("expected a model") && empty.contains("readme.txt"), "{empty}");
}

/// Returns where the directory of an archive of one file begins.
fn directory(archive: &[u8]) -> usize {
    archive.windows(4).rposition(|window| window == b"PK\x01\x02").expect("a central directory")
}

#[test]
fn what_cannot_be_unpacked_names_the_file_and_what_was_found() {
    let whole = zipped(&[("m.glb", Build::triangle().glb())]);
    let check = |change: &dyn Fn(&mut [u8], usize), expected: &str| {
        let (mut archive, at) = (whole.clone(), directory(&whole));
        change(&mut archive, at);
        let problem = unpacked("a.zip", archive).unwrap_err().to_string();
        assert!(
            problem.starts_with("a.zip: “m.glb”: expected ") && problem.contains(expected),
            "{expected}: {problem}"
        );
    };
    check(&|archive, at| archive[at + 8] |= 1, "expected stored or deflated data, found encrypted data; unpack it");
    check(&|archive, at| archive[at + 10] = 14, "expected stored or deflated data, found LZMA; unpack it");
    check(&|archive, at| archive[at + 16] ^= 1, "found other data; download or save it again");
    // The directory has another size, either way, an impossible one, and a wrong offset.
    check(&|archive, at| archive[at + 24] += 1, "found other data");
    check(&|archive, at| archive[at + 24] -= 1, "found other data");
    check(&|archive, at| archive[at + 26] = 0x10, "found other data");
    check(&|archive, at| archive[at + 42] = 1, "of data at byte 1 of the archive, found no such data");
    // A block of the type that Deflate doesn't have.
    check(&|archive, _| archive[30 + "m.glb".len()] |= 0b110, "found other data");
}

#[test]
fn an_archive_is_recognized_by_its_name_or_its_beginning() {
    let whole = zipped(&[("m.glb", Build::triangle().glb()), ("empty", Vec::new())]);
    let prefixed = [b"\r\n", &whole[..]].concat();
    for (name, bytes) in
        [("m", &whole), ("m.zip", &whole), ("M.ZIP", &prefixed), ("https://a.b/m.zip?raw=1", &prefixed)]
    {
        let files = unpacked(name, bytes.clone()).expect(name);
        assert_eq!(files.names().collect::<Vec<_>>(), ["m.glb", "empty"], "{name}");
        assert_eq!(check(&files), [""; 0], "{name}");
    }
    let page = unpacked("a.zip", b"<!DOCTYPE html><title>404</title>".to_vec()).unwrap_err().to_string();
    assert!(page.starts_with("a.zip: expected a zip archive with a list of files at its end, found none"), "{page}");
}

/// The header claims a huge file, so it is refused before anything is unpacked.
#[test]
fn an_archive_that_is_too_large_is_rejected() {
    let mut archive = zipped(&[("m.glb", Build::triangle().glb())]);
    let central = directory(&archive);
    archive[central + 24..central + 28].copy_from_slice(&0xF000_0000_u32.to_le_bytes());
    let problem = unpacked("bomb.zip", archive).unwrap_err().to_string();
    assert!(problem.contains("bomb.zip") && problem.contains("expected at most 2048 MiB in all"), "{problem}");
}

#[test]
fn an_archive_with_too_many_files_is_rejected() {
    let names: Vec<String> = (0..10_001).map(|at| format!("{at}")).collect();
    let files: Vec<(&str, Vec<u8>)> = names.iter().map(|name| (name.as_str(), Vec::new())).collect();
    let problem = unpacked("many.zip", zipped(&files)).unwrap_err().to_string();
    assert!(problem.contains("many.zip") && problem.contains("at most 10000"), "{problem}");
}

#[test]
fn a_model_without_an_extension_is_recognized_by_its_content() {
    assert_eq!(check(&one("blob", Build::triangle().glb())), [""; 0]);
    let files = set(&[("blob", Build::triangle().gltf("mesh.bin")), ("mesh.bin", buffer())]);
    assert_eq!(check(&files), [""; 0]);
}
