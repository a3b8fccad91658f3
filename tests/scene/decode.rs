//! Decoding a model's images: one that cannot be decoded gives a warning, never an error.

use std::sync::Arc;

use gaitway::asset::{Asset, AssetParts, Image};
use gaitway::files::{decode_images, encode_png};
use gaitway::library::ImageData;

fn png(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    encode_png(width, height, pixels).expect("the pixels match the size")
}

fn decode(bytes: Vec<u8>) -> (Option<ImageData>, Asset) {
    let image = Image { name: "skin".to_owned(), mime: "image/png", bytes: Arc::from(bytes), width: 2, height: 1 };
    let parts = AssetParts { images: vec![image], ..AssetParts::default() };
    let mut asset = Asset::new(parts).expect("indices in range");
    let mut images = decode_images(&mut asset);
    assert_eq!(images.len(), 1);
    (images.remove(0), asset)
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

#[test]
fn pixels_are_decoded_exactly() {
    let pixels = [255, 0, 0, 255, 10, 200, 30, 128];
    let (image, asset) = decode(png(2, 1, &pixels));
    assert!(asset.warnings.is_empty());
    let Some(ImageData::Rgba8 { width: 2, height: 1, pixels: found }) = image else { panic!("{image:?}") };
    assert_eq!(found, pixels);
}
