//! `gaitway retarget` with `--out-dir`: many motions for one or more models in one process, on all cores. Each result is a line of
//! JSON on standard output, printed as soon as it is written. A motion that fails doesn't end the run, and one whose output is newer
//! than what it is made from is skipped.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs;
use std::io::{IsTerminal, Write, stderr};
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant, SystemTime};

use gaitway_scene::editor::{ClipFormat, OpenedMap};
use serde_json::{Value, json};

use super::RetargetArguments;
use super::failure::{Failure, Outcome};
use super::motion::{open_map, read_motion};
use super::output::{print_error, print_json};
use super::retarget::{Made, clip_file, make};
use super::{inputs, open};
use crate::files::{Disk, Opened, save_file};

/// Shortest time between two updates of the progress.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// A motion for a model, and the file to write.
struct Job {
    /// Index into [`Batch::models`].
    model: usize,
    motion: PathBuf,
    out: PathBuf,
}

struct BatchModel {
    opened: Opened,
    /// Its files, and that of the map.
    files: Vec<PathBuf>,
}

/// Shared by all jobs.
struct Batch<'a> {
    arguments: &'a RetargetArguments,
    /// One for each path in the arguments.
    models: Vec<BatchModel>,
    map: Option<OpenedMap>,
    format: ClipFormat,
}

pub(super) fn run(arguments: &RetargetArguments, folder: &Path, disk: &Disk) -> Outcome {
    let map = arguments.map.as_deref().map(|path| open_map(path, disk)).transpose()?;
    let opened = |path| {
        let own = Disk::default();
        let opened = open(std::slice::from_ref(path), &own)?;
        Ok(BatchModel { opened, files: [own.files_read(), disk.files_read()].concat() })
    };
    let models = arguments.model.iter().map(opened).collect::<Outcome<Vec<BatchModel>>>()?;
    let format = arguments.format.map_or(ClipFormat::Glb, Into::into);
    let jobs = jobs(arguments, folder, format)?;
    refuse_inputs(&jobs, models.iter().flat_map(|model| model.files.iter().cloned()))?;
    let batch = Batch { arguments, models, map, format };
    let workers = arguments.jobs.or(std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let progress = Progress::new(jobs.len());
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (line, outcome) = batch.line(job);
            progress.done(&line, outcome);
        }
    };
    std::thread::scope(|scope| {
        (1..workers.min(jobs.len())).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    progress.finish()
}

/// How a job ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ended {
    Written,
    Skipped,
    Failed,
}

impl Batch<'_> {
    /// Does a job and returns its line.
    fn line(&self, job: &Job) -> (Value, Ended) {
        let name = |path: &Path| path.display().to_string();
        let model = name(&self.arguments.model[job.model]);
        let mut line = json!({ "model": model, "motion": name(&job.motion), "out": name(&job.out) });
        if self.is_up_to_date(job) {
            line["skipped"] = json!("the output is newer than the motion, the model and the map");
            return (line, Ended::Skipped);
        }
        match guarded(|| self.write(job)) {
            Ok(made) => {
                for (key, value) in summary(made.document) {
                    line[key] = value;
                }
                (line, Ended::Written)
            }
            Err(failure) => {
                line["error"] = json!(failure);
                (line, Ended::Failed)
            }
        }
    }

    /// Whether the output is newer than all that it is made from. A file whose time is unknown, such as a member of an
    /// archive, may have changed.
    fn is_up_to_date(&self, job: &Job) -> bool {
        let Some(written) = modified(&job.out) else { return false };
        let mut inputs = self.models[job.model].files.iter().chain([&job.motion]);
        inputs.all(|path| modified(path).is_some_and(|changed| changed < written))
    }

    fn write(&self, job: &Job) -> Outcome<Made> {
        let motion = read_motion(&job.motion, &Disk::default())?;
        let opened = &self.models[job.model].opened;
        let made = make(&self.arguments.choices, &opened.model, &motion, self.map.as_ref())?;
        let bytes = clip_file(opened, &made, self.arguments.clip_only, self.format)?;
        if let Some(folder) = job.out.parent() {
            fs::create_dir_all(folder)
                .map_err(|error| Failure::new(crate::files::describe(&error)).in_file(folder.display()))?;
        }
        save_file(&job.out, &bytes, &[])?;
        Ok(made)
    }
}

