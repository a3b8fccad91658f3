//! The tokens of a file, the same for text and binary.

use crate::container::{Contents, Encoding};
use crate::damaged;
use crate::document::short;

/// What a file consists of. Separators are left out.
#[derive(Clone, Copy)]
pub enum Token<'a> {
    Open,
    Close,
    /// A template's or an object's name.
    Word(&'a [u8]),
    /// In quotation marks.
    Quoted(&'a [u8]),
    Number(f64),
    /// Little-endian, 4 bytes each.
    Integers(&'a [u8]),
    /// Little-endian floats.
    Floats(&'a [u8]),
    Guid,
    Template,
    /// What occurs in declarations of templates only.
    Keyword,
    End,
}

impl Token<'_> {
    /// What messages call it.
    pub fn describe(&self) -> String {
        let quoted = |text: &[u8]| format!("\"{}\"", short(text));
        match self {
            Token::Open => "\"{\"".to_owned(),
            Token::Close => "\"}\"".to_owned(),
            Token::Word(text) | Token::Quoted(text) => quoted(text),
            Token::Number(_) | Token::Integers(_) | Token::Floats(_) => "numbers".to_owned(),
            Token::Guid => "a GUID".to_owned(),
            Token::Template | Token::Keyword => "a declaration".to_owned(),
            Token::End => "the end of the file".to_owned(),
        }
    }
}

/// Reads one token after the other.
pub struct Tokens<'a> {
    contents: &'a Contents<'a>,
    at: usize,
    /// Where the last token started.
    pub start: usize,
}

impl<'a> Tokens<'a> {
    pub fn new(contents: &'a Contents<'a>) -> Tokens<'a> {
        Tokens { contents, at: 0, start: 0 }
    }

    pub fn next(&mut self) -> Result<Token<'a>, String> {
        match self.contents.encoding {
            Encoding::Text => Ok(match self.word()? {
                Token::Word(word) if word.eq_ignore_ascii_case(b"template") => Token::Template,
                Token::Word(word) => number(word).map_or(Token::Word(word), Token::Number),
                token => token,
            }),
            Encoding::Binary { float } => self.binary(float),
        }
    }

    /// Like [`Self::next`] where a name is expected: one that looks like a number is a word.
    pub fn next_name(&mut self) -> Result<Token<'a>, String> {
        if self.contents.encoding == Encoding::Text { self.word() } else { self.next() }
    }

    /// Returns the size of a float in [`Token::Floats`].
    pub fn float_bytes(&self) -> usize {
        match self.contents.encoding {
            Encoding::Text => 0,
            Encoding::Binary { float } => float,
        }
    }

    /// Returns an error about the last token.
    pub fn unexpected(&self, expected: &str, found: &str) -> String {
        damaged(&self.contents.place(self.start), expected, found)
    }

    fn peek(&self) -> Option<u8> {
        self.contents.bytes.get(self.at).copied()
    }

    fn rest(&self) -> &'a [u8] {
        self.contents.bytes.get(self.at..).unwrap_or_default()
    }

    fn skip_line(&mut self) {
        self.at += self.rest().iter().take_while(|&&byte| byte != b'\n').count();
    }

    /// Reads a token of text; numbers as words.
    fn word(&mut self) -> Result<Token<'a>, String> {
        while let Some(byte) = self.peek() {
            match byte {
                0..=b' ' | b';' | b',' | b'[' | b']' | b'>' => self.at += 1,
                b'#' => self.skip_line(),
                b'/' if self.rest().starts_with(b"//") => self.skip_line(),
                _ => break,
            }
        }
        self.start = self.at;
        let until = |end: u8| self.rest().iter().skip(1).position(|&byte| byte == end);
        let (token, length) = match self.peek() {
            None => return Ok(Token::End),
            Some(b'{') => (Token::Open, 1),
            Some(b'}') => (Token::Close, 1),
            Some(b'<') => {
                let missing = || self.unexpected("a GUID that ends with \">\"", "no end");
                (Token::Guid, until(b'>').ok_or_else(missing)? + 2)
            }
            Some(b'"') => {
                let missing = || self.unexpected("a string that ends with a quotation mark", "no end");
                let length = until(b'"').ok_or_else(missing)?;
                (Token::Quoted(&self.rest()[1..=length]), length + 2)
            }
            Some(_) => {
                let ends =
                    |byte: &u8| matches!(byte, 0..=b' ' | b';' | b',' | b'{' | b'}' | b'"' | b'<' | b'>' | b'[' | b']');
                let rest = self.rest();
                let length = rest.iter().position(ends).unwrap_or(rest.len());
                (Token::Word(&rest[..length]), length)
            }
        };
        self.at += length;
        Ok(token)
    }

    fn binary(&mut self, float: usize) -> Result<Token<'a>, String> {
        loop {
            // A lone byte at the end pads the file.
            self.start = self.at;
            let Some(kind) = self.rest().first_chunk() else { return Ok(Token::End) };
            self.at += 2;
            return Ok(match u16::from_le_bytes(*kind) {
                1 => Token::Word(self.counted(1)?),
                2 => Token::Quoted(self.counted(1)?),
                3 => {
                    let bytes = self.take(4)?;
                    Token::Number(f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])))
                }
                5 => {
                    self.take(16)?;
                    Token::Guid
                }
                6 => Token::Integers(self.counted(4)?),
                7 => Token::Floats(self.counted(float)?),
                10 => Token::Open,
                11 => Token::Close,
                19 | 20 => continue,
                31 => Token::Template,
                12..=18 | 40..=52 => Token::Keyword,
                other => return Err(self.unexpected("a token", &format!("an unknown one, {other}"))),
            });
        }
    }

    /// Takes a count, then as many items of some bytes.
    fn counted(&mut self, size: usize) -> Result<&'a [u8], String> {
        let count = self.take(4)?;
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
        self.take(count.saturating_mul(size))
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], String> {
        let rest = self.rest();
        let missing = || self.unexpected(&format!("{length} bytes"), &format!("{}, then the end", rest.len()));
        let taken = rest.get(..length).ok_or_else(missing)?;
        self.at += length;
        Ok(taken)
    }
}

