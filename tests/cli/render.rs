//! `gaitway render` as scripts use it.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use gaitway_render::headless_device;
use serde_json::json;

use crate::adapter::or_skipped;
use crate::build_gltf::Build;

fn render(arguments: &[&str]) -> Output {
    render_file("sample:walker", arguments)
}

fn render_file(file: &str, arguments: &[&str]) -> Output {
    // Without this variable, Mesa reports a spurious error.
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let command = command.args(["render", file, "--size", "8x8"]).args(arguments);
    command.env_remove("XDG_RUNTIME_DIR").output().expect("the program runs")
}

#[test]
fn a_picture_can_be_piped_and_drivers_are_quiet() {
    if or_skipped(headless_device()).is_none() {
        return;
    }
    let output = render(&["--out", "-"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let picture = image::load_from_memory(&output.stdout).expect("a PNG");
    assert_eq!((picture.width(), picture.height()), (8, 8));
    let lines: Vec<&str> = said.lines().collect();
    assert!(matches!(lines[..], [line] if line.starts_with("rendering with ")), "{said}");
    // Errors are still reported.
    let refused = render(&["--out", "picture.glb"]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(said.ends_with("error: picture.glb: file extension: expected .png, found .glb\n"), "{said}");
}

/// The background shows what lights the scene: white all around, however it is named.
#[test]
fn a_picture_is_lit_by_what_the_option_names() {
    if or_skipped(headless_device()).is_none() {
        return;
    }
    let path = std::env::temp_dir().join(format!("gaitway-white-{}.hdr", std::process::id()));
    std::fs::write(&path, b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81")
        .expect("a file is written");
    let file = path.to_str().expect("Unicode");
    for environment in ["white", file] {
        let view = "background=environment&show=";
        let output = render(&["--out", "-", "--environment", environment, "--view", view]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let picture = image::load_from_memory(&output.stdout).expect("a PNG").into_rgba8();
        assert_eq!(picture.get_pixel(0, 0).0, [240, 240, 240, 255], "{environment}");
    }
    std::fs::remove_file(&path).expect("it was written");
    let refused = render(&["--out", "-", "--environment", file]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(refused.status.code() == Some(1) && said.contains("gaitway-white"), "{said}");
}

/// A triangle that is white, and red, blue or coated in its variants.
#[test]
fn a_picture_shows_the_variant_that_the_option_or_the_link_names() {
    if or_skipped(headless_device()).is_none() {
        return;
    }
    let mut build = Build::triangle();
    let material = |color: [f32; 4]| {
        let color = json!({ "baseColorFactor": color });
        json!({ "pbrMetallicRoughness": color, "extensions": { "KHR_materials_unlit": {} } })
    };
    let colors = [[1.0; 4], [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]];
    build.json["materials"] = colors.map(material).to_vec().into();
    let coat = json!({ "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 1 } } });
    build.json["materials"].as_array_mut().expect("materials").push(coat);
    let variants = json!([{ "name": "Red" }, { "name": "Blue & more" }, { "name": "Coat" }]);
    build.json["extensions"] = json!({ "KHR_materials_variants": { "variants": variants } });
    let mappings = [0, 1, 2].map(|variant| json!({ "material": variant + 1, "variants": [variant] }));
    let primitive = &mut build.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["extensions"] = json!({ "KHR_materials_variants": { "mappings": mappings } });
    let path = std::env::temp_dir().join(format!("gaitway-variants-{}.glb", std::process::id()));
    std::fs::write(&path, build.glb()).expect("a file is written");
    let file = path.to_str().expect("Unicode");
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    for (arguments, color) in [
        (&[][..], [255, 255, 255, 255]),
        (&["--variant", "Blue & more"], [0, 0, 255, 255]),
        (&["--view", "v=1&variant=Red"], [255, 0, 0, 255]),
        (&["--view", "v=1&variant=Red", "--variant", "Blue & more"], [0, 0, 255, 255]),
        (&["--view", "v=1&variant=Green"], [255, 255, 255, 255]),
    ] {
        let near = ["--out", "-", "--camera", "0,0,0.5"];
        let output = render_file(file, &[&near[..], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {}", said(&output));
        let unknown = "--view: variant: expected the name of a material variant, found “Green”";
        let has_unknown = arguments.contains(&"v=1&variant=Green");
        assert_eq!(said(&output).contains(unknown), has_unknown, "{}", said(&output));
        let picture = image::load_from_memory(&output.stdout).expect("a PNG").into_rgba8();
        assert_eq!(picture.get_pixel(3, 4).0, color, "{arguments:?}");
    }
    let edges = render_file(file, &["--out", "-", "--view", "show=wireframe", "--variant", "Coat"]);
    assert!(edges.status.success(), "the wireframe has no lobes: {}", said(&edges));
    let refused = render_file(file, &["--out", "-", "--variant", "Green"]);
    assert_eq!(refused.status.code(), Some(1));
    let says = "expected the name of a material variant, found “Green”; its variants are “Red”, “Blue & more”, “Coat”";
    assert!(said(&refused).contains(says) && said(&refused).contains("gaitway-variants"), "{}", said(&refused));
    std::fs::remove_file(&path).expect("it was written");
}

/// A folder that is removed again.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("gaitway-test-{name}-{}", std::process::id()));
        fs::create_dir(&path).expect("a new folder");
        Self(path)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("Unicode").to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Eight by eight pixels, seen from so near that a leg covers them all from time to time.
const WALKING: [&str; 6] = ["--clip", "Walk", "--camera", "0,0,1.2", "--frames", "10"];
/// The walker's stride takes 16/15 seconds.
const WALKING_FRAMES: usize = 11;

fn refusal(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned()
}

#[test]
fn the_frames_of_a_loop_become_pictures() {
    if or_skipped(headless_device()).is_none() {
        return;
    }
    let folder = Folder::new("frames");
    let out = folder.path("walk");
    let render_walk = || render(&[&WALKING[..], &["--out", &out]].concat());
    let output = render_walk();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut names: Vec<PathBuf> =
        fs::read_dir(&out).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    names.sort();
    assert_eq!(names.len(), WALKING_FRAMES);
    assert_eq!(names[0].file_name().expect("a name"), "frame-01.png");
    // The frame at 0.5 seconds is the picture at 0.5 seconds.
    let still = render(&["--clip", "Walk", "--camera", "0,0,1.2", "--time", "0.5", "--out", "-"]);
    let pixels = |png: &[u8]| image::load_from_memory(png).expect("a PNG").into_rgba8().into_raw();
    let frames: Vec<Vec<u8>> = names.iter().map(|name| pixels(&fs::read(name).expect("a frame"))).collect();
    assert_eq!(frames[5], pixels(&still.stdout));
    assert!(frames.iter().skip(1).any(|frame| *frame != frames[0]), "something should move");

    let again = refusal(&render_walk());
    assert_eq!(again, format!("error: {out}: expected a new or an empty folder, found one with files"));
    let rest = refusal(&render(&["--frames", "10", "--out", &folder.path("rest")]));
    assert_eq!(rest, "error: --frames: nothing moves; choose a clip with --clip");
}

#[test]
fn the_frames_of_a_loop_become_a_video() {
    if or_skipped(headless_device()).is_none() {
        return;
    }
    let folder = Folder::new("video");
    for name in ["walk.mp4", "walk.webm", "walk.gif"] {
        let out = folder.path(name);
        let output = render(&[&WALKING[..], &["--out", &out]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let decode = ["-v", "error", "-i", &out, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"];
        let decoded = Command::new("ffmpeg").args(decode).output().expect("ffmpeg");
        assert_eq!(decoded.stdout.len(), WALKING_FRAMES * 8 * 8 * 3, "{name}");
    }
    // A folder for temporary files whose name is an option of ffmpeg's.
    fs::create_dir(folder.path("-f")).expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let command = command.current_dir(&folder.0).env("TMPDIR", "-f").args(["render", "sample:walker", "--size", "8x8"]);
    let output = command.args(WALKING).args(["--out", "odd.gif"]).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(fs::read_dir(folder.path("-f")).expect("a folder").next().is_none(), "nothing is left");
    let refused = |arguments: &[&str]| refusal(&render(&[&WALKING[..], arguments].concat()));
    let avi = folder.path("walk.avi");
    let found = refused(&["--out", &avi]);
    assert_eq!(found, format!("error: {avi}: file extension: expected .mp4 or .webm or .gif, found .avi"));
    let found = refused(&["--out", "-"]);
    assert_eq!(found, "error: --out: expected a folder, or a file ending in .mp4, .webm or .gif, found -");
    let clear = folder.path("clear.mp4");
    let found = refused(&["--out", &clear, "--view", "background=transparent"]);
    assert!(found.starts_with(&format!("error: {clear}: an .mp4 can't be transparent; ")), "{found}");
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let command = command.args(["render", "sample:walker", "--out", &clear]).args(WALKING).env("PATH", "");
    let found = refusal(&command.output().expect("the program runs"));
    assert!(found.starts_with(&format!("error: {clear}: ffmpeg, which encodes videos, isn't installed; ")), "{found}");
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let command = command.args(["render", "sample:walker", "--size", "7x8", "--out", &clear]).args(WALKING);
    let found = refusal(&command.output().expect("the program runs"));
    assert_eq!(found, "error: --size: expected an even width and height for a video, found 7x8");
}
