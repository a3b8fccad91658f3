//! Transcodes the images of `KHR_texture_basisu`, KTX2 files with ETC1S or UASTC texels, into what the device can sample. The
//! extension doesn't allow other texels, but files have them: those of 8 bits per channel are read, too.
//!
//! Output by input format and device:
//!
//! |  | BC7 | ETC2 | ASTC | neither |
//! | --- | --- | --- | --- | --- |
//! | ETC1S | BC7 | ETC2, without loss | ETC2 (every device has both) | RGBA |
//! | UASTC | BC7 | RGBA: ETC2 would blur normal maps | ASTC, without loss | RGBA |
//! | 8 bits per channel | RGBA | RGBA | RGBA | RGBA |
//!
//! An image with missing mip levels becomes RGBA as well, so that they can be generated from it, and so does one whose
//! edges aren't multiples of 4, which WebGPU doesn't accept in compressed formats.

mod container;
mod etc1s;
mod plain;
mod texture;
mod uastc;

use gaitway_part::{Answer, Output};

pub use container::{MAGIC, size};
pub use texture::{Format, Formats, Texture, request};

use container::{Codec, Container};

/// Transcodes an image ([`request`]). [`Texture::read`] reads the output.
///
/// # Errors
/// If the image is damaged, or of another kind.
pub fn decode(input: &[u8]) -> Answer {
    let (formats, largest_edge, file) = texture::read_request(input).ok_or("the decoder's input is damaged")?;
    let container = Container::read(file)?;
    let level = first_fitting_level(&container, largest_edge);
    let format = choose(&container, formats, level);
    let mut texture = match container.codec {
        Codec::Etc1s => etc1s::transcode(&container, format, level)?,
        Codec::Uastc => uastc::transcode(&container, format, level)?,
        Codec::Plain { channels } => plain::expand(&container, channels, level)?,
    };
    // Only RGBA gets here: compressed formats are chosen only if all mip levels are there.
    while texture.width.max(texture.height) > largest_edge.max(1) {
        texture.halve();
    }
    Ok(Output { bytes: texture.write(), warnings: Vec::new() })
}

/// Returns the format for an image whose first level is `level`.
fn choose(container: &Container, formats: Formats, level: usize) -> Format {
    let [width, height] = container.level_size(level);
    let has_all_levels = container.levels.len() - level == width.max(height).ilog2() as usize + 1;
    if !has_all_levels || width % 4 != 0 || height % 4 != 0 {
        return Format::Rgba8;
    }
    let has = |format| formats.contains(format);
    match container.codec {
        Codec::Plain { .. } => Format::Rgba8,
        _ if has(Formats::BC7) => Format::Bc7,
        Codec::Etc1s if has(Formats::ETC2) && container.has_alpha => Format::Etc2Rgba,
        Codec::Etc1s if has(Formats::ETC2) => Format::Etc2Rgb,
        Codec::Uastc if has(Formats::ASTC) => Format::Astc4x4,
        _ => Format::Rgba8,
    }
}

/// The first level whose edges are no longer than `largest_edge`, or the last one.
fn first_fitting_level(container: &Container, largest_edge: u32) -> usize {
    let fits = |&level: &usize| container.level_size(level).into_iter().all(|edge| edge <= largest_edge);
    let last = container.levels.len() - 1;
    (0..last).find(fits).unwrap_or(last)
}

#[cfg(test)]
#[path = "../../../tests/support/damage.rs"]
mod damage;

#[cfg(test)]
mod tests {
    use super::damage::{Damage, cases};
    use super::*;

    /// 64 × 32 pixels with seven levels, and 30 × 22 with one, encoded with npm's ktx2-encoder 0.6.0 (Basis Universal 2.0).
    const ETC1S: &[u8] = include_bytes!("../../../tests/support/ktx2/etc1s.ktx2");
    const ETC1S_ALPHA: &[u8] = include_bytes!("../../../tests/support/ktx2/etc1s-alpha.ktx2");
    const UASTC: &[u8] = include_bytes!("../../../tests/support/ktx2/uastc.ktx2");
    const UASTC_SINGLE: &[u8] = include_bytes!("../../../tests/support/ktx2/uastc-single.ktx2");