/// Reads a number; `None` if the word isn't one. What isn't finite in C's notation (`-1.#IND00`) is a number as well.
///
/// The standard library's conversion would be a third of the wasm module.
fn number(word: &[u8]) -> Option<f64> {
    let (sign, digits) = match word {
        [b'-', rest @ ..] => (-1.0, rest),
        [b'+', rest @ ..] => (1.0, rest),
        _ => (1.0, word),
    };
    if digits.starts_with(b"1.#") {
        return Some(f64::NAN);
    }
    let (mut mantissa, mut exponent, mut any) = (0_u64, 0_i32, false);
    let (mut behind_point, mut at) = (false, 0);
    while let Some(&byte) = digits.get(at) {
        match byte {
            b'0'..=b'9' => {
                any = true;
                // 18 digits are more than a double has.
                if mantissa < 100_000_000_000_000_000 {
                    mantissa = 10 * mantissa + u64::from(byte - b'0');
                    exponent -= i32::from(behind_point);
                } else {
                    exponent += i32::from(!behind_point);
                }
            }
            b'.' if !behind_point => behind_point = true,
            _ => break,
        }
        at += 1;
    }
    let power = match &digits[at..] {
        [] => 0,
        [b'e' | b'E', rest @ ..] => integer(rest)?,
        _ => return None,
    };
    any.then(|| sign * scaled(mantissa as f64, exponent.saturating_add(power)))
}

/// Reads an exponent.
fn integer(text: &[u8]) -> Option<i32> {
    let (sign, digits) = match text {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        _ => (1, text),
    };
    let valid = !digits.is_empty() && digits.iter().all(u8::is_ascii_digit);
    // Any larger one gives zero or infinity.
    valid.then(|| sign * digits.iter().fold(0, |value: i32, digit| (10 * value + i32::from(digit - b'0')).min(9999)))
}

/// Returns mantissa · 10^exponent.
fn scaled(mantissa: f64, exponent: i32) -> f64 {
    // Powers up to 10^22 are exact; further ones underflow or overflow after a few steps.
    let (mut value, mut left) = (mantissa, exponent.unsigned_abs().min(400));
    while left > 0 {
        let step = left.min(22);
        let power = (0..step).fold(1.0, |power: f64, _| power * 10.0);
        value = if exponent < 0 { value / power } else { value * power };
        left -= step;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_read_as_the_standard_library_does() {
        for text in [
            "0",
            "-1",
            "+2.5",
            "1.",
            ".5",
            "0.000001",
            "-0.1",
            "123456789012345678901234567890",
            "1e10",
            "-2.5E-3",
            "1e-300",
            "3.4028235e38",
            "1e999",
            "0.0000000000000000000000000000012345678901234567",
            "7e0",
        ] {
            let expected: f64 = text.parse().unwrap();
            let found = number(text.as_bytes()).unwrap();
            assert!(found == expected || (found / expected - 1.0).abs() < 4e-15, "{text}: {found}");
        }
        for text in ["", "-", ".", "e5", "1e", "1x", "Bip01", "01_hips", "1-2", "--1"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
        assert!(number(b"-1.#IND00").unwrap().is_nan());
    }
}
