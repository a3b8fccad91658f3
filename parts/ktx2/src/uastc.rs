//! UASTC: independent blocks of 16 bytes, sometimes compressed once more with Zstandard.

use basisu::uastc::astc_pack::transcode_uastc_to_astc;
use basisu::uastc::bc7::transcode_uastc_to_bc7;
use basisu::uastc::unpack::unpack_uastc;

use crate::container::Container;
use crate::texture::{Format, Texture};

const BLOCK: usize = 16;

pub fn transcode(container: &Container, format: Format, first: usize) -> Result<Texture, String> {
    let [width, height] = container.level_size(first);
    let mut texture = Texture { format, width, height, levels: 0, data: Vec::new() };
    for level in first..container.levels.len() {
        let damaged = || format!("mip level {level} is damaged");
        let size @ [width, _] = container.level_size(level);
        let [columns, rows] = container.level_blocks(level).map(|count| count as usize);
        let blocks = container.unpacked(level, columns * rows * BLOCK).ok_or_else(damaged)?;
        let blocks = blocks.as_chunks::<BLOCK>().0;
        let start = texture.data.len();
        texture.data.resize(start + format.byte_count(size), 0);
        let out = &mut texture.data[start..];
        match format {
            Format::Rgba8 => pixels(blocks, columns, 4 * width as usize, out),
            Format::Bc7 => convert(blocks, out, transcode_uastc_to_bc7),
            Format::Astc4x4 => convert(blocks, out, transcode_uastc_to_astc),
            Format::Etc2Rgb | Format::Etc2Rgba => None,
        }
        .ok_or_else(damaged)?;
        texture.levels += 1;
    }
    Ok(texture)
}

fn convert(blocks: &[[u8; BLOCK]], out: &mut [u8], block: fn(&[u8; BLOCK]) -> Option<[u8; BLOCK]>) -> Option<()> {
    let pairs = blocks.iter().zip(out.as_chunks_mut().0);
    pairs.into_iter().try_for_each(|(from, to)| block(from).map(|block| *to = block))
}

fn pixels(blocks: &[[u8; BLOCK]], columns: usize, row_bytes: usize, out: &mut [u8]) -> Option<()> {
    for (row, blocks) in out.chunks_mut(4 * row_bytes).zip(blocks.chunks(columns)) {
        for (column, block) in blocks.iter().enumerate() {
            let pixels = unpack_uastc(block, false)?;
            let lines = row.chunks_mut(row_bytes).zip(pixels.chunks(4));
            for (line, pixels) in lines {
                let line = line[16 * column..].chunks_exact_mut(4).zip(pixels);
                line.for_each(|(to, from)| to.copy_from_slice(&from.c));
            }
        }
    }
    Some(())
}
