//! Decodes images natively. Headers are not trusted: sizes and memory are bounded before anything is decoded.

use std::io::Cursor;

use gaitway_character::asset::{Asset, Image};
use gaitway_formats::Part;
use gaitway_formats::limits::MAX_IMAGE_SIDE;
use gaitway_scene::library::ImageData;
use image::{ImageReader, Limits};

use super::ImageLimits;
use super::images::{byte_count, fitted, is_ktx2, largest_edge, push_decoded, transcoded};

/// Memory a decoder may use besides the pixels.
const DECODER_BYTES: u64 = 64 << 20;
/// Memory for the pixels of an image as it is stored, before it is scaled down: 16,384 × 16,384 with 8 bits per channel. With 16,
/// half as many fit.
const MAX_STORED_BYTES: u64 = 1 << 30;

/// Returns one entry per image of the asset; `None` for one that cannot be decoded, for which a warning is added.
pub fn decode_images(asset: &mut Asset, limits: &ImageLimits) -> Vec<Option<ImageData>> {
    let largest_edge = largest_edge(&asset.images, limits);
    let mut decoded = Vec::with_capacity(asset.images.len());
    for index in 0..asset.images.len() {
        let outcome = decode(&asset.images[index], largest_edge, limits);
        push_decoded(asset, &mut decoded, outcome);
    }
    decoded
}

/// Returns the image, scaled down to `largest_edge`, and its size before that.
fn decode(image: &Image, largest_edge: u32, limits: &ImageLimits) -> Result<(ImageData, [u32; 2]), String> {
    if is_ktx2(image) {
        let request = gaitway_ktx2::request(limits.formats(), largest_edge, &image.bytes);
        return transcoded(image, Part::Ktx2.run(&request));
    }
    if image.mime == "image/avif" {
        let problem =
            "AVIF is decoded only by the page: open the model there, or convert the image to PNG, JPEG or WebP";
        return Err(problem.to_owned());
    }
    let mut reader =
        ImageReader::new(Cursor::new(&image.bytes[..])).with_guessed_format().map_err(|e| e.to_string())?;
    // The decoder parses the header itself.
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_IMAGE_SIDE);
    limits.max_image_height = Some(MAX_IMAGE_SIDE);
    let stored_bytes = (2 * byte_count([image.width, image.height])).min(MAX_STORED_BYTES);
    limits.max_alloc = Some(stored_bytes + DECODER_BYTES);
    reader.limits(limits);
    let pixels = reader.decode().map_err(|e| e.to_string())?;
    let full_size @ [width, height] = [pixels.width(), pixels.height()];
    if width == 0 || height == 0 {
        return Err(format!("{width} × {height} pixels"));
    }
    // Before it is converted, so that a large image isn't held twice.
    let pixels = match fitted(width, height, largest_edge) {
        Some([width, height]) => pixels.thumbnail_exact(width, height),
        None => pixels,
    };
    let pixels = pixels.into_rgba8();
    let (width, height) = pixels.dimensions();
    Ok((ImageData::Rgba8 { width, height, pixels: pixels.into_raw() }, full_size))
}
