//! Images stay encoded; only their headers are read, so that absurd sizes are rejected before anything is decoded. An
//! unavailable image leaves its texture empty; the model still loads.

use std::sync::Arc;

use gltf::json;
use imagesize::ImageType;

use super::accessor::Accessors;
use super::data;
use crate::asset::{Image, Warning, Warnings};
use crate::formats::FileSet;
use crate::formats::error::Problem;
use crate::formats::limits::{Budget, Limit, MAX_IMAGE_SIDE};

pub fn images(
    files: &FileSet,
    file: &str,
    accessors: &Accessors,
    warnings: &mut Warnings,
) -> Result<Vec<Image>, Problem> {
    let mut images = Vec::with_capacity(accessors.document.root.images.len());
    for (index, image) in accessors.document.root.images.iter().enumerate() {
        let place = format!("images[{index}]");
        let bytes = image_bytes(files, file, accessors, image, &place, warnings)
            .or_else(|problem| problem.leave_out("image", "the image is left out", warnings).map(|()| None))?;
        let name = match (image.name.as_deref().unwrap_or_default(), &image.uri) {
            ("", Some(uri)) if !data::is_data_uri(uri) => data::decode_uri(uri).into_owned(),
            (name, _) => name.to_owned(),
        };
        // An image without bytes stays in the list, so that indices are those of the file.
        let missing = Image { name: name.clone(), mime: "", bytes: Arc::from([]), width: 0, height: 0 };
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

/// Returns an image's encoded bytes; none if it has none, which was reported.
fn image_bytes(
    files: &FileSet,
    file: &str,
    accessors: &Accessors,
    image: &json::Image,
    place: &str,
    warnings: &mut Warnings,
) -> Result<Option<Arc<[u8]>>, Problem> {
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
            Some(bytes.into())
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
    let mime = match imagesize::image_type(bytes) {
        Ok(ImageType::Png) => "image/png",
        Ok(ImageType::Jpeg) => "image/jpeg",
        Ok(ImageType::Webp) => "image/webp",
        _ if bytes.starts_with(b"\xABKTX 20") => return Err("KTX2 textures are not supported".to_owned()),
        _ => return Err("it is not PNG, JPEG or WebP".to_owned()),
    };
    let size = imagesize::blob_size(bytes).map_err(|problem| problem.to_string())?;
    let (width, height) = (size.width, size.height);
    let pixels = width.saturating_mul(height);
    let max = MAX_IMAGE_SIDE as usize;
    if pixels == 0 || width.max(height) > max {
        return Err(format!("it has {width} × {height} pixels; expected 1 to {max} each way"));
    }
    budget.spend(Limit::ImagePixels, pixels, &"").map_err(|_| {
        let (max, name) = (Limit::ImagePixels.max(), Limit::ImagePixels.name());
        format!("with its {width} × {height} pixels, the model would have more than {max} {name} in all")
    })?;
    Ok((mime, size.width as u32, size.height as u32))
}
