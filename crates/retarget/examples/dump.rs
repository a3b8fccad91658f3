//! temporary
use gaitway_formats::{FileSet, load, missing_files, prepare};
use std::path::Path;
fn main() {
    for path in std::env::args().skip(1) {
        let p = Path::new(&path);
        let folder = p.parent().unwrap();
        let mut files = FileSet::default();
        let Ok(bytes) = std::fs::read(p) else { continue };
        files.insert(p.file_name().unwrap().to_string_lossy(), bytes);
        for uri in missing_files(&files) {
            if let Ok(bytes) = std::fs::read(folder.join(&uri)) {
                files.insert(uri, bytes);
            }
        }
        if prepare(&mut files).is_err() {
            continue;
        }
        let Ok(asset) = load(&files) else {
            println!("{path}\tunreadable");
            continue;
        };
        let start = std::time::Instant::now();
        let r = gaitway_retarget::recognize(&asset);
        let t = start.elapsed().as_secs_f64() * 1e3;
        println!("{path}\t#{} joints, {} skins", asset.skeleton.len(), asset.skins.len());
        eprintln!("{t:.2} ms {path}");
        for (slot, part) in &r.parts {
            println!("{path}\t{slot:?}\t{}\t{}\t{:.2}", asset.skeleton.label(part.joint), part.reason, part.confidence);
        }
    }
}
