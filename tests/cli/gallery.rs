//! The gallery's pictures, which are drawn ahead (`cargo xtask pictures`): each still shows its scene.

use std::path::PathBuf;
use std::process::Command;

use gaitway_render::headless_device;
use image::RgbImage;
use image::imageops::{FilterType, resize};
use serde::Deserialize;

use crate::adapter::or_skipped;

/// One of assets/samples/gallery.json.
#[derive(Deserialize)]
struct Scene {
    name: String,
    model: String,
    motion: Option<String>,
    view: String,
}

fn scenes() -> Vec<Scene> {
    let text = std::fs::read_to_string("assets/samples/gallery.json").expect("the gallery's scenes");
    serde_json::from_str(&text).expect("scenes")
}

/// Pictures are compared this small, so that lossy compression and another adapter's edges make no difference.
const SIZE: [u32; 2] = [80, 60];
/// The largest mean difference of the channels, 0 to 255. Two scenes of the same model differ by several times as much.
const MAX_DIFFERENCE: f64 = 1.5;

fn small(picture: &RgbImage) -> RgbImage {
    resize(picture, SIZE[0], SIZE[1], FilterType::Triangle)
}

fn kept(name: &str) -> RgbImage {
    let path = format!("assets/gallery/{name}.webp");
    let picture = image::open(&path).unwrap_or_else(|error| panic!("{path}: {error}; run `cargo xtask pictures`"));
    small(&picture.into_rgb8())
}

fn drawn(scene: &Scene) -> RgbImage {
    let motion = scene.motion.as_ref().map(|motion| format!("&motion={motion}")).unwrap_or_default();
    let link = format!("v=2&model={}{motion}&{}", scene.model, scene.view);
    // Without this variable, Mesa reports a spurious error.
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let command = command.args(["render", &scene.model, "--view", &link, "--size", "640x480", "--out", "-"]);
    let output = command.env_remove("XDG_RUNTIME_DIR").output().expect("the program runs");
    assert!(output.status.success(), "{}: {}", scene.name, String::from_utf8_lossy(&output.stderr));
    small(&image::load_from_memory(&output.stdout).expect("a PNG").into_rgb8())
}

fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    let pairs = a.as_raw().iter().zip(b.as_raw());
    pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.as_raw().len() as f64
}

#[test]
fn each_picture_still_shows_its_scene() {
    if or_skipped(headless_device()).is_none() {
        return;
    }
    let scenes = scenes();
    let kept: Vec<RgbImage> = scenes.iter().map(|scene| kept(&scene.name)).collect();
    for (at, scene) in scenes.iter().enumerate() {
        let drawn = drawn(scene);
        let differences: Vec<f64> = kept.iter().map(|kept| difference(kept, &drawn)).collect();
        for (other, difference) in scenes.iter().zip(&differences) {
            let is_close = *difference < MAX_DIFFERENCE;
            let name = &other.name;
            assert_eq!(
                is_close,
                name == &scene.name,
                "{} and the picture of {name}: {difference:.2}; run `cargo xtask pictures`",
                scene.name
            );
        }
        println!("{}: {:.3}", scene.name, differences[at]);
    }
}

#[test]
fn there_is_no_picture_without_a_scene() {
    let mut names: Vec<PathBuf> = scenes().iter().map(|scene| format!("{}.webp", scene.name).into()).collect();
    names.push("preview.jpg".into());
    names.sort();
    let files = std::fs::read_dir("assets/gallery").expect("the pictures");
    let mut found: Vec<PathBuf> = files.map(|file| file.expect("a file").file_name().into()).collect();
    found.sort();
    assert_eq!(found, names);
}
