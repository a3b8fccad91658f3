//! `gaitway retarget --out-dir --clip-only`, from process start to exit: many BVH clips of 5 seconds, made here, onto a character
//! with 65 joints. Prints clips per second and, on Linux, the most memory that the program held. `cargo bench --bench batch -- 200`
//! sets the number of clips, and a second number their frames per second.

#[path = "../tests/support/data_folder.rs"]
mod data_folder;

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use data_folder::data_folder;

const CLIP_SECS: usize = 5;

/// Joint names with their depth, offset in centimetres and swing in degrees: an adult.
const JOINTS: [(&str, usize, [f64; 3], f64); 22] = [
    ("Hips", 0, [0.0, 95.0, 0.0], 5.0),
    ("LeftUpLeg", 1, [9.0, -5.0, 0.0], 30.0),
    ("LeftLeg", 2, [0.0, -42.0, 0.0], 35.0),
    ("LeftFoot", 3, [0.0, -42.0, 0.0], 15.0),
    ("LeftToeBase", 4, [0.0, -6.0, 13.0], 10.0),
    ("RightUpLeg", 1, [-9.0, -5.0, 0.0], -30.0),
    ("RightLeg", 2, [0.0, -42.0, 0.0], 35.0),
    ("RightFoot", 3, [0.0, -42.0, 0.0], -15.0),
    ("RightToeBase", 4, [0.0, -6.0, 13.0], -10.0),
    ("Spine", 1, [0.0, 11.0, 0.0], 4.0),
    ("Spine1", 2, [0.0, 13.0, 0.0], 4.0),
    ("Spine2", 3, [0.0, 13.0, 0.0], 4.0),
    ("Neck", 4, [0.0, 17.0, 0.0], 5.0),
    ("Head", 5, [0.0, 10.0, 2.0], 8.0),
    ("LeftShoulder", 4, [6.0, 12.0, 0.0], 3.0),
    ("LeftArm", 5, [12.0, 0.0, 0.0], -25.0),
    ("LeftForeArm", 6, [28.0, 0.0, 0.0], 20.0),
    ("LeftHand", 7, [26.0, 0.0, 0.0], 10.0),
    ("RightShoulder", 4, [-6.0, 12.0, 0.0], -3.0),
    ("RightArm", 5, [-12.0, 0.0, 0.0], 25.0),
    ("RightForeArm", 6, [-28.0, 0.0, 0.0], 20.0),
    ("RightHand", 7, [-26.0, 0.0, 0.0], -10.0),
];

fn main() -> std::io::Result<()> {
    let Some(data) = data_folder() else { return Ok(()) };
    let mut numbers = std::env::args().skip(1).filter_map(|argument| argument.parse().ok());
    // `cargo test --benches` only checks that it works.
    let default_count = if std::env::args().any(|argument| argument == "--test") { 3 } else { 1000 };
    let (count, frames_per_sec) = (numbers.next().unwrap_or(default_count), numbers.next().unwrap_or(30));
    let folder = std::env::temp_dir().join(format!("gaitway-batch-{}", std::process::id()));
    let clips = folder.join("clips");
    fs::create_dir_all(&clips)?;
    for number in 0..count {
        fs::write(clips.join(format!("{number:05}.bvh")), bvh(number, frames_per_sec))?;
    }
    let result = run(&data.join("threejs/Xbot.glb"), &clips, &folder.join("out"));
    fs::remove_dir_all(&folder)?;
    let (secs, memory) = result?;
    let rate = count as f64 / secs;
    println!("{count} clips at {frames_per_sec} frames per second: {secs:.2} s, {rate:.0} clips per second, {memory}");
    Ok(())
}

fn run(model: &Path, clips: &Path, out: &Path) -> std::io::Result<(f64, String)> {
    let start = Instant::now();
    let mut program = Command::new(env!("CARGO_BIN_EXE_gaitway"))
        .args(["retarget", "--clip-only", "--model"])
        .arg(model)
        .arg("--motion")
        .arg(clips)
        .arg("--out-dir")
        .arg(out)
        .stdout(Stdio::null())
        .spawn()?;
    let mut memory = String::new();
    while program.try_wait()?.is_none() {
        // The peak so far.
        let status = fs::read_to_string(format!("/proc/{}/status", program.id())).unwrap_or_default();
        if let Some(peak) = status.lines().find_map(|line| line.strip_prefix("VmHWM:")) {
            peak.trim().clone_into(&mut memory);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok((start.elapsed().as_secs_f64(), memory))
}

/// A walk on the spot that no other number has.
fn bvh(number: usize, frames_per_sec: usize) -> String {
    let mut text = "HIERARCHY\n".to_owned();
    let mut depth = 0;
    // Writing to a string cannot fail.
    for (index, (name, level, [x, y, z], _)) in JOINTS.iter().enumerate() {
        text.push_str(&"}\n".repeat(depth - level));
        let (kind, channels) = match index {
            0 => ("ROOT", "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"),
            _ => ("JOINT", "3 Zrotation Xrotation Yrotation"),
        };
        let _ = writeln!(text, "{kind} {name}\n{{\nOFFSET {x} {y} {z}\nCHANNELS {channels}");
        depth = level + 1;
        if JOINTS.get(index + 1).is_none_or(|next| next.1 <= *level) {
            text.push_str("End Site\n{\nOFFSET 0 0 5\n}\n");
        }
    }
    text.push_str(&"}\n".repeat(depth));
    let frames = CLIP_SECS * frames_per_sec;
    let _ = writeln!(text, "MOTION\nFrames: {frames}\nFrame Time: {:.7}", 1.0 / frames_per_sec as f64);
    for frame in 0..frames {
        let phase = TAU * (frame as f64 / frames_per_sec as f64 * (0.8 + 0.0005 * number as f64));
        let _ = write!(text, "{:.4} {:.4} {:.4}", 2.0 * phase.sin(), 95.0 + 2.0 * (2.0 * phase).cos(), phase.cos());
        for (joint, (_, _, _, swing)) in JOINTS.iter().enumerate() {
            let [z, x, y] = [0.2, 1.0, 0.1].map(|part: f64| part * swing * (phase + 0.3 * joint as f64 + part).sin());
            let _ = write!(text, " {z:.4} {x:.4} {y:.4}");
        }
        text.push('\n');
    }
    text
}
