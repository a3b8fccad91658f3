//! Decoded images: RGBA with straight alpha and no colour conversion.

/// Pixels from the platform's decoder.
#[derive(Debug, Clone)]
pub enum ImageData {
    /// `4 · width · height` bytes in rows from the top.
    Rgba8 { width: u32, height: u32, pixels: Vec<u8> },
    /// The browser's bitmap, created with `premultiplyAlpha: "none"` and `colorSpaceConversion: "none"`.
    #[cfg(target_arch = "wasm32")]
    Bitmap(web_sys::ImageBitmap),
}

impl ImageData {
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Rgba8 { width, height, .. } => (*width, *height),
            #[cfg(target_arch = "wasm32")]
            Self::Bitmap(bitmap) => (bitmap.width(), bitmap.height()),
        }
    }
}