    const NONE: Formats = Formats(0);
    const ALL: Formats = Formats(7);

    fn decoded(file: &[u8], formats: Formats, largest_edge: u32) -> Texture {
        Texture::read(&decode(&request(formats, largest_edge, file)).unwrap().bytes).unwrap()
    }

    /// Texels of this format, in levels from the largest.
    fn plain(format: u32, size: [u32; 2], level_count: u32, scheme: u32, levels: &[&[u8]]) -> Vec<u8> {
        let descriptor = [28, 0, 2 | 24 << 16, 1];
        let index_end = (80 + 24 * levels.len()) as u32;
        let header = [format, 1, size[0], size[1], 0, 0, 1, level_count, scheme, index_end, 28, 0, 0, 0, 0, 0, 0];
        let mut start = index_end + 4 * descriptor.len() as u32;
        let index = levels.iter().flat_map(|level| {
            let (offset, length) = (start, level.len() as u32);
            start += length;
            [offset, 0, length, 0, length, 0]
        });
        let words: Vec<u32> = header.into_iter().chain(index).chain(descriptor).collect();
        let bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
        [&MAGIC[..], &bytes, &levels.concat()].concat()
    }

    #[test]
    fn plain_texels_become_rgba() {
        let texels: Vec<u8> = (1..=24).collect();
        let check = |format: u32, channels: usize, second: [u8; 4]| {
            let texture = decoded(&plain(format, [3, 2], 1, 0, &[&texels[..6 * channels]]), ALL, 4096);
            assert_eq!((texture.format, texture.width, texture.height, texture.levels), (Format::Rgba8, 3, 2, 1));
            assert_eq!((texture.data.len(), &texture.data[4..8]), (24, &second[..]), "format {format}");
        };
        check(9, 1, [2, 0, 0, 255]);
        check(22, 2, [3, 4, 0, 255]);
        check(23, 3, [4, 5, 6, 255]);
        check(43, 4, [5, 6, 7, 8]);
        // A frame of Zstandard with a single block, which isn't compressed.
        let frame = [&[0x28, 0xB5, 0x2F, 0xFD, 0x20, 18, 18 << 3 | 1, 0, 0], &texels[..18]].concat();
        let packed = decoded(&plain(23, [3, 2], 0, 2, &[&frame]), ALL, 4096);
        assert_eq!(packed, decoded(&plain(23, [3, 2], 1, 0, &[&texels[..18]]), ALL, 4096));
        let short = decode(&request(ALL, 4096, &plain(23, [3, 2], 1, 0, &[&texels[..17]])));
        assert_eq!(short.unwrap_err(), "mip level 0 is damaged");
        // The levels that fit: 2 × 2 and 1 × 1 of 4 × 4.
        let levels: [&[u8]; 3] = [&[1; 16], &[2, 3, 4, 5], &[6]];
        let texture = decoded(&plain(9, [4, 4], 3, 0, &levels), ALL, 2);
        assert_eq!((texture.width, texture.height, texture.levels), (2, 2, 2));
        let expected: Vec<u8> = (2..=6).flat_map(|red| [red, 0, 0, 255]).collect();
        assert_eq!(texture.data, expected);
    }