/// Does a job. A panic, which is a bug in Gaitway, fails that job alone.
fn guarded<T>(job: impl FnOnce() -> Outcome<T>) -> Outcome<T> {
    // Jobs only read what they share.
    catch_unwind(AssertUnwindSafe(job)).unwrap_or_else(|_| {
        Err(Failure::new("this motion triggers a bug in Gaitway").with_hint("please report it, with the file"))
    })
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).ok()?.modified().ok()
}

/// Reduces the document of a single motion to a line: joints are counted instead of listed.
fn summary(mut document: Value) -> Vec<(&'static str, Value)> {
    let counted = ["mapped", "unmapped_targets", "unused_sources", "resampled_joints"];
    let kept = [
        "clip",
        "duration_secs",
        "hips_scale",
        "keys_in",
        "keys_out",
        "figures",
        "planting",
        "motion_rest",
        "changed",
        "warnings",
    ];
    let count = |key: &'static str| (key, json!(document[key].as_array().map_or(0, Vec::len)));
    let mut summary: Vec<(&'static str, Value)> = counted.into_iter().map(count).collect();
    summary.extend(kept.into_iter().map(|key| (key, document[key].take())));
    summary
}

/// Finds the motions and their outputs; files in a folder keep their relative paths.
fn jobs(arguments: &RetargetArguments, folder: &Path, format: ClipFormat) -> Outcome<Vec<Job>> {
    let folders = model_folders(&arguments.model, folder)?;
    let mut jobs = Vec::new();
    let mut origins: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    for inputs::Input { file, relative } in inputs::motions(&arguments.motion, folder)? {
        let mut name = stem(&relative).to_owned();
        name.push(format!(".{}", format.extension()));
        let relative = relative.with_file_name(name);
        if let Some(other) = origins.insert(relative.clone(), file.clone()) {
            if other == file {
                continue;
            }
            return Err(same_output(&other, &file, &folders[0].join(relative)));
        }
        let of_model =
            |(model, folder): (usize, &PathBuf)| Job { model, motion: file.clone(), out: folder.join(&relative) };
        jobs.extend(folders.iter().enumerate().map(of_model));
    }
    Ok(jobs)
}

/// The folder of each model's results: that of the results itself if there is one model, else one of the model's name in it.
fn model_folders(models: &[PathBuf], folder: &Path) -> Outcome<Vec<PathBuf>> {
    if models.len() == 1 {
        return Ok(vec![folder.to_owned()]);
    }
    let mut folders: Vec<PathBuf> = Vec::new();
    for model in models {
        let name = stem(model).to_string_lossy();
        let own = folder.join(name.strip_prefix("sample:").unwrap_or(&name));
        // Some file systems don't tell capitals apart.
        let lower = |path: &Path| path.to_string_lossy().to_lowercase();
        if let Some(other) = folders.iter().position(|folder| lower(folder) == lower(&own)) {
            return Err(same_output(&models[other], model, &own));
        }
        folders.push(own);
    }
    Ok(folders)
}

/// Returns a file's name without its extension, or with it if the rest would be `.` or `..`, which name other folders.
fn stem(path: &Path) -> &OsStr {
    let named = path.file_stem().filter(|stem| ![".", ".."].map(OsStr::new).contains(stem));
    named.or(path.file_name()).unwrap_or_default()
}

fn same_output(one: &Path, other: &Path, out: &Path) -> Failure {
    let problem = format!("{} and {} would both become {}", one.display(), other.display(), out.display());
    Failure::new(problem).with_hint("retarget them to different folders")
}

/// Refuses outputs that are inputs, before anything is written. `files` are those of the models and the map.
fn refuse_inputs(jobs: &[Job], files: impl Iterator<Item = PathBuf>) -> Outcome {
    let motions = jobs.iter().map(|job| job.motion.clone());
    let inputs: BTreeSet<PathBuf> = files.chain(motions).filter_map(|path| fs::canonicalize(path).ok()).collect();
    let is_input = |job: &&Job| fs::canonicalize(&job.out).is_ok_and(|path| inputs.contains(&path));
    match jobs.iter().find(is_input) {
        Some(job) => Err(Failure::new("this output is one of the inputs").in_file(job.out.display())),
        None => Ok(()),
    }
}

/// Prints the lines and, on a terminal, the progress.
struct Progress {
    total: usize,
    start: Instant,
    is_shown: bool,
    state: Mutex<ProgressState>,
}

struct ProgressState {
    written: usize,
    skipped: usize,
    failed: usize,
    drawn: Option<Instant>,
    /// Standard output is closed or full.
    broken: Option<Failure>,
}

impl Progress {
    fn new(total: usize) -> Self {
        let state = ProgressState { written: 0, skipped: 0, failed: 0, drawn: None, broken: None };
        Self { total, start: Instant::now(), is_shown: stderr().is_terminal(), state: Mutex::new(state) }
    }

    fn done(&self, line: &Value, ended: Ended) {
        let Ok(mut state) = self.state.lock() else { return };
        match ended {
            Ended::Written => state.written += 1,
            Ended::Skipped => state.skipped += 1,
            Ended::Failed => state.failed += 1,
        }
        self.clear_line();
        if let Err(failure) = print_json(line) {
            state.broken.get_or_insert(failure);
        }
        if self.is_shown && state.drawn.is_none_or(|drawn| drawn.elapsed() >= PROGRESS_INTERVAL) {
            state.drawn = Some(Instant::now());
            let secs = self.start.elapsed().as_secs_f64();
            let _ = write!(stderr(), "{}", progress_text(&state, self.total, secs));
        }
    }

    fn clear_line(&self) {
        if self.is_shown {
            let _ = write!(stderr(), "\r\x1b[K");
        }
    }

    fn finish(self) -> Outcome {
        self.clear_line();
        let secs = self.start.elapsed().as_secs_f64();
        let Ok(state) = self.state.into_inner() else { return Ok(()) };
        let ProgressState { written, skipped, failed, broken, .. } = state;
        print_error(&format!("{written} written, {skipped} skipped, {failed} failed in {secs:.1} s"));
        if let Some(failure) = broken {
            return Err(failure);
        }
        if failed > 0 {
            return Err(Failure::new(format!("{failed} of {} results failed; their lines say why", self.total)));
        }
        Ok(())
    }
}

/// Formats a bar, how many results are done, the rate, and the time left.
fn progress_text(state: &ProgressState, total: usize, secs: f64) -> String {
    const CELLS: usize = 24;
    let done = state.written + state.skipped + state.failed;
    let filled = CELLS * done / total.max(1);
    // Skipping takes no time.
    let rate = (state.written + state.failed) as f64 / secs.max(1e-3);
    let left = if rate > 0.0 { format!(", {:.0} s left", (total - done) as f64 / rate) } else { String::new() };
    let bar = "#".repeat(filled) + &".".repeat(CELLS - filled);
    format!("[{bar}] {done} of {total}, {rate:.1} per second{left}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_failure() {
        let failed = guarded(|| if std::hint::black_box(true) { panic!("as the test asked") } else { Ok(()) });
        assert!(failed.is_err_and(|failure| failure.message().contains("please report it")));
        assert_eq!(guarded(|| Ok(1)).ok(), Some(1));
    }

    #[test]
    fn progress_has_a_bar_the_rate_of_what_took_time_and_the_time_left() {
        let state = |written, skipped| ProgressState { written, skipped, failed: 0, drawn: None, broken: None };
        let check = |state: &ProgressState, expected: &str| assert_eq!(progress_text(state, 48, 2.0), expected);
        check(&state(0, 0), "[........................] 0 of 48, 0.0 per second");
        check(&state(8, 4), "[######..................] 12 of 48, 4.0 per second, 9 s left");
        check(&state(48, 0), "[########################] 48 of 48, 24.0 per second, 0 s left");
    }
}
