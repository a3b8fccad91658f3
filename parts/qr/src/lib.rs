//! Makes QR codes for the page's share dialog, which is opened rarely.

use gaitway_part::{Answer, Output};
use qrcodegen::{QrCode, QrCodeEcc, QrSegment, Version};

/// Larger codes cannot be scanned off a screen.
const MAX_VERSION: u8 = 30;

/// Returns a text as a QR code: a line of `0` and `1` per row.
///
/// # Errors
/// If the text is not UTF-8, or too long to scan.
pub fn encode(text: &[u8]) -> Answer {
    let text = str::from_utf8(text).map_err(|_| "expected UTF-8")?;
    let segments = QrSegment::make_segments(text);
    let range = (Version::MIN, Version::new(MAX_VERSION));
    let code = QrCode::encode_segments_advanced(&segments, QrCodeEcc::Low, range.0, range.1, None, true)
        .map_err(|_| format!("{} characters, too many for a QR code that a camera can read", text.chars().count()))?;
    let row = |y| (0..code.size()).map(|x| if code.get_module(x, y) { '1' } else { '0' }).collect();
    let rows: Vec<String> = (0..code.size()).map(row).collect();
    Ok(Output { bytes: rows.join("\n").into_bytes(), warnings: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_square_and_have_their_finders() {
        let rows = String::from_utf8(encode(b"https://example.org").unwrap().bytes).unwrap();
        let rows: Vec<&str> = rows.lines().collect();
        assert!(rows.iter().all(|row| row.len() == rows.len()));
        for row in [rows[0], rows[6]] {
            assert!(row.starts_with("11111110") && row.ends_with("01111111"), "{row}");
        }
    }

    #[test]
    fn long_texts_are_refused() {
        assert!(encode(&[b'a'; 4000]).unwrap_err().contains("4000 characters"));
    }
}
