//! Texels of 8 bits per channel, from red to alpha, row after row without gaps.

use crate::container::Container;
use crate::texture::{Format, Texture};

/// Expands texels to RGBA: as in Vulkan, colour channels that are missing are 0, and alpha is 1. `KTXswizzle` is ignored.
pub fn expand(container: &Container, channels: usize, first: usize) -> Result<Texture, String> {
    let [width, height] = container.level_size(first);
    let mut texture = Texture { format: Format::Rgba8, width, height, levels: 0, data: Vec::new() };
    for level in first..container.levels.len() {
        let [width, height] = container.level_size(level);
        let length = width as usize * height as usize * channels;
        let bytes = container.unpacked(level, length).ok_or_else(|| format!("mip level {level} is damaged"))?;
        texture.data.reserve(Format::Rgba8.byte_count([width, height]));
        for texel in bytes.chunks_exact(channels) {
            let mut rgba = [0, 0, 0, u8::MAX];
            rgba[..channels].copy_from_slice(texel);
            texture.data.extend(rgba);
        }
        texture.levels += 1;
    }
    Ok(texture)
}