    /// As zip and PNG have it.
    fn crc32(bytes: &[u8]) -> u32 {
        let shift = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), shift))
    }

    /// Checksums of all levels as the reference transcoder gives them: `basis_transcoder.wasm` of three.js 0.187.
    #[test]
    fn every_format_equals_the_reference() {
        let cases = [
            (ETC1S, NONE, Format::Rgba8, 0x45d1_64bf),
            (ETC1S, ALL, Format::Bc7, 0x979c_b64f),
            (ETC1S, Formats::ETC2, Format::Etc2Rgb, 0x8d74_6350),
            (ETC1S, Formats::ASTC, Format::Rgba8, 0x45d1_64bf),
            (ETC1S_ALPHA, NONE, Format::Rgba8, 0xb696_a9a0),
            (ETC1S_ALPHA, Formats::BC7, Format::Bc7, 0x98ce_892a),
            (ETC1S_ALPHA, Formats(6), Format::Etc2Rgba, 0x5b2e_865b),
            (UASTC, NONE, Format::Rgba8, 0xf29d_8dc3),
            (UASTC, Formats::BC7, Format::Bc7, 0xc955_41f2),
            (UASTC, Formats(6), Format::Astc4x4, 0xefdd_8b7f),
            (UASTC, Formats::ETC2, Format::Rgba8, 0xf29d_8dc3),
            (UASTC_SINGLE, ALL, Format::Rgba8, 0x2bd3_ea3f),
        ];
        for (at, (file, formats, format, checksum)) in cases.into_iter().enumerate() {
            let texture = decoded(file, formats, 4096);
            let size = size(file).unwrap();
            assert_eq!((texture.format, [texture.width, texture.height]), (format, size), "case {at}");
            assert_eq!(texture.levels, if size == [30, 22] { 1 } else { 7 }, "case {at}");
            assert_eq!(crc32(&texture.data), checksum, "case {at}");
        }
    }

    #[test]
    fn larger_levels_than_wanted_are_left_out_or_halved() {
        for file in [ETC1S, ETC1S_ALPHA, UASTC] {
            let all = decoded(file, NONE, 64);
            let less = decoded(file, NONE, 20);
            assert_eq!((less.width, less.height, less.levels), (16, 8, 5));
            assert!(all.data.ends_with(&less.data));
            let one = decoded(file, NONE, 0);
            assert_eq!((one.width, one.height, one.levels), (1, 1, 1));
        }
        let all = decoded(UASTC_SINGLE, ALL, 30);
        let half = decoded(UASTC_SINGLE, ALL, 29);
        assert_eq!((half.width, half.height, half.levels, half.data.len()), (15, 11, 1, 15 * 11 * 4));
        let corners = [0, 4, 120, 124].map(|at| u32::from(all.data[at]));
        assert_eq!(u32::from(half.data[0]), (corners.iter().sum::<u32>() + 2) / 4);
    }

    #[test]
    fn other_kinds_of_images_are_errors() {
        let check = |at: usize, value: u32, expected: &str| {
            let mut file = UASTC.to_vec();
            file[at..at + 4].copy_from_slice(&value.to_le_bytes());
            let problem = decode(&request(ALL, 4096, &file)).unwrap_err();
            assert!(problem.contains(expected), "{expected}: {problem}");
        };
        check(0, 0, "not a KTX2 file");
        check(12, 97, "Vulkan's format 97; expected ETC1S, UASTC, or 8 bits");
        check(20, 65_535, "65535 × 32 pixels; expected 1 to 16384");
        check(24, 0, "64 × 0 pixels");
        check(28, 2, "not a single 2D image");
        check(32, 2, "not a single 2D image");
        check(36, 6, "not a single 2D image");
        check(40, 0, "0 mip levels");
        check(40, 8, "8 mip levels; expected 1 to 7");
        check(44, 1, "model 166, compressed with scheme 1");
        check(44, 3, "scheme 3");
        check(48, u32::MAX, "it ends after");
        check(80, 1 << 30, "it refers to");
        let problem = decode(&request(ALL, 4096, &UASTC[..100])).unwrap_err();
        assert!(problem.contains("it ends after 100 bytes"), "{problem}");
        // The first level that is not too large; its data is of a smaller one.
        check(20, 16_384, "mip level 2 is damaged");
    }

    /// Flipped bits, cut and overwritten files, the same on every run.
    #[test]
    fn damaged_files_never_panic() {
        let mut damage = Damage::new();
        let (mut decoded, mut failed) = (0, 0);
        let plain = plain(23, [3, 2], 1, 0, &[&[7; 18]]);
        for file in [ETC1S, ETC1S_ALPHA, UASTC, UASTC_SINGLE, &plain] {
            for case in 0..cases() {
                let damaged = damage.of(file);
                let input = request(if case % 2 == 0 { ALL } else { Formats(6) }, 64, &damaged);
                match decode(&input) {
                    Ok(_) => decoded += 1,
                    Err(_) => failed += 1,
                }
            }
        }
        assert!(decoded > 10, "only {decoded} were decoded: the damage hides what it should test");
        assert!(failed > 10, "only {failed} failed");
    }
}
