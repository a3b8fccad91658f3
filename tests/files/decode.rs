//! Decoding a model's images: one that cannot be decoded gives a warning, never an error.

use gaitway::files::{ImageLimits, decode_images, encode_png};
use gaitway_character::asset::{Asset, AssetParts, Image};
use gaitway_ktx2::Format;
use gaitway_scene::library::ImageData;

fn png(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    encode_png(width, height, pixels).expect("the pixels match the size")
}

fn decode(bytes: Vec<u8>) -> (Option<ImageData>, Asset) {
    decode_as("image/png", bytes)
}

fn decode_as(mime: &'static str, bytes: Vec<u8>) -> (Option<ImageData>, Asset) {
    let image = Image { name: "skin".to_owned(), mime, bytes: bytes.into(), width: 2, height: 1 };
    let parts = AssetParts { images: vec![image], ..AssetParts::default() };
    let mut asset = Asset::new(parts).expect("indices in range");
    let mut images = decode_images(&mut asset, &ImageLimits::default());
    assert_eq!(images.len(), 1);
    (images.remove(0), asset)
}

/// One of `tests/support/ktx2`.
fn ktx2(name: &str) -> Vec<u8> {
    std::fs::read(format!("tests/support/ktx2/{name}.ktx2")).expect("a file of the repository")
}

/// The pixels that were encoded there.
fn gradients([width, height]: [u32; 2], has_alpha: bool) -> Vec<u8> {
    let pixel = |at: u32| {
        let (x, y) = (at % width, at / width);
        let blue = if ((x >> 4) + (y >> 4)) & 1 == 1 { 200 } else { 40 };
        let alpha = if has_alpha { 255 - 128 * x / (width - 1) } else { 255 };
        [255 * x / (width - 1), 255 * y / (height - 1), blue, alpha].map(|channel| channel as u8)
    };
    (0..width * height).flat_map(pixel).collect()
}

fn check_unreadable(bytes: Vec<u8>) {
    let (image, asset) = decode(bytes);
    assert!(image.is_none());
    let warnings: Vec<_> = asset.warnings.iter().map(|warning| (warning.code(), warning.place())).collect();
    assert_eq!(warnings, [("image-unreadable", "skin")]);
}

#[test]
fn undecodable_images_give_a_warning() {
    // The loader has reported an image that is not there.
    let (image, asset) = decode(Vec::new());
    assert!(image.is_none() && asset.warnings.is_empty());
    check_unreadable(b"not an image at all".to_vec());
    let mut cut = png(2, 1, &[255, 0, 0, 255, 0, 255, 0, 128]);
    cut.truncate(40);
    check_unreadable(cut);
}

#[test]
fn image_sizes_in_headers_are_not_trusted() {
    let mut huge = png(2, 1, &[0; 8]);
    // Width and height are at bytes 16 to 23 of a PNG.
    huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    check_unreadable(huge);
}

/// Two gigabytes of pixels with 16 bits per channel, of which the file has none. Where the header is sound, nothing but the limit keeps
/// them from being allocated.
#[test]
fn large_images_are_not_decoded_at_any_cost() {
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let mut crc = flate2::Crc::new();
        [kind, data].into_iter().for_each(|part: &[u8]| crc.update(part));
        [&(data.len() as u32).to_be_bytes()[..], kind, data, &crc.sum().to_be_bytes()].concat()
    };
    let side = 16_384_u32.to_be_bytes();
    let header = chunk(b"IHDR", &[&side[..], &side, &[16, 6, 0, 0, 0]].concat());
    let file = [b"\x89PNG\r\n\x1a\n", &header[..], &chunk(b"IDAT", &[0x78, 0x9c]), &chunk(b"IEND", &[])].concat();
    let image = Image { name: "skin".to_owned(), mime: "image/png", bytes: file.into(), width: 16_384, height: 16_384 };
    let mut asset = Asset::new(AssetParts { images: vec![image], ..AssetParts::default() }).expect("indices in range");
    assert!(decode_images(&mut asset, &ImageLimits::default())[0].is_none());
    let warnings: Vec<String> = asset.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings[0].to_lowercase().contains("memory limit") && warnings.len() == 1, "{warnings:?}");
}

#[test]
fn pixels_are_decoded_exactly() {
    let pixels = [255, 0, 0, 255, 10, 200, 30, 128];
    let (image, asset) = decode(png(2, 1, &pixels));
    assert!(asset.warnings.is_empty());
    let Some(ImageData::Rgba8 { width: 2, height: 1, pixels: found }) = image else { panic!("{image:?}") };
    assert_eq!(found, pixels);
}

/// Without a device, into RGBA. The images are gradients, which the two encodings keep to different degrees.
#[test]
fn ktx2_images_look_like_what_was_encoded() {
    for (name, size, max_difference) in [
        ("etc1s", [64, 32], 7.0),
        ("etc1s-alpha", [64, 32], 7.0),
        ("uastc", [64, 32], 1.5),
        ("uastc-single", [30, 22], 1.5),
    ] {
        let (image, _) = decode(ktx2(name));
        let Some(ImageData::Ktx2(texture)) = image else { panic!("{image:?}") };
        assert_eq!((texture.format, [texture.width, texture.height]), (Format::Rgba8, size), "{name}");
        let expected = gradients(size, name != "etc1s");
        let difference: u32 = texture.data.iter().zip(expected).map(|(&found, is)| u32::from(found.abs_diff(is))).sum();
        let mean = f64::from(difference) / f64::from(4 * size[0] * size[1]);
        assert!(mean < max_difference, "{name}: {mean} of 255");
    }
}

#[test]
fn damaged_ktx2_images_give_a_warning() {
    for name in ["etc1s", "uastc"] {
        let mut bytes = ktx2(name);
        bytes.truncate(bytes.len() - 20);
        check_unreadable(bytes);
    }
}

#[test]
fn avif_is_left_to_browsers() {
    let (image, asset) = decode_as("image/avif", include_bytes!("../support/gradients.avif").to_vec());
    assert!(image.is_none());
    let warnings: Vec<_> = asset.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings[0].contains("open the model there") && warnings.len() == 1, "{warnings:?}");
}
