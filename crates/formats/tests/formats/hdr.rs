//! Radiance's .hdr images: the three encodings of rows, and broken files.

use gaitway_formats::{HdrError, read_hdr};
use glam::Vec3;

use crate::data_folder::data_folder;

fn file(size: &str, rows: &[u8]) -> Vec<u8> {
    [b"#?RADIANCE\n# made by hand\nFORMAT=32-bit_rle_rgbe\n\n", size.as_bytes(), b"\n", rows].concat()
}

/// The mantissa 128 with this exponent is 1/2 · 2^(exponent − 128).
const ONE: [u8; 4] = [128, 64, 0, 129];

fn check(size: &str, rows: &[u8], expected: &[Vec3]) {
    let panorama = read_hdr(&file(size, rows)).unwrap();
    assert_eq!(panorama.pixels(), expected, "{size}");
}

#[test]
fn rows_are_plain_or_run_length_encoded() {
    let color = Vec3::new(1.0, 0.5, 0.0);
    check("-Y 1 +X 2", &[ONE, [0; 4]].concat(), &[color, Vec3::ZERO]);
    // The old encoding: repeat the previous pixel.
    check("-Y 2 +X 3", &[ONE, [1, 1, 1, 2], ONE, ONE, [2, 0, 0, 130]].concat(), &{
        let mut pixels = [color; 6];
        pixels[5] = Vec3::new(2.0 / 64.0, 0.0, 0.0);
        pixels
    });
    // By component: a run of 8, 8 single values, 3 and 5, a run.
    let rows = [
        &[2, 2, 0, 8][..],
        &[128 + 8, 128],
        &[8, 0, 1, 2, 3, 4, 5, 6, 64],
        &[128 + 3, 0, 128 + 5, 128],
        &[128 + 8, 129],
    ];
    let green = |index: u8| if index == 7 { 64 } else { index };
    let expected: Vec<Vec3> = (0..8)
        .map(|index| Vec3::new(1.0, f32::from(green(index)) / 128.0, if index < 3 { 0.0 } else { 1.0 }))
        .collect();
    check("-Y 1 +X 8", &rows.concat(), &expected);
}

#[test]
fn large_images_are_averaged_down() {
    let row = [ONE, [0; 4]].repeat(4096 / 2).concat();
    let panorama = read_hdr(&file("-Y 2 +X 4096", &row.repeat(2))).unwrap();
    // Each axis has its own factor.
    assert_eq!((panorama.width(), panorama.height()), (2048, 2));
    assert!(panorama.pixels().iter().all(|pixel| *pixel == Vec3::new(0.5, 0.25, 0.0)));
}

#[test]
fn broken_files_are_refused_with_a_reason() {
    let says = |bytes: &[u8], expected: &str| {
        let error: HdrError = read_hdr(bytes).unwrap_err();
        assert_eq!(error.to_string(), expected);
    };
    says(b"PNG", "header: expected #?RADIANCE, found the end of the file");
    says(
        b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n",
        "header: expected FORMAT=32-bit_rle_rgbe, found “FORMAT=32-bit_rle_xyze”",
    );
    says(b"#?RADIANCE\n", "header: expected an empty line after the header, found the end of the file");
    says(&file("+Y 1 +X 1", &ONE), "header: expected -Y HEIGHT +X WIDTH, found “+Y 1 +X 1”");
    says(&file("-Y 0 +X 99999", &[]), "expected an image of 1 to 16384 pixels in width and height, found 99999 × 0");
    says(&file("-Y 2 +X 1", &ONE), "row 2 of 2: the file ends here");
    says(&file("-Y 1 +X 2", &[ONE, [1, 1, 1, 2]].concat()), "row 1 of 1: a run is longer than the row");
    says(&file("-Y 1 +X 2", &[1, 1, 1, 2]), "row 1 of 1: a run without a pixel before it");
    says(&file("-Y 1 +X 8", &[2, 2, 0, 8, 128 + 9, 0]), "row 1 of 1: a run is longer than the row");
    says(&file("-Y 1 +X 8", &[2, 2, 0, 8, 0]), "row 1 of 1: a run of no pixels");
}

#[test]
fn a_real_environment() {
    let Some(folder) = data_folder() else { return };
    let bytes = std::fs::read(folder.join("materials/bevy/spiaggia_di_mondello_1k.hdr")).unwrap();
    let panorama = read_hdr(&bytes).unwrap();
    assert_eq!((panorama.width(), panorama.height()), (1024, 512));
    // Blue sky over yellow sand.
    let [sky, beach] = [Vec3::Y, Vec3::NEG_Y].map(|direction| panorama.radiance(direction));
    assert!(sky.z > 2.0 * sky.x && beach.x > beach.z, "{sky} {beach}");
    let brightest = panorama.pixels().iter().map(|pixel| pixel.max_element()).fold(0.0, f32::max);
    assert!((10.0..100_000.0).contains(&brightest), "{brightest}");
}
