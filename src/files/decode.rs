//! Images to pixels, natively. What a header says is not trusted: sizes and memory are bounded before anything is decoded.

use std::io::Cursor;

use image::{ImageReader, Limits};

use super::image_limit::{fitted, made_smaller};
use crate::asset::{Asset, Image, Warning};
use crate::library::ImageData;

const MOST_PIXELS_ACROSS: u32 = 16_384;
/// For one image while it is decoded, and for all decoded ones together.
const MOST_BYTES: u64 = 1 << 30;

/// One entry per image of the asset. What cannot be decoded is none, and a warning of the asset says why.
pub fn decode_images(asset: &mut Asset) -> Vec<Option<ImageData>> {
    let mut left = MOST_BYTES;
    let mut decoded = Vec::with_capacity(asset.images.len());
    let mut warnings = std::mem::take(&mut asset.warnings);
    for (index, image) in asset.images.iter().enumerate() {
        let name = if image.name.is_empty() { index.to_string() } else { image.name.clone() };
        match decode(image, left) {
            Ok((data, whole)) => {
                if whole != data.size() {
                    warnings.push(made_smaller(&name, whole.into(), data.size().into()));
                }
                let (width, height) = data.size();
                left = left.saturating_sub(4 * u64::from(width) * u64::from(height));
                decoded.push(Some(data));
            }
            Err(problem) => {
                warnings.push(Warning::ImageUnreadable { image: name, problem });
                decoded.push(None);
            }
        }
    }
    asset.warnings = warnings;
    decoded
}

/// The image, and how large it was before it was made to fit the device.
fn decode(image: &Image, most_bytes: u64) -> Result<(ImageData, (u32, u32)), String> {
    let mut reader = ImageReader::new(Cursor::new(&image.bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_PIXELS_ACROSS);
    limits.max_image_height = Some(MOST_PIXELS_ACROSS);
    limits.max_alloc = Some(most_bytes);
    reader.limits(limits);
    let pixels = reader.decode().map_err(|e| e.to_string())?.into_rgba8();
    let (width, height) = pixels.dimensions();
    if width == 0 || height == 0 || 4 * u64::from(width) * u64::from(height) > most_bytes {
        return Err(format!("{width} × {height} pixels"));
    }
    let whole = (width, height);
    let pixels = match fitted(width, height) {
        Some([width, height]) => image::imageops::thumbnail(&pixels, width, height),
        None => pixels,
    };
    let (width, height) = pixels.dimensions();
    Ok((ImageData::Rgba8 { width, height, pixels: pixels.into_raw() }, whole))
}
