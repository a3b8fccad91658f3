//! NumPy arrays and archives among other files. parts/npz tests what a file means.

use gaitway_formats::{FileSet, Part, load, missing_files, next_preparation, prepare};
use zip::write::SimpleFileOptions;

use crate::numpy::{floats, npz, person, stored};

/// Adds the bytes as a dropped file, converts what needs it, and returns the format and the number of joints.
fn opened(name: &str, bytes: Vec<u8>) -> (&'static str, usize) {
    let mut files = FileSet::default();
    files.add(name, bytes).unwrap();
    assert_eq!(next_preparation(&files).unwrap().map(|preparation| preparation.part), Some(Part::Npz), "{name}");
    prepare(&mut files).unwrap();
    assert_eq!(missing_files(&files), [""; 0]);
    let asset = load(&files).unwrap();
    assert_eq!((asset.clips.len(), asset.instances.len()), (1, 0));
    (asset.format, asset.skeleton.len())
}

#[test]
fn it_is_one_file_whatever_its_name() {
    assert_eq!(opened("walk.npz", npz(&person(22))), ("npz", 22));
    assert_eq!(opened("https://example.org/motion?id=7", stored(&person(52))), ("npz", 52));
    let array = floats("(2, 24, 3)", &[0.0; 144]);
    assert_eq!(opened("walk.npy", array.clone()), ("npy", 24));
    assert_eq!(opened("https://example.org/motion?id=7", array), ("npy", 24));
}

#[test]
fn it_may_be_in_an_archive() {
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    writer.start_file("in/walk.npz", SimpleFileOptions::default()).unwrap();
    std::io::Write::write_all(&mut writer, &npz(&person(24))).unwrap();
    assert_eq!(opened("motions.zip", writer.finish().unwrap().into_inner()), ("npz", 24));
}

#[test]
fn what_is_no_archive_is_an_error() {
    let mut files = FileSet::default();
    files.add("walk.npz", b"<html>404</html>".to_vec()).unwrap();
    let problem = prepare(&mut files).unwrap_err().to_string();
    assert!(problem.contains("walk.npz") && problem.contains("expected a zip archive"), "{problem}");
}
