//! Images decoded by the browser, in parallel with loading; KTX2 by a part.

use std::collections::VecDeque;

use gaitway_character::asset::{Asset, Image};
use gaitway_formats::Part;
use gaitway_scene::library::ImageData;
use js_sys::{Array, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use super::{OnImage, parts};
use crate::files::ImageLimits;
use crate::files::images::{fitted, is_ktx2, largest_edge, push_decoded, transcoded};
use crate::files::plain_image::is_opaque_and_untagged;
use crate::files::source::Reading;

/// Maximum number of KTX2 images transcoded in parallel: each worker has its own memory.
const MAX_WORKERS: usize = 4;

/// An image and its full size.
type Decoded = Result<(ImageData, [u32; 2]), String>;

/// An image being decoded, or why it cannot be. Dropping it is fine.
pub type Decoding = Result<Started, String>;

pub enum Started {
    Bitmap {
        bitmap: JsFuture,
        /// The size before scaling, if the image is scaled down.
        full_size: Option<[u32; 2]>,
    },
    /// Waits for the device, which decides the format.
    Ktx2,
}

pub fn start(images: &[Image], limits: &ImageLimits) -> Vec<Decoding> {
    let largest_edge = largest_edge(images, limits);
    images.iter().map(|image| start_one(image, largest_edge)).collect()
}

/// Returns one entry per image; `None` for one that cannot be decoded, for which a warning is added.
pub async fn finish(
    decoding: Vec<Decoding>,
    asset: &mut Asset,
    limits: &ImageLimits,
    on_image: Option<OnImage<'_>>,
) -> Vec<Option<ImageData>> {
    let mut transcoded = transcode(&asset.images, limits).await;
    let mut decoded = Vec::with_capacity(decoding.len());
    for started in decoding {
        let outcome = match started {
            Ok(Started::Bitmap { bitmap, full_size }) => finish_bitmap(bitmap, full_size).await,
            Ok(Started::Ktx2) => transcoded.pop_front().unwrap_or_else(|| Err("it was not decoded".to_owned())),
            Err(problem) => Err(problem),
        };
        if let (Ok((ImageData::Bitmap(bitmap), _)), Some(on_image)) = (&outcome, on_image) {
            let uses = [true, false].into_iter().filter(|&is_color| asset.uses_image(decoded.len(), is_color));
            uses.for_each(|is_color| on_image(bitmap, is_color));
        }
        push_decoded(asset, &mut decoded, outcome);
    }
    decoded
}

/// The loader has checked the size in the header: the browser itself sets no limit on memory.
fn start_one(image: &Image, largest_edge: u32) -> Decoding {
    if image.bytes.is_empty() {
        return Err("it has no data".to_owned());
    }
    if is_ktx2(image) {
        return Ok(Started::Ktx2);
    }
    let size = [image.width, image.height];
    let parts = Array::of1(&Uint8Array::from(&image.bytes[..]));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts).map_err(undecodable)?;
    let options = web_sys::ImageBitmapOptions::new();
    // These cost Chromium 2 ms for a megapixel even where they change nothing.
    if !is_opaque_and_untagged(&image.bytes) {
        options.set_premultiply_alpha(web_sys::PremultiplyAlpha::None);
        options.set_color_space_conversion(web_sys::ColorSpaceConversion::None);
    }
    let fitted = fitted(image.width, image.height, largest_edge);
    if let Some([width, height]) = fitted {
        options.set_resize_width(width);
        options.set_resize_height(height);
    }
    let window = web_sys::window().ok_or_else(|| "there is no window".to_owned())?;
    let bitmap = window.create_image_bitmap_with_blob_and_image_bitmap_options(&blob, &options).map_err(undecodable)?;
    Ok(Started::Bitmap { bitmap: JsFuture::from(bitmap), full_size: fitted.map(|_| size) })
}

async fn finish_bitmap(bitmap: JsFuture, full_size: Option<[u32; 2]>) -> Decoded {
    let bitmap = bitmap.await.and_then(|bitmap| bitmap.dyn_into()).map_err(undecodable)?;
    let data = ImageData::Bitmap(bitmap);
    // The browser applies EXIF rotation, so the header's size says nothing about whether the image was scaled.
    let full_size = full_size.unwrap_or_else(|| data.size().into());
    Ok((data, full_size))
}

/// Transcodes the KTX2 images, in their order.
async fn transcode(all: &[Image], limits: &ImageLimits) -> VecDeque<Decoded> {
    let images: Vec<&Image> = all.iter().filter(|image| is_ktx2(image)).collect();
    if images.is_empty() {
        return VecDeque::new();
    }
    let module = match parts::download(Part::Ktx2, &mut Reading::new(&|_, _, _| ())).await {
        Ok(module) => module,
        Err(problem) => {
            let problem = format!("it needs Gaitway's {}, which cannot be loaded: {problem}", Part::Ktx2.title());
            return images.iter().map(|_| Err(problem.clone())).collect();
        }
    };
    let formats = limits.formats().await;
    // Not before: until the device is known, this is a guess.
    let largest_edge = largest_edge(all, limits);
    let start = |image: &&Image| {
        let request = gaitway_ktx2::request(formats, largest_edge, &image.bytes);
        parts::start(Part::Ktx2, &module, &request)
    };
    let mut decoded = VecDeque::with_capacity(images.len());
    for images in images.chunks(MAX_WORKERS) {
        let running: Vec<_> = images.iter().map(start).collect();
        for (image, running) in images.iter().zip(running) {
            decoded.push_back(transcoded(image, parts::finish(Part::Ktx2, running).await));
        }
    }
    decoded
}

fn undecodable(_: JsValue) -> String {
    "the browser cannot decode it".to_owned()
}
