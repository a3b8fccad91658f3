//! Decoded images: RGBA with straight alpha and no colour conversion.

use gaitway_ktx2::{Format, Texture};

/// Pixels from the platform's decoder.
#[derive(Debug, Clone)]
pub enum ImageData {
    /// `4 · width · height` bytes in rows from the top.
    Rgba8 {
        /// In pixels.
        width: u32,
        /// In pixels.
        height: u32,
        /// Red, green, blue and alpha bytes of each pixel.
        pixels: Vec<u8>,
    },
    /// A KTX2 image with its mip levels, in a format that the device supports.
    Ktx2(Texture),
    /// The browser's bitmap.
    #[cfg(target_arch = "wasm32")]
    Bitmap(web_sys::ImageBitmap),
}

/// What a model shows of its asset's images, one for each: none if it could not be decoded (a warning says why).
#[derive(Debug)]
pub enum Images {
    /// The file has not arrived completely: these stand in for its images until the complete model takes this one's place.
    Awaited(Vec<Option<ImageData>>),
    /// The file's images.
    Here(Vec<Option<ImageData>>),
}

impl Images {
    /// What surfaces are drawn with.
    pub fn shown(&self) -> &[Option<ImageData>] {
        match self {
            Self::Awaited(images) | Self::Here(images) => images,
        }
    }
}

impl From<Vec<Option<ImageData>>> for Images {
    fn from(images: Vec<Option<ImageData>>) -> Self {
        Self::Here(images)
    }
}

impl ImageData {
    /// Returns the GPU memory in bytes, including mip levels (a third more).
    pub fn device_bytes(&self) -> u64 {
        match self {
            Self::Ktx2(texture) if texture.format != Format::Rgba8 => texture.data.len() as u64,
            _ => {
                let (width, height) = self.size();
                u64::from(width) * u64::from(height) * 4 * 4 / 3
            }
        }
    }

    /// Returns width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Rgba8 { width, height, .. } => (*width, *height),
            Self::Ktx2(texture) => (texture.width, texture.height),
            #[cfg(target_arch = "wasm32")]
            Self::Bitmap(bitmap) => (bitmap.width(), bitmap.height()),
        }
    }
}
