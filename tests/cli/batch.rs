//! Many motions in one run of `gaitway retarget`.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

use serde_json::Value;

use crate::motion::folder;
use crate::program::{check_fails, run};

/// The lines of a run, sorted by motion.
fn lines(arguments: &[&str], status: i32) -> Vec<Value> {
    let output = run(arguments);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {error}");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    lines.sort_by_key(|line| line["motion"].to_string());
    lines
}

#[test]
fn many_motions_are_retargeted_and_resumed() {
    let (folder, motion) = folder("batch");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    fs::create_dir_all(folder.join("in/below")).expect("a folder");
    for name in ["in/a.bvh", "in/b.bvh", "in/below/a.bvh"] {
        fs::copy(&motion, folder.join(name)).expect("a copy");
    }
    fs::write(folder.join("in/bad.bvh"), "nonsense").expect("a file");
    fs::write(folder.join("in/notes.txt"), "no motion").expect("a file");
    let (inputs, out) = (path("in"), path("out"));
    let call =
        ["retarget", "--model", "sample:walker", "--motion", &inputs, "--out-dir", &out, "--clip-only", "--jobs", "2"];
    let first = lines(&call, 1);
    let outs: Vec<&str> = first.iter().map(|line| line["out"].as_str().expect("a path")).collect();
    assert_eq!(outs, [path("out/a.glb"), path("out/b.glb"), path("out/bad.glb"), path("out/below/a.glb")]);
    for (line, is_bad) in first.iter().zip([false, false, true, false]) {
        assert_eq!(line["error"]["message"].is_string(), is_bad, "{line}");
        assert_eq!(line["figures"]["coverage"].is_number(), !is_bad, "{line}");
        assert_eq!(fs::exists(line["out"].as_str().expect("a path")).expect("readable"), !is_bad);
    }
    assert_eq!(first[0]["mapped"].as_u64(), Some(9), "{}", first[0]);
    // Alone, the same figures and the same file.
    let alone = path("alone.glb");
    let single = crate::program::document(&[
        "retarget",
        "--model",
        "sample:walker",
        "--motion",
        &path("in/a.bvh"),
        "--out",
        &alone,
        "--clip-only",
        "--json",
    ]);
    assert_eq!(single["figures"], first[0]["figures"]);
    assert_eq!(fs::read(alone).expect("a file"), fs::read(path("out/a.glb")).expect("a file"));
    // Only what has changed since is made again.
    let newer = fs::File::options().write(true).open(path("in/b.bvh")).expect("a file");
    newer.set_modified(SystemTime::now() + Duration::from_secs(60)).expect("a time");
    let kinds = |lines: &[Value]| -> Vec<&'static str> {
        let kind = |line: &Value| match (line["skipped"].is_string(), line["error"].is_object()) {
            (true, _) => "skipped",
            (_, true) => "failed",
            _ => "written",
        };
        lines.iter().map(kind).collect()
    };
    assert_eq!(kinds(&lines(&call, 1)), ["skipped", "written", "failed", "skipped"]);
    // Results below the motions aren't motions of the next run.
    fs::remove_file(folder.join("in/bad.bvh")).expect("a file");
    let (whole, out) = (path("in"), path("in/out"));
    let call = ["retarget", "--model", "sample:walker", "--motion", &whole, "--out-dir", &out, "--clip-only"];
    assert_eq!(kinds(&lines(&call, 0)), ["written"; 3]);
    assert_eq!(lines(&call, 0).len(), 3);
}

