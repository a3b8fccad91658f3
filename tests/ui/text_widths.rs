//! Widths of texts in the interface's font, which are the same with the crates in crates/epaint-text and with those that they replace.

use std::path::Path;
use std::process::Command;

use egui::Context;

#[path = "../../crates/epaint-text/texts.rs"]
mod texts;

#[test]
fn texts_are_as_wide_as_with_the_original_crates() {
    let context = Context::default();
    gaitway::ui::install(&context);
    let own = texts::measured(&context);
    let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/epaint-text/original/Cargo.toml");
    // A folder of its own: cargo may hold the lock of the other while tests run.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("original-text");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["run", "--quiet", "--locked", "--manifest-path"]).arg(original).arg("--target-dir").arg(target);
    let output = cargo.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(own, String::from_utf8(output.stdout).expect("UTF-8").lines().collect::<Vec<_>>());
}
