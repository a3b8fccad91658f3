//! Decoded images: straight (not premultiplied) RGBA with no colour conversion.

/// Pixels as the platform's decoder gives them.
#[derive(Debug, Clone)]
pub enum ImageData {
    /// Row by row from the top, four bytes a pixel, `4 · width · height` in all.
    Rgba8 { width: u32, height: u32, pixels: Vec<u8> },
    /// The browser's own handle, made with `premultiplyAlpha: "none"` and `colorSpaceConversion: "none"`.
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
