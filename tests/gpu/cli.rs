//! `gaitway render` as scripts use it.

use std::process::{Command, Output};

use gaitway::render::headless_device;

use crate::adapter::or_skipped;

fn render(arguments: &[&str]) -> Output {
    // Without this variable, Mesa reports an error that is none.
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let command = command.args(["render", "sample:walker", "--size", "8x8"]).args(arguments);
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
    // Of what is wrong, people hear nevertheless.
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
