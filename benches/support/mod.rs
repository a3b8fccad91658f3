//! Timing for the benches: median and minimum of many short rounds. Compare only figures of one run on one machine; on
//! a busy machine, the minimum.

#[path = "../../tests/support/data_folder.rs"]
pub mod data_folder;

use std::path::Path;
use std::time::{Duration, Instant};

use gaitway_formats::{FileSet, missing_files};

const ROUNDS: usize = 41;
const ROUND: Duration = Duration::from_millis(12);

/// Nanoseconds per call.
pub struct Nanos {
    pub median: f64,
    pub fastest: f64,
}

/// Times `work`. With `--test`, which `cargo test --benches` passes, it runs once to check that it works.
pub fn measure(mut work: impl FnMut()) -> Nanos {
    let once = Instant::now();
    work();
    if std::env::args().any(|argument| argument == "--test") {
        let nanos = once.elapsed().as_secs_f64() * 1e9;
        return Nanos { median: nanos, fastest: nanos };
    }
    let mut calls = 1_u32;
    loop {
        let start = Instant::now();
        (0..calls).for_each(|_| work());
        let spent = start.elapsed();
        if spent >= ROUND {
            break;
        }
        calls =
            (f64::from(calls) * (ROUND.as_secs_f64() / spent.as_secs_f64().max(1e-9)).clamp(1.2, 50.0)).ceil() as u32;
    }
    // Slow work gets fewer rounds.
    let start = Instant::now();
    let mut nanos = Vec::new();
    while nanos.len() < ROUNDS && (nanos.len() < 5 || start.elapsed() < Duration::from_secs(2)) {
        let start = Instant::now();
        (0..calls).for_each(|_| work());
        nanos.push(start.elapsed().as_secs_f64() * 1e9 / f64::from(calls));
    }
    nanos.sort_by(f64::total_cmp);
    Nanos { median: nanos[nanos.len() / 2], fastest: nanos[0] }
}

/// Reads a model and the files it references.
#[allow(dead_code)]
pub fn files_of(path: &Path) -> Option<FileSet> {
    let mut files = FileSet::default();
    files.insert(path.file_name()?.to_str()?, std::fs::read(path).ok()?);
    for name in missing_files(&files) {
        if let Ok(bytes) = std::fs::read(path.parent()?.join(&name)) {
            files.insert(name, bytes);
        }
    }
    Some(files)
}
