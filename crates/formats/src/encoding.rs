//! Text in encodings other than UTF-8: old programs write names in the code page of their computer, and no file states which one.
//! A text file is converted to UTF-8 as a whole before it is parsed, since the second byte of a character may look like a brace or
//! a backslash.
//!
//! Natively, `encoding_rs` has the tables; on the page, the browser has. Both follow <https://encoding.spec.whatwg.org>.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use crate::lines::Lines;

/// Maximum size of a text to convert: the copy may take three times as much.
const MAX_BYTES: usize = 1 << 28;
/// Maximum size of the sample from which an encoding is guessed.
const MAX_SAMPLE: usize = 1 << 14;
/// Score of a character of [`DoubleByte::words`]; a common one scores 1.
const WORD_SCORE: i32 = 3;
/// Score of bytes that aren't a character of the encoding.
const ERROR_SCORE: i32 = -5;
/// Score of a single-byte letter between ASCII characters, where most accented letters are.
const LETTER_SCORE: i32 = 2;

/// The encoding of Western European text, in which every byte is a character.
const WESTERN: &str = "windows-1252";
/// Its letters beyond ASCII.
const WESTERN_LETTERS: RangeInclusive<u8> = 0xC0..=0xFF;
/// Letters beyond ASCII in MS-DOS's code page, in which old programs wrote names into zip archives.
const ZIP_LETTERS: RangeInclusive<u8> = 0x80..=0xA5;

/// An encoding with characters of two bytes.
struct DoubleByte {
    /// Its label for the browser's `TextDecoder`.
    label: &'static str,
    /// Bytes above 127 that are characters by themselves.
    single: RangeInclusive<u8>,
    /// First and second byte of common characters: the alphabet, and the more frequent half of the ideographs.
    common: &'static [(RangeInclusive<u8>, RangeInclusive<u8>)],
    /// Characters that occur in joint names: Chinese and Korean can't be told apart by their bytes.
    words: &'static str,
}

#[expect(clippy::reversed_empty_ranges, reason = "these encodings have no single bytes above 127")]
const NONE: RangeInclusive<u8> = 1..=0;

const DOUBLE_BYTE: [DoubleByte; 4] = [
    DoubleByte {
        label: "shift_jis",
        single: 0xA1..=0xDF,
        common: &[
            (0x82..=0x82, 0x9F..=0xF1),
            (0x83..=0x83, 0x40..=0x96),
            (0x81..=0x81, 0x5B..=0x5B),
            (0x88..=0x97, 0x40..=0xFC),
        ],
        words: "左右上下半身首頭目両足腕手肩指親人差中薬小捩ひじざつま先センターグルーブ操作心腰髪スカト胸口舌歯体骨前後全",
    },
    DoubleByte {
        label: "gbk",
        single: NONE,
        common: &[(0xB0..=0xD7, 0xA1..=0xFE)],
        words: "左右头颈脖脊椎骨盆臀大腿小膝盖脚踝趾手臂肩膀肘腕指拇食中无名根胸腰腹上下前后身体目眼嘴发裙锁尾节",
    },
    DoubleByte {
        label: "big5",
        single: NONE,
        common: &[(0xA4..=0xC6, 0x40..=0x7E), (0xA4..=0xC6, 0xA1..=0xFE)],
        words: "左右頭頸脖脊椎骨盆臀大腿小膝蓋腳踝趾手臂肩膀肘腕指拇食中無名根胸腰腹上下前後身體目眼嘴髮裙鎖尾節",
    },
    DoubleByte {
        label: "euc-kr",
        single: NONE,
        common: &[(0xB0..=0xC8, 0xA1..=0xFE)],
        words: "왼오른쪽좌우머리목가슴허골반팔다손발어깨무릎꿈치척추엉덩이락엄지검중약새끼눈턱위아래상하체뼈쇄관절앞뒤",
    },
];

/// Converts a text file to UTF-8. Text in an unknown encoding is returned unchanged.
pub fn utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    if let Some(text) = utf16(bytes) {
        return text.into_bytes().into();
    }
    if bytes.len() > MAX_BYTES || str::from_utf8(bytes).is_ok() {
        return bytes.into();
    }
    let mut sample = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((_, line)) = lines.next_full_line()
        && sample.len() < MAX_SAMPLE
    {
        if !line.is_ascii() {
            sample.extend_from_slice(&line[..line.len().min(MAX_SAMPLE)]);
            sample.push(b'\n');
        }
    }
    // UTF-8 with a damaged character.
    if is_mostly_utf8(&sample) {
        return bytes.into();
    }
    decode(guess(&sample, &WESTERN_LETTERS).unwrap_or(WESTERN), bytes)
        .map_or(bytes.into(), |text| text.into_bytes().into())
}

/// Decodes the names in a zip archive. `None` unless they are in an encoding with characters of two bytes.
pub fn double_byte_names(names: &[&[u8]]) -> Option<Vec<String>> {
    let sample = names.join(&b'\n');
    if is_mostly_utf8(&sample) {
        return None;
    }
    let label = guess(&sample, &ZIP_LETTERS)?;
    names.iter().map(|name| decode(label, name)).collect()
}

