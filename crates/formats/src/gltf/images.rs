//! Images stay encoded; only their headers are read, so that absurd sizes are rejected before anything is decoded. An
//! unavailable image leaves its texture empty; the model still loads.

use gaitway_character::asset::{Image, SharedBytes, Warning, Warnings};
use gltf::json;
use imagesize::ImageType;

use super::accessor::Accessors;
use super::container::Container;
use super::data;
use crate::FileSet;
use crate::error::Problem;
use crate::limits::{Budget, Limit, MAX_IMAGE_SIDE};

pub const KTX2: &str = "image/ktx2";
pub const AVIF: &str = "image/avif";

pub fn images(
    files: &FileSet,
    file: &str,
    container: &Container,
    accessors: &Accessors,
    warnings: &mut Warnings,
) -> Result<Vec<Image>, Problem> {
    let mut images = Vec::with_capacity(accessors.document.root.images.len());
    for (index, image) in accessors.document.root.images.iter().enumerate() {
        let place = format!("images[{index}]");
        let bytes = match container.awaits_images {
            true => None,
            false => image_bytes(files, file, accessors, image, &place, warnings)
                .or_else(|problem| problem.leave_out("image", "the image is left out", warnings).map(|()| None))?,
        };
        let name = match (image.name.as_deref().unwrap_or_default(), &image.uri) {
            ("", Some(uri)) if !data::is_data_uri(uri) => data::decode_uri(uri).into_owned(),
            (name, _) => name.to_owned(),
        };
        // An image without bytes stays in the list, so that indices are those of the file.
        let missing = Image { name: name.clone(), ..Image::default() };
        images.push(match bytes {
            None => missing,
            Some(bytes) => match image_header(&bytes, &accessors.budget) {
                Ok((mime, width, height)) => Image { name, mime, bytes, width, height },
                Err(problem) => {
                    warnings.push(Warning::ImageUnreadable { image: place, problem });
                    missing
                }
            },
        });
    }
    Ok(images)
}

/// Returns an image's encoded bytes; `None` if it has none, which has been reported.
fn image_bytes(
    files: &FileSet,
    file: &str,
    accessors: &Accessors,
    image: &json::Image,
    place: &str,
    warnings: &mut Warnings,
) -> Result<Option<SharedBytes>, Problem> {
    Ok(match (&image.uri, image.buffer_view) {
        (Some(uri), _) if data::is_data_uri(uri) => Some(data::data_uri(place, uri)?.into()),
        (Some(uri), _) => {
            let found = data::file(files, file, uri, warnings);
            if found.is_none() {
                warnings.push(Warning::ImageMissing { uri: data::decode_uri(uri).into_owned() });
            }
            found
        }
        (None, Some(view)) => {
            let (bytes, _) = accessors.view(view.value(), &format!("{place}.bufferView"))?;
            accessors.budget.allocate(1, bytes.len(), &place)?;
            Some(bytes.to_vec().into())
        }
        (None, None) if accessors.document.is_left_out(place) => None,
        (None, None) => {
            let problem = "it has neither a URI nor a buffer view".to_owned();
            warnings.push(Warning::ImageUnreadable { image: place.to_owned(), problem });
            None
        }
    })
}

/// Returns the MIME type by content (what the file declares is often wrong), width and height.
pub fn image_header(bytes: &[u8], budget: &Budget) -> Result<(&'static str, u32, u32), String> {
    let (mime, [width, height]) = match imagesize::image_type(bytes) {
        Ok(ImageType::Png) => ("image/png", encoded_size(bytes)?),
        Ok(ImageType::Jpeg) => ("image/jpeg", encoded_size(bytes)?),
        Ok(ImageType::Webp) => ("image/webp", encoded_size(bytes)?),
        _ if bytes.starts_with(&gaitway_ktx2::MAGIC) => (KTX2, gaitway_ktx2::size(bytes)?.map(|edge| edge as usize)),
        _ if is_avif(bytes) => (AVIF, avif_size(bytes).ok_or("its size cannot be found")?),
        _ => return Err("it is not PNG, JPEG, WebP, AVIF or KTX2".to_owned()),
    };
    let pixels = width.saturating_mul(height);
    let max = MAX_IMAGE_SIDE as usize;
    if pixels == 0 || width.max(height) > max {
        return Err(format!("it has {width} × {height} pixels; expected 1 to {max} each way"));
    }
    budget.spend(Limit::ImagePixels, pixels, &"").map_err(|_| {
        let (max, name) = (Limit::ImagePixels.max(), Limit::ImagePixels.name());
        format!("with its {width} × {height} pixels, the model would have more than {max} {name} in all")
    })?;
    Ok((mime, width as u32, height as u32))
}

/// Whether the first box lists AVIF among the brands.
pub fn is_avif(bytes: &[u8]) -> bool {
    let length = bytes.first_chunk().map_or(0, |length| u32::from_be_bytes(*length) as usize);
    let brands = bytes.get(8..length.min(bytes.len())).filter(|_| bytes[4..].starts_with(b"ftyp"));
    brands.is_some_and(|brands| brands.as_chunks::<4>().0.iter().any(|brand| brand == b"avif" || brand == b"avis"))
}

/// The largest of the sizes before the pixels, which also include those of thumbnails, tiles and the alpha channel.
fn avif_size(bytes: &[u8]) -> Option<[usize; 2]> {
    let end = bytes.windows(4).position(|tag| tag == b"mdat").unwrap_or(bytes.len());
    let boxes = bytes[..end].windows(16).filter(|found| found.starts_with(b"ispe"));
    let edge = |bytes: &[u8]| bytes.iter().fold(0, |edge, &byte| edge << 8 | usize::from(byte));
    // After the tag, 4 bytes of version and flags.
    boxes.map(|found| [edge(&found[8..12]), edge(&found[12..])]).max_by_key(|size| size[0].saturating_mul(size[1]))
}

fn encoded_size(bytes: &[u8]) -> Result<[usize; 2], String> {
    imagesize::blob_size(bytes).map(|size| [size.width, size.height]).map_err(|problem| problem.to_string())
}
