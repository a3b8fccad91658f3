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
