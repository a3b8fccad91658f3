//! Decoded images: how large they may be on the device that draws them, and what is reported about them. Decoding itself is
//! up to the platform.
//!
//! KTX2 images are transcoded when the others are decoded, since the device decides into what. The file stays as it is, so a
//! written model keeps them, and one that can't be decoded costs only its texture.

use gaitway_character::asset::{Asset, Image, Warning};
use gaitway_formats::limits::{MAX_IMAGE_BYTES, MAX_IMAGE_SIDE};
use gaitway_ktx2::Texture;
use gaitway_part::Answer;
use gaitway_scene::library::ImageData;

use super::ImageLimits;

/// Whether a model has images that have to be transcoded.
pub fn has_ktx2(asset: &Asset) -> bool {
    asset.images.iter().any(is_ktx2)
}

pub(super) fn is_ktx2(image: &Image) -> bool {
    image.bytes.starts_with(&gaitway_ktx2::MAGIC)
}

/// Reads the transcoder's answer about a KTX2 image. Returns it with its full size.
pub(super) fn transcoded(image: &Image, answer: Answer) -> Result<(ImageData, [u32; 2]), String> {
    let texture = Texture::read(&answer?.bytes).ok_or("the KTX2 decoder returned invalid data")?;
    Ok((ImageData::Ktx2(texture), [image.width, image.height]))
}

/// Returns the longest edge in pixels to which a model's images are scaled down: what the device can hold, halved until all of
/// them fit into memory.
pub(super) fn largest_edge(images: &[Image], limits: &ImageLimits) -> u32 {
    let mut edge = limits.longest_edge().min(MAX_IMAGE_SIDE);
    let size = |image: &Image, edge| fitted(image.width, image.height, edge).unwrap_or([image.width, image.height]);
    while edge > 1 && images.iter().map(|image| byte_count(size(image, edge))).sum::<u64>() > MAX_IMAGE_BYTES {
        edge /= 2;
    }
    edge
}

/// Returns the size to scale an image down to, or `None` if its edges are no longer than `largest`.
pub(super) fn fitted(width: u32, height: u32, largest: u32) -> Option<[u32; 2]> {
    let edge = width.max(height);
    let scaled = |length: u32| (u64::from(length) * u64::from(largest) / u64::from(edge.max(1))).max(1) as u32;
    (edge > largest).then(|| [scaled(width), scaled(height)])
}

/// Bytes of an RGBA8 image.
pub(super) fn byte_count([width, height]: [u32; 2]) -> u64 {
    4 * u64::from(width) * u64::from(height)
}

/// Appends the outcome for the asset's next image, which was `full_size` before it was scaled down, and warns about it. An
/// image without bytes was reported when the model was read.
pub(super) fn push_decoded(
    asset: &mut Asset,
    decoded: &mut Vec<Option<ImageData>>,
    outcome: Result<(ImageData, [u32; 2]), String>,
) {
    let index = decoded.len();
    if asset.images.get(index).is_some_and(|image| image.bytes.is_empty()) {
        decoded.push(None);
        return;
    }
    let name = asset.images.get(index).map(|image| image.name.clone()).filter(|name| !name.is_empty());
    let name = name.unwrap_or_else(|| index.to_string());
    match outcome {
        Ok((data, full_size)) => {
            let size: [u32; 2] = data.size().into();
            if full_size != size {
                asset.warnings.push(scaled_down(&name, full_size, size));
            }
            decoded.push(Some(data));
        }
        Err(problem) => {
            asset.warnings.push(Warning::ImageUnreadable { image: name, problem });
            decoded.push(None);
        }
    }
}

fn scaled_down(image: &str, [full_width, full_height]: [u32; 2], [width, height]: [u32; 2]) -> Warning {
    let problem = format!(
        "{full_width} × {full_height} pixels are more than this device can hold, or with the other images more than {} MiB; \
         scaled down to {width} × {height}",
        MAX_IMAGE_BYTES >> 20
    );
    Warning::Other { code: "image-made-smaller", place: image.to_owned(), problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_down_keeps_the_aspect() {
        assert_eq!(fitted(1000, 1000, 1000), None);
        assert_eq!(fitted(4000, 2000, 1000), Some([1000, 500]));
        assert_eq!(fitted(1, 5000, 1000), Some([1, 1000]));
    }

    /// Four images of 8192 × 8192 pixels would take a gigabyte.
    #[test]
    fn images_are_halved_until_all_fit() {
        let image = |side| Image { width: side, height: side, ..Image::default() };
        let limits = ImageLimits::default();
        assert_eq!(largest_edge(&[image(8192), image(8192)], &limits), MAX_IMAGE_SIDE);
        assert_eq!(largest_edge(&[8192; 4].map(image), &limits), 4096);
        assert_eq!(largest_edge(&[image(8192), image(8192), image(64)], &limits), 4096);
        assert_eq!(largest_edge(&[], &limits), MAX_IMAGE_SIDE);
    }

    #[test]
    fn images_are_no_larger_than_the_device_holds() {
        let limits = ImageLimits::default();
        limits.set(2048, gaitway_ktx2::Formats::default());
        let image = Image { width: 4096, height: 64, ..Image::default() };
        assert_eq!(largest_edge(&[image], &limits), 2048);
    }
}
