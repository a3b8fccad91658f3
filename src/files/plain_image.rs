//! Finds images that a browser decodes to the same pixels whatever it is told about transparency and colour.

/// Whether an image surely has neither transparency nor a colour space of its own, going by what precedes its pixels.
pub(super) fn is_opaque_and_untagged(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xd8, segments @ ..] => is_untagged_jpeg(segments),
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', chunks @ ..] => is_opaque_and_untagged_png(chunks),
        // The simple lossy format.
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', b'V', b'P', b'8', b' ', ..] => true,
        _ => false,
    }
}

/// Each segment is 0xff, its marker and its length, which includes the two bytes of the length.
fn is_untagged_jpeg(mut segments: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    const EXIF: u8 = 0xe1;
    const ICC_PROFILE: u8 = 0xe2;
    while let [0xff, marker, high, low, ..] = *segments {
        match marker {
            START_OF_SCAN => return true,
            EXIF | ICC_PROFILE => return false,
            _ => segments = segments.get(2 + usize::from(u16::from_be_bytes([high, low]))..).unwrap_or_default(),
        }
    }
    false
}

/// Each chunk is the length of its data, its type, the data and a checksum.
fn is_opaque_and_untagged_png(mut chunks: &[u8]) -> bool {
    while let ([length, kind, ..], _) = chunks.as_chunks::<4>() {
        match kind {
            b"IDAT" => return true,
            // Gray, RGB or a palette; the color type follows width, height and bit depth.
            b"IHDR" if !matches!(chunks.get(17), Some(0 | 2 | 3)) => return false,
            b"IHDR" | b"PLTE" | b"bKGD" | b"iTXt" | b"pHYs" | b"sBIT" | b"tEXt" | b"tIME" | b"zTXt" => {}
            _ => return false,
        }
        let length = u32::from_be_bytes(*length) as usize;
        chunks = chunks.get(length.saturating_add(12)..).unwrap_or_default();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The start of a PNG with these chunks, whose checksums aren't read.
    fn png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        for (kind, data) in chunks {
            bytes.extend((data.len() as u32).to_be_bytes());
            bytes.extend([&kind[..], data, &[0; 4]].concat());
        }
        bytes
    }

    #[test]
    fn only_opaque_pngs_without_a_color_space_are_plain() {
        let header = |color_type| [0, 0, 0, 1, 0, 0, 0, 1, 8, color_type, 0, 0, 0];
        let [gray, rgb, palette, rgba] = [0, 2, 3, 6].map(header);
        let is_plain = |header, between: &[(&[u8; 4], &[u8])]| {
            let chunks = [&[(b"IHDR", &header as &[u8])], between, &[(b"IDAT", b"")]].concat();
            is_opaque_and_untagged(&png(&chunks))
        };
        assert!([gray, rgb, palette].into_iter().all(|header| is_plain(header, &[])));
        assert!(is_plain(rgb, &[(b"pHYs", &[0; 9]), (b"tEXt", b"Author\0someone")]));
        assert!(!is_plain(rgba, &[]));
        for kind in [b"tRNS", b"iCCP", b"sRGB", b"gAMA", b"cHRM", b"cICP", b"eXIf"] {
            assert!(!is_plain(rgb, &[(kind, &[1])]), "{kind:?}");
        }
        assert!(!is_opaque_and_untagged(&png(&[(b"IHDR", &rgb)])));
    }

    #[test]
    fn only_jpegs_without_exif_and_profile_are_plain() {
        let jfif = b"\xff\xe0\0\x04ab";
        let is_plain = |middle: &[u8]| is_opaque_and_untagged(&[b"\xff\xd8", &jfif[..], middle].concat());
        assert!(is_plain(b"\xff\xdb\0\x03q\xff\xda\0\x02"));
        assert!(!is_plain(b"\xff\xe1\0\x06Exif\xff\xda\0\x02"));
        assert!(!is_plain(b"\xff\xe2\0\x05ICC\xff\xda\0\x02"));
        assert!(!is_plain(b"\xff\xdb\xff\xff"));
        assert!(!is_plain(b"no marker"));
    }

    #[test]
    fn only_lossy_webp_without_extensions_is_plain() {
        assert!(is_opaque_and_untagged(b"RIFF\0\0\0\0WEBPVP8 \0"));
        assert!(!is_opaque_and_untagged(b"RIFF\0\0\0\0WEBPVP8L\0"));
        assert!(!is_opaque_and_untagged(b"RIFF\0\0\0\0WEBPVP8X\0"));
    }
}