/// Whatever was written before the program was killed is whole, and only the rest is made afterwards.
#[test]
fn a_killed_run_is_resumed() {
    const COUNT: usize = 400;
    let (folder, motion) = folder("killed");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    fs::create_dir_all(folder.join("in")).expect("a folder");
    for index in 0..COUNT {
        fs::copy(&motion, folder.join(format!("in/{index:03}.bvh"))).expect("a copy");
    }
    let (inputs, out) = (path("in"), path("out"));
    let call = ["retarget", "--model", "sample:walker", "--motion", &inputs, "--out-dir", &out, "--clip-only"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let mut child = command.args(call).stdout(Stdio::piped()).spawn().expect("the program runs");
    let first = BufReader::new(child.stdout.take().expect("a pipe")).lines().next();
    child.kill().expect("it runs");
    child.wait().expect("it ran");
    assert!(first.is_some_and(|line| line.is_ok_and(|line| line.contains("\"figures\""))));
    let is_result = |name: &str| name.ends_with(".glb");
    let files = || -> Vec<(String, Vec<u8>)> {
        let entries = fs::read_dir(&out).expect("a folder").map(|entry| entry.expect("an entry"));
        let results = entries.filter(|entry| entry.file_name().to_str().is_some_and(is_result));
        results.map(|file| (file.path().display().to_string(), fs::read(file.path()).expect("a file"))).collect()
    };
    let before = files();
    assert!((1..COUNT).contains(&before.len()), "{} of {COUNT} were written", before.len());
    let resumed = lines(&call, 0);
    let skipped = resumed.iter().filter(|line| line["skipped"].is_string()).count();
    assert_eq!((resumed.len(), skipped), (COUNT, before.len()));
    let after = files();
    assert_eq!(after.len(), COUNT);
    assert_eq!(fs::read_dir(&out).expect("a folder").count(), COUNT, "no temporary file is left");
    assert!(
        before.iter().all(|file| after.contains(file)) && after.iter().all(|file| file.1.len() == after[0].1.len())
    );
}

/// A member of a folder or an archive has no time of its own, so it may have changed.
#[test]
fn members_are_retargeted_every_time() {
    let (folder, motion) = folder("members");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let (model, out) = (path("model.glb"), path("out"));
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--out", &model];
    assert!(run(&retarget).status.success());
    let member = format!("{}#!/walk.bvh", path(""));
    let is_skipped = |motion: &str| {
        let call = ["retarget", "--model", &model, "--motion", motion, "--out-dir", &out, "--clip-only"];
        lines(&call, 0)[0]["skipped"].is_string()
    };
    assert_eq!([&member, &member, &motion].map(|motion| is_skipped(motion)), [false, false, true]);
}

#[test]
fn patterns_formats_and_single_files_work_together() {
    let (folder, motion) = folder("patterns");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    fs::create_dir_all(folder.join("in/below")).expect("a folder");
    for name in ["in/one.bvh", "in/two.bvh", "in/below/three.bvh"] {
        fs::copy(&motion, folder.join(name)).expect("a copy");
    }
    let (pattern, out) = (path("in/**/t*.bvh"), path("out"));
    let call = |inputs: &[&str]| -> Vec<String> {
        let call =
            [&["retarget", "--model", "sample:walker", "--out-dir", &out, "--format", "bvh", "--motion"], inputs]
                .concat();
        lines(&call, 0).iter().map(|line| line["out"].as_str().expect("a path").to_owned()).collect()
    };
    assert_eq!(
        call(&[&pattern, &path("in/one.bvh")]),
        [path("out/below/three.bvh"), path("out/one.bvh"), path("out/two.bvh")]
    );
    let text = fs::read_to_string(path("out/one.bvh")).expect("a file");
    assert!(text.starts_with("HIERARCHY"));
}

#[test]
fn outputs_never_replace_inputs_or_each_other() {
    let (folder, motion) = folder("clashes");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    fs::create_dir_all(folder.join("other")).expect("a folder");
    fs::copy(&motion, folder.join("other/walk.bvh")).expect("a copy");
    let (here, other) = (path(""), path("other/walk.bvh"));
    let model = ["retarget", "--model", "sample:walker", "--motion"];
    let before = fs::read(&motion).expect("a file");
    check_fails(&[&model[..], &[&motion, "--out-dir", &here, "--format", "bvh"]].concat(), 1, "one of the inputs");
    check_fails(&[&model[..], &[&motion, &other, "--out-dir", &path("out")]].concat(), 1, "would both become");
    check_fails(&[&model[..], &[&motion, &other, "--out", &path("one.glb")]].concat(), 1, "--out-dir takes any number");
    check_fails(&[&model[..], &[&path("*.fbx"), "--out-dir", &path("out")]].concat(), 1, "expected motions");
    check_fails(&[&model[..], &[&motion]].concat(), 2, "--out");
    assert_eq!(fs::read(&motion).expect("a file"), before);
    assert!(!folder.join("out").exists());
}

/// Without their extensions, these names are those of other folders.
#[test]
fn names_of_dots_are_names() {
    let (folder, motion) = folder("dots");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    for name in ["..bvh", "...bvh"] {
        fs::copy(&motion, folder.join(name)).expect("a copy");
    }
    let (out, model) = (path("in/out"), path("...glb"));
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--out", &model];
    assert!(run(&retarget).status.success());
    let motions = ["--motion", &path("..bvh"), &path("...bvh"), "--out-dir", &out, "--clip-only"];
    let made = lines(&[&["retarget", "--model", "sample:walker", &model], &motions[..]].concat(), 0);
    let mut outs: Vec<&str> = made.iter().map(|line| line["out"].as_str().expect("a path")).collect();
    outs.sort_unstable();
    let expected = ["...glb/...bvh.glb", "...glb/..bvh.glb", "walker/...bvh.glb", "walker/..bvh.glb"];
    assert_eq!(outs, expected.map(|name| format!("{out}/{name}")));
    assert!(outs.iter().all(|out| Path::new(out).is_file()), "{made:?}");
}

#[test]
fn motions_are_retargeted_to_several_models() {
    let (folder, motion) = folder("models");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let (model, out) = (path("model.glb"), path("out"));
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--out"];
    assert!(run(&[&retarget[..], &[&model]].concat()).status.success());
    let call = |models: &[&str], status| {
        let rest = ["--motion", &motion, "--out-dir", &out, "--clip-only"];
        lines(&[&["retarget", "--model"], models, &rest].concat(), status)
    };
    let mut made = call(&["sample:walker", &model], 0);
    made.sort_by_key(|line| line["out"].to_string());
    let [other, walker] = &made[..] else { panic!("a line for each model: {made:?}") };
    assert_eq!([&walker["model"], &other["model"]], ["sample:walker", &model]);
    assert_eq!([&walker["out"], &other["out"]], [&path("out/walker/walk.glb"), &path("out/model/walk.glb")]);
    let alone = path("alone.glb");
    assert!(run(&[&retarget[..], &[&alone]].concat()).status.success());
    assert_eq!(fs::read(path("out/walker/walk.glb")).expect("a file"), fs::read(alone).expect("a file"));
    // Another model later doesn't touch the results of those that are there.
    let second = path("second.glb");
    fs::copy(&model, &second).expect("a copy");
    let again = call(&[&model, &second], 0);
    let written: Vec<&Value> =
        again.iter().filter(|line| line["skipped"].is_null()).map(|line| &line["model"]).collect();
    assert_eq!(written, [&second], "{again:?}");
    check_fails(
        &["retarget", "--model", &model, &model, "--motion", &motion, "--out-dir", &out],
        1,
        "would both become",
    );
    check_fails(
        &["retarget", "--model", &model, "sample:walker", "--motion", &motion, "--out", &path("one.glb")],
        1,
        "--model: expected one model, found 2",
    );
}
