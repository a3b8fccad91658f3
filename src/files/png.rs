//! A PNG encoder for pictures: 8-bit RGBA with the "up" filter. Written here so that the page needs no image encoder.

use std::io::Write;

use flate2::{Compression, Crc, write::ZlibEncoder};

/// Encodes RGBA rows from the top with straight alpha. None unless `pixels` has `4 · width · height` bytes, at least
/// one pixel.
pub fn encode_png(width: u32, height: u32, pixels: &[u8]) -> Option<Vec<u8>> {
    let row_bytes = 4 * width as usize;
    if width == 0 || height == 0 || pixels.len() != row_bytes * height as usize {
        return None;
    }
    const FILTER_UP: u8 = 2;
    let mut rows = ZlibEncoder::new(Vec::new(), Compression::fast());
    let mut filtered = vec![0; row_bytes + 1];
    let mut above = vec![0; row_bytes];
    for row in pixels.chunks_exact(row_bytes) {
        filtered[0] = FILTER_UP;
        for ((out, &now), &before) in filtered[1..].iter_mut().zip(row).zip(&above) {
            *out = now.wrapping_sub(before);
        }
        rows.write_all(&filtered).ok()?;
        above.copy_from_slice(row);
    }
    let mut header = Vec::with_capacity(13);
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    // 8 bits, RGBA, the only defined compression and filter methods, no interlacing.
    header.extend([8, 6, 0, 0, 0]);
    let mut png = vec![0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];
    chunk(&mut png, b"IHDR", &header);
    chunk(&mut png, b"sRGB", &[0]);
    chunk(&mut png, b"IDAT", &rows.finish().ok()?);
    chunk(&mut png, b"IEND", &[]);
    Some(png)
}

fn chunk(png: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    png.extend((data.len() as u32).to_be_bytes());
    png.extend(kind);
    png.extend(data);
    let mut crc = Crc::new();
    crc.update(kind);
    crc.update(data);
    png.extend(crc.sum().to_be_bytes());
}

#[cfg(test)]
mod tests {
    use super::encode_png;

    #[test]
    fn wrong_sizes_are_rejected() {
        assert_eq!(encode_png(0, 1, &[]), None);
        assert_eq!(encode_png(2, 1, &[0; 4]), None);
    }

    #[cfg(not(target_arch = "wasm32"))]
    #[test]
    fn another_decoder_reads_the_same_pixels() {
        let pixels: Vec<u8> = (0..4 * 7 * 5).map(|index| (index * 37 % 251) as u8).collect();
        let png = encode_png(7, 5, &pixels).expect("seven by five");
        let decoded = image::load_from_memory(&png).expect("a PNG").to_rgba8();
        assert_eq!((decoded.width(), decoded.height()), (7, 5));
        assert_eq!(decoded.into_raw(), pixels);
    }
}
