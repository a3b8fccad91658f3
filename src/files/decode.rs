//! Decodes images natively. Headers are not trusted: sizes and memory are bounded before anything is decoded.

use std::io::Cursor;

use image::{ImageReader, Limits};

use super::images::{MAX_BYTES, MAX_EDGE, byte_count, fitted, push_decoded};
use crate::asset::{Asset, Image};
use crate::library::ImageData;

/// Returns one entry per image of the asset; `None` for one that cannot be decoded, for which a warning is added.
pub fn decode_images(asset: &mut Asset) -> Vec<Option<ImageData>> {
    let mut bytes_left = MAX_BYTES;
    let mut decoded = Vec::with_capacity(asset.images.len());
    for index in 0..asset.images.len() {
        let outcome = decode(&asset.images[index], bytes_left);
        if let Ok((data, _)) = &outcome {
            bytes_left = bytes_left.saturating_sub(byte_count(data.size().into()));
        }
        push_decoded(asset, &mut decoded, outcome);
    }
    decoded
}

/// Returns the image and its size before it was scaled down to fit the device.
fn decode(image: &Image, max_bytes: u64) -> Result<(ImageData, [u32; 2]), String> {
    let mut reader = ImageReader::new(Cursor::new(&image.bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE);
    limits.max_image_height = Some(MAX_EDGE);
    limits.max_alloc = Some(max_bytes);
    reader.limits(limits);
    let pixels = reader.decode().map_err(|e| e.to_string())?.into_rgba8();
    let (width, height) = pixels.dimensions();
    let full_size = [width, height];
    if width == 0 || height == 0 || byte_count(full_size) > max_bytes {
        return Err(format!("{width} × {height} pixels"));
    }
    let pixels = match fitted(width, height) {
        Some([width, height]) => image::imageops::thumbnail(&pixels, width, height),
        None => pixels,
    };
    let (width, height) = pixels.dimensions();
    Ok((ImageData::Rgba8 { width, height, pixels: pixels.into_raw() }, full_size))
}