/// Returns whether most of the bytes beyond ASCII are in lines that are UTF-8.
fn is_mostly_utf8(text: &[u8]) -> bool {
    let (mut as_utf8, mut others) = (0, 0);
    for line in text.split(|&byte| byte == b'\n') {
        // Two bytes of another encoding may be a character of UTF-8; three hardly ever are.
        match str::from_utf8(line) {
            Ok(line) => as_utf8 += line.chars().map(|character| character.len_utf8() - 1).sum::<usize>(),
            Err(_) => others += line.iter().filter(|byte| !byte.is_ascii()).count(),
        }
    }
    as_utf8 >= others
}

/// Returns whether a character stands for a byte, as in the encoding x-user-defined. Parts have no encoding tables and return text
/// in an unknown encoding that way.
pub fn is_byte(character: char) -> bool {
    matches!(character, '\u{F780}'..='\u{F7FF}')
}

/// Decodes the texts of a part that contain bytes ([`is_byte`]), and those whose bytes only happen to be UTF-8.
pub fn decode_bytes(texts: &mut [&mut String]) {
    let as_bytes = |text: &str| -> Vec<u8> {
        let mut bytes = Vec::with_capacity(text.len());
        for character in text.chars() {
            match character {
                _ if is_byte(character) => bytes.push(character as u8),
                _ => bytes.extend_from_slice(character.encode_utf8(&mut [0; 4]).as_bytes()),
            }
        }
        bytes
    };
    let texts: Vec<_> = texts.iter_mut().filter(|text| !text.is_ascii()).collect();
    let bytes: Vec<Vec<u8>> = texts.iter().map(|text| as_bytes(text)).collect();
    let label = guess(&bytes.join(&b'\n'), &WESTERN_LETTERS).unwrap_or(WESTERN);
    for (text, bytes) in texts.into_iter().zip(bytes) {
        if let Some(decoded) = decode(label, &bytes) {
            **text = decoded;
        }
    }
}

/// Decodes UTF-16 that has a byte-order mark or begins with two ASCII characters.
fn utf16(bytes: &[u8]) -> Option<String> {
    let word = match bytes {
        [0xFF, 0xFE, ..] | [1..=0x7F, 0, 1..=0x7F, 0, ..] => u16::from_le_bytes,
        [0xFE, 0xFF, ..] | [0, 1..=0x7F, 0, 1..=0x7F, ..] => u16::from_be_bytes,
        _ => return None,
    };
    let words = bytes.as_chunks().0.iter().map(|bytes| word(*bytes)).skip_while(|&word| word == 0xFEFF);
    Some(char::decode_utf16(words).map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
}

/// Returns the encoding with characters of two bytes in which a text makes the most sense. `None` if it makes as much sense in one
/// in which every byte is a character and words consist of `letters`.
fn guess(text: &[u8], letters: &RangeInclusive<u8>) -> Option<&'static str> {
    let text = &text[..text.len().min(MAX_SAMPLE)];
    let is_high = |byte: Option<&u8>| byte.is_some_and(|byte| !byte.is_ascii());
    let single = (0..text.len()).filter(|&at| is_high(text.get(at))).map(|at| {
        let is_alone = !is_high(text.get(at + 1)) && (at == 0 || !is_high(text.get(at - 1)));
        if is_alone && letters.contains(&text[at]) { LETTER_SCORE } else { -1 }
    });
    let mut best = (single.sum::<i32>().max(0), None);
    for encoding in &DOUBLE_BYTE {
        // Among equal scores, the first one wins.
        let score = encoding.score(text);
        if score > best.0 {
            best = (score, Some(encoding.label));
        }
    }
    best.1
}

impl DoubleByte {
    /// Scores how much sense a text makes in this encoding.
    fn score(&self, text: &[u8]) -> i32 {
        let decoded = decode(self.label, text).unwrap_or_default();
        let of_characters = decoded.chars().map(|character| match character {
            char::REPLACEMENT_CHARACTER => ERROR_SCORE,
            character if self.words.contains(character) => WORD_SCORE,
            _ => 0,
        });
        let (mut common, mut at) = (0, 0);
        while let Some(&first) = text.get(at) {
            at += 1;
            if first.is_ascii() || self.single.contains(&first) {
                continue;
            }
            let second = text.get(at).copied().unwrap_or_default();
            at += 1;
            let is_common =
                self.common.iter().any(|(firsts, seconds)| firsts.contains(&first) && seconds.contains(&second));
            common += if is_common { 1 } else { -1 };
        }
        common + of_characters.sum::<i32>()
    }
}

/// Decodes text; invalid bytes become the replacement character. `None` if the encoding is unknown.
#[cfg(not(target_arch = "wasm32"))]
fn decode(label: &str, bytes: &[u8]) -> Option<String> {
    let encoding = encoding_rs::Encoding::for_label(label.as_bytes())?;
    Some(encoding.decode_without_bom_handling(bytes).0.into_owned())
}

/// Decodes text; invalid bytes become the replacement character. `None` if the browser doesn't know the encoding.
#[cfg(target_arch = "wasm32")]
fn decode(label: &str, bytes: &[u8]) -> Option<String> {
    web_sys::TextDecoder::new_with_label(label).ok()?.decode_with_u8_array(bytes).ok()
}
