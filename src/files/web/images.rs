//! Images decoded by the browser, in parallel with loading.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use crate::asset::{Asset, Image};
use crate::files::images::{fitted, largest_edge, push_decoded};
use crate::library::ImageData;

/// An image being decoded, or why it cannot be. Dropping it is fine.
pub type Decoding = Result<Started, String>;

pub struct Started {
    bitmap: JsFuture,
    /// The size before scaling, if the image is scaled down.
    full_size: Option<[u32; 2]>,
}

pub fn start(images: &[Image]) -> Vec<Decoding> {
    let largest_edge = largest_edge(images);
    images.iter().map(|image| start_one(image, largest_edge)).collect()
}

/// Returns one entry per image; `None` for one that cannot be decoded, for which a warning is added.
pub async fn finish(decoding: Vec<Decoding>, asset: &mut Asset) -> Vec<Option<ImageData>> {
    let mut decoded = Vec::with_capacity(decoding.len());
    for started in decoding {
        let outcome = match started {
            Ok(started) => finish_one(started).await,
            Err(problem) => Err(problem),
        };
        push_decoded(asset, &mut decoded, outcome);
    }
    decoded
}

/// The loader has checked the size in the header: the browser would use any amount of memory.
fn start_one(image: &Image, largest_edge: u32) -> Decoding {
    if image.bytes.is_empty() {
        return Err("it has no data".to_owned());
    }
    let size = [image.width, image.height];
    let parts = Array::of1(&Uint8Array::from(&image.bytes[..]));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts).map_err(undecodable)?;
    let options = web_sys::ImageBitmapOptions::new();
    options.set_premultiply_alpha(web_sys::PremultiplyAlpha::None);
    options.set_color_space_conversion(web_sys::ColorSpaceConversion::None);
    let fitted = fitted(image.width, image.height, largest_edge);
    if let Some([width, height]) = fitted {
        options.set_resize_width(width);
        options.set_resize_height(height);
    }
    let window = web_sys::window().ok_or_else(|| "there is no window".to_owned())?;
    let bitmap = window.create_image_bitmap_with_blob_and_image_bitmap_options(&blob, &options).map_err(undecodable)?;
    Ok(Started { bitmap: JsFuture::from(bitmap), full_size: fitted.map(|_| size) })
}

async fn finish_one(started: Started) -> Result<(ImageData, [u32; 2]), String> {
    let bitmap = started.bitmap.await.and_then(|bitmap| bitmap.dyn_into()).map_err(undecodable)?;
    let data = ImageData::Bitmap(bitmap);
    // The browser applies EXIF rotation, so the header's size says nothing about whether the image was scaled.
    let full_size = started.full_size.unwrap_or_else(|| data.size().into());
    Ok((data, full_size))
}

fn undecodable(_: JsValue) -> String {
    "the browser cannot decode it".to_owned()
}
