//! Decoded images: RGBA with straight alpha and no colour conversion.

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
    /// The browser's bitmap, created with `premultiplyAlpha: "none"` and `colorSpaceConversion: "none"`.
    #[cfg(target_arch = "wasm32")]
    Bitmap(web_sys::ImageBitmap),
}

impl ImageData {
    /// Returns width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Rgba8 { width, height, .. } => (*width, *height),
            #[cfg(target_arch = "wasm32")]
            Self::Bitmap(bitmap) => (bitmap.width(), bitmap.height()),
        }
    }
}
