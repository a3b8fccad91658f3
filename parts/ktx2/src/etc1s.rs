//! ETC1S with BasisLZ: the levels are indices into two codebooks, stored once per file.

use basisu::basislz::etc1s::Etc1sTranscoder;

use crate::container::Container;
use crate::texture::{Format, Texture};

/// Bytes of the global data before the images, and of each image: flags, then offset and length of its colours and of its alpha.
const HEADER: usize = 20;
const IMAGE: usize = 20;

pub fn transcode(container: &Container, format: Format, first: usize) -> Result<Texture, String> {
    let global = Global::read(container)?;
    let [width, height] = container.level_size(first);
    let mut texture = Texture { format, width, height, levels: 0, data: Vec::new() };
    for level in first..container.levels.len() {
        let start = texture.data.len();
        texture.data.resize(start + format.byte_count(container.level_size(level)), 0);
        let damaged = || format!("mip level {level} is damaged");
        global.transcode(container, format, level, &mut texture.data[start..]).ok_or_else(damaged)?;
        texture.levels += 1;
    }
    Ok(texture)
}

struct Global<'a> {
    transcoder: Etc1sTranscoder,
    images: &'a [[u8; IMAGE]],
}

impl<'a> Global<'a> {
    fn read(container: &Container<'a>) -> Result<Self, String> {
        let damaged = || "its codebooks are damaged".to_owned();
        let (header, mut rest) = container.global.split_first_chunk::<HEADER>().ok_or_else(damaged)?;
        let number = |at: usize| word(header, at);
        let mut take = |length: usize| rest.split_off(..length).ok_or_else(damaged);
        let images = take(container.levels.len() * IMAGE)?.as_chunks().0;
        let [endpoints, selectors, tables] = [take(number(4))?, take(number(8))?, take(number(12))?];
        let [endpoint_count, selector_count] = [number(0) as u32 & 0xFFFF, number(0) as u32 >> 16];
        let mut transcoder = Etc1sTranscoder::new();
        let is_read = transcoder.decode_palettes(endpoint_count, endpoints, selector_count, selectors)
            && transcoder.decode_tables(tables);
        is_read.then_some(Self { transcoder, images }).ok_or_else(damaged)
    }

    /// Fills `out`, which has the level's size. `None` if its data is damaged.
    fn transcode(&self, container: &Container, format: Format, level: usize, out: &mut [u8]) -> Option<()> {
        let image = self.images.get(level)?;
        let slice = |at: usize| container.levels[level].get(word(image, at)..)?.get(..word(image, at + 4));
        let color = slice(4)?;
        let alpha = if container.has_alpha { Some(slice(12)?) } else { None };
        let ([columns, rows], [width, height]) = (container.level_blocks(level), container.level_size(level));
        let transcoder = &self.transcoder;
        match (format, alpha) {
            (Format::Rgba8, None) => transcoder.transcode_slice_rgba32(color, columns, rows, width, height, None, out),
            (Format::Rgba8, Some(alpha)) => {
                transcoder.transcode_image_rgba32(color, alpha, columns, rows, width, height, None, out)
            }
            (Format::Bc7, None) => transcoder.transcode_slice_bc7(color, columns, rows, false, None, out),
            (Format::Bc7, Some(alpha)) => {
                transcoder.transcode_image_bc7_rgba(color, alpha, columns, rows, false, None, out)
            }
            (Format::Etc2Rgb, _) => transcoder.transcode_slice_etc1(color, columns, rows, None, out),
            (Format::Etc2Rgba, Some(alpha)) => {
                transcoder.transcode_image_etc2_rgba(color, alpha, columns, rows, None, out)
            }
            (Format::Etc2Rgba, None) | (Format::Astc4x4, _) => None,
        }
    }
}

fn word(bytes: &[u8; 20], at: usize) -> usize {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize
}
