//! Loading real files from memory: time per file, without decoding images, slowest first. An argument selects the files
//! whose paths contain it.

mod support;

use std::hint::black_box;
use std::path::{Path, PathBuf};

use gaitway_formats::load;
use support::data_folder::data_folder;
use support::{files_of, measure};

fn main() {
    let Some(folder) = data_folder() else { return };
    let mut models = Vec::new();
    find_models(&folder, &mut models);
    models.sort();
    if let Some(word) = std::env::args().skip(1).find(|argument| !argument.starts_with('-')) {
        models.retain(|path| path.to_string_lossy().contains(&word));
    }
    let mut rows = Vec::new();
    let mut rejected = 0;
    for path in models {
        let Some(files) = files_of(&path) else { continue };
        if load(&files).is_err() {
            rejected += 1;
            continue;
        }
        let bytes: usize = files.names().filter_map(|name| files.get(name)).map(|bytes| bytes.len()).sum();
        let nanos = measure(|| {
            black_box(load(black_box(&files))).ok();
        });
        let name = path.strip_prefix(&folder).unwrap_or(&path).display().to_string();
        rows.push((nanos.median, nanos.fastest, bytes, name));
    }
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("{:>10} {:>10} {:>10} {:>10}", "ms", "(fastest)", "KiB", "MiB/s");
    for (median, fastest, bytes, name) in &rows {
        let size = *bytes as f64;
        let rate = size / (1 << 20) as f64 / (median * 1e-9);
        println!("{:>10.3} {:>10.3} {:>10.0} {rate:>10.0}  {name}", median / 1e6, fastest / 1e6, size / 1024.0);
    }
    println!("{} files; {rejected} more fail to load and are not timed", rows.len());
}

fn find_models(folder: &Path, models: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            find_models(&path, models);
        } else if path
            .extension()
            .is_some_and(|extension| ["glb", "gltf", "vrm"].iter().any(|known| extension == *known))
        {
            models.push(path);
        }
    }
}
