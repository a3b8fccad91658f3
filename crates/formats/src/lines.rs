//! Splits text files into words and lines, with line numbers. [`encoding`](super::encoding) converted them to UTF-8 before, if it
//! recognized their encoding.

use std::borrow::Cow;

pub const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Maximum length in characters of an unexpected word quoted in a message.
const MAX_QUOTED: usize = 40;

/// The reading position. Lines end with LF, CR LF or CR; line numbers start at 1.
pub struct Lines<'a> {
    rest: &'a [u8],
    pub line: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes), line: 1 }
    }

    /// Reads the next word on this line or a later one. Braces are words of their own.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        while let Some((&byte, rest)) = self.rest.split_first() {
            if !is_space(byte) {
                let length = match byte {
                    b'{' | b'}' => 1,
                    _ => self.rest.iter().take_while(|&&byte| !is_space(byte) && byte != b'{' && byte != b'}').count(),
                };
                let (word, rest) = self.rest.split_at(length);
                self.rest = rest;
                return Some(word);
            }
            if byte == b'\n' || (byte == b'\r' && rest.first() != Some(&b'\n')) {
                self.line += 1;
            }
            self.rest = rest;
        }
        None
    }

    /// Returns the next word without consuming it.
    pub fn peek(&self) -> Option<&'a [u8]> {
        Self { rest: self.rest, line: self.line }.word()
    }

    /// Reads the rest of this line up to a brace, trimmed. Stays on the line.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let length = self.rest.iter().take_while(|byte| !matches!(byte, b'\n' | b'\r' | b'{' | b'}')).count();
        let (text, rest) = self.rest.split_at(length);
        self.rest = rest;
        text.trim_ascii()
    }

    /// Reads the next line that is not blank. Returns its number and its trimmed text.
    pub fn next_full_line(&mut self) -> Option<(usize, &'a [u8])> {
        loop {
            let length = self.rest.iter().take_while(|byte| !matches!(byte, b'\n' | b'\r')).count();
            let (text, rest) = self.rest.split_at(length);
            let line = self.line;
            let ending = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
            self.rest = &rest[ending..];
            if ending > 0 {
                self.line += 1;
            }
            let text = text.trim_ascii();
            if !text.is_empty() {
                return Some((line, text));
            }
            if self.rest.is_empty() {
                return None;
            }
        }
    }

    /// Cuts the text at the first byte that no text has: padding, or the end-of-file mark `^Z`. Returns whether there was one.
    pub fn end_at_padding(&mut self) -> bool {
        let end = self.rest.iter().position(|byte| matches!(byte, 0 | 0x1A));
        self.rest = &self.rest[..end.unwrap_or(self.rest.len())];
        end.is_some()
    }

    /// The current line, for messages.
    pub fn place(&self) -> String {
        format!("line {}", self.line)
    }

    /// The line of the next word, for messages.
    pub fn next_place(&self) -> String {
        let mut ahead = Self { rest: self.rest, line: self.line };
        ahead.word();
        ahead.place()
    }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0B
}

pub fn text(word: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(word)
}

/// Quotes a word for a message.
pub fn quoted(word: Option<&[u8]>) -> String {
    match word {
        None => "the end of the file".to_owned(),
        Some(word) => {
            let text = text(word);
            let cut: String = text.chars().take(MAX_QUOTED).collect();
            let dots = if cut.len() < text.len() { "…" } else { "" };
            format!("“{cut}{dots}”")
        }
    }
}

/// Parses a finite number.
pub fn number(word: &[u8]) -> Option<f64> {
    let number: f64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    number.is_finite().then_some(number)
}
