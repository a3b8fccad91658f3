//! Radiance's RGBE images (.hdr): text lines up to an empty one, a line with the size, then rows of pixels with a
//! common exponent for red, green and blue. Rows are plain, run-length encoded with a marker pixel (the old way), or
//! component by component (the usual way). `EXPOSURE` is ignored, as in three.js and the Khronos viewer. Images in XYZ,
//! or with an orientation other than left to right from the top, are rare and rejected.

use gaitway_character::asset::Panorama;
use glam::Vec3;

/// Larger panoramas are averaged down by a whole factor while they are read.
const MAX_KEPT: [usize; 2] = [2048, 1024];
/// In pixels, for width and height.
const MAX_SIZE: usize = 16_384;

/// Why an .hdr file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HdrError {
    /// A line of the header is invalid.
    #[error("header: expected {expected}, found {found}")]
    Header {
        /// What the line should be.
        expected: &'static str,
        /// What it is, shortened.
        found: String,
    },
    /// The image is empty or too large.
    #[error("expected an image of 1 to {MAX_SIZE} pixels in width and height, found {width} × {height}")]
    Size {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// The file ends early, or a run is longer than its row.
    #[error("row {row} of {rows}: {problem}")]
    Row {
        /// Counting from 1.
        row: usize,
        /// Height in pixels.
        rows: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
}

/// Whether a file is an .hdr image, by its first bytes.
pub fn is_hdr(bytes: &[u8]) -> bool {
    bytes.starts_with(b"#?")
}

/// Reads an environment from an .hdr image.
pub fn read_hdr(bytes: &[u8]) -> Result<Panorama, HdrError> {
    let mut rest = bytes;
    if !is_hdr(bytes) {
        return Err(header("#?RADIANCE", line(&mut rest)));
    }
    loop {
        match line(&mut rest) {
            None => return Err(header("an empty line after the header", None)),
            Some([]) => break,
            Some(text) => match text.strip_prefix(b"FORMAT=") {
                None | Some(b"32-bit_rle_rgbe") => {}
                Some(_) => return Err(header("FORMAT=32-bit_rle_rgbe", Some(text))),
            },
        }
    }
    let size = line(&mut rest);
    let (width, height) = size.and_then(parse_size).ok_or_else(|| header("-Y HEIGHT +X WIDTH", size))?;
    // MAX_KEPT bounds the memory. This bounds the time, as runs let a small file claim a large image.
    if !(1..=MAX_SIZE).contains(&width) || !(1..=MAX_SIZE).contains(&height) {
        return Err(HdrError::Size { width, height });
    }
    read_rows(rest, width, height)
}

fn header(expected: &'static str, found: Option<&[u8]>) -> HdrError {
    let found = found.map_or("the end of the file".to_owned(), |text| {
        let text = String::from_utf8_lossy(&text[..text.len().min(40)]);
        format!("“{}”", text.escape_debug())
    });
    HdrError::Header { expected, found }
}

/// Reads a line, without its end; `None` at the end of the file.
fn line<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let end = rest.iter().position(|&byte| byte == b'\n')?;
    let text = &rest[..end];
    *rest = &rest[end + 1..];
    Some(text.strip_suffix(b"\r").unwrap_or(text))
}

fn parse_size(text: &[u8]) -> Option<(usize, usize)> {
    let words: Vec<&str> = str::from_utf8(text).ok()?.split_ascii_whitespace().collect();
    let ["-Y", height, "+X", width] = words[..] else { return None };
    Some((width.parse().ok()?, height.parse().ok()?))
}

fn read_rows(mut rest: &[u8], width: usize, height: usize) -> Result<Panorama, HdrError> {
    let (across, down) = (width.div_ceil(MAX_KEPT[0]), height.div_ceil(MAX_KEPT[1]));
    let (columns, rows) = (width / across, height / down);
    let mut row = vec![[0; 4]; width];
    let mut pixels = Vec::new();
    for index in 0..rows * down {
        let problem = |problem| HdrError::Row { row: index + 1, rows: height, problem };
        read_row(&mut rest, &mut row).map_err(problem)?;
        let start = index / down * columns;
        pixels.resize(start + columns, Vec3::ZERO);
        for (sum, pixels) in pixels[start..].iter_mut().zip(row.chunks_exact(across)) {
            *sum += pixels.iter().map(|&pixel| radiance(pixel)).sum::<Vec3>() / (across * down) as f32;
        }
    }
    Panorama::new(columns, rows, pixels).ok_or(HdrError::Size { width, height })
}

/// The largest number in half precision; brighter pixels are clamped to it.
const MAX_RADIANCE: f32 = 65_504.0;

fn radiance([red, green, blue, exponent]: [u8; 4]) -> Vec3 {
    if exponent == 0 {
        return Vec3::ZERO;
    }
    let scale = (i32::from(exponent) - 136) as f32;
    (Vec3::new(f32::from(red), f32::from(green), f32::from(blue)) * scale.exp2()).min(Vec3::splat(MAX_RADIANCE))
}

const ENDS: &str = "the file ends here";
const TOO_LONG: &str = "a run is longer than the row";

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Result<&'a [u8], &'static str> {
    let (taken, others) = rest.split_at_checked(count).ok_or(ENDS)?;
    *rest = others;
    Ok(taken)
}

fn read_row(rest: &mut &[u8], row: &mut [[u8; 4]]) -> Result<(), &'static str> {
    let is_by_component = matches!(rest, [2, 2, high, low, ..]
        if *high < 128 && usize::from(*high) << 8 | usize::from(*low) == row.len());
    if !is_by_component {
        return read_plain_row(rest, row);
    }
    take(rest, 4)?;
    for component in 0..4 {
        let mut column = 0;
        while column < row.len() {
            let [count] = take(rest, 1)? else { return Err(ENDS) };
            let (count, is_run) = if *count > 128 { (count - 128, true) } else { (*count, false) };
            let pixels = row.get_mut(column..column + usize::from(count)).ok_or(TOO_LONG)?;
            if count == 0 {
                return Err("a run of no pixels");
            }
            let values = take(rest, if is_run { 1 } else { pixels.len() })?;
            for (pixel, value) in pixels.iter_mut().zip(values.iter().cycle()) {
                pixel[component] = *value;
            }
            column += pixels.len();
        }
    }
    Ok(())
}

/// A marker pixel (1, 1, 1, n) repeats the pixel before it n times; the n of consecutive markers are base-256 digits of
/// a larger count.
fn read_plain_row(rest: &mut &[u8], row: &mut [[u8; 4]]) -> Result<(), &'static str> {
    let (mut column, mut shift) = (0, 0);
    while column < row.len() {
        match take(rest, 4)? {
            [1, 1, 1, count] => {
                let count = usize::from(*count).checked_shl(shift).filter(|_| shift <= 16).ok_or(TOO_LONG)?;
                let before = row[..column].last().copied().ok_or("a run without a pixel before it")?;
                row.get_mut(column..column + count).ok_or(TOO_LONG)?.fill(before);
                column += count;
                shift += 8;
            }
            pixel => {
                row[column].copy_from_slice(pixel);
                column += 1;
                shift = 0;
            }
        }
    }
    Ok(())
}
