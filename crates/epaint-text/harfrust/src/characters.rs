//! Prepares characters for shaping: composition, invisible characters, widths of spaces.

use crate::GlyphInfo;

/// Combining marks, the letters they go with, and what the two make (Unicode 17, canonical compositions of Latin-1, Latin
/// Extended-A, Romanian, Welsh, Greek and Cyrillic).
#[rustfmt::skip]
const COMPOSITIONS: [(char, &str, &str); 14] = [
    ('\u{300}', "AEIOUWYaeiouwyЕИеи", "ÀÈÌÒÙẀỲàèìòùẁỳЀЍѐѝ"),
    ('\u{301}', "ACEILNORSUWYZaceilnorsuwyz¨ΑΕΗΙΟΥΩαεηιουωϊϋГКгк", "ÁĆÉÍĹŃÓŔŚÚẂÝŹáćéíĺńóŕśúẃýź΅ΆΈΉΊΌΎΏάέήίόύώΐΰЃЌѓќ"),
    ('\u{302}', "ACEGHIJOSUWYaceghijosuwy", "ÂĈÊĜĤÎĴÔŜÛŴŶâĉêĝĥîĵôŝûŵŷ"),
    ('\u{303}', "AINOUainou", "ÃĨÑÕŨãĩñõũ"),
    ('\u{304}', "AEIOUaeiou", "ĀĒĪŌŪāēīōū"),
    ('\u{306}', "AEGIOUaegiouИУиу", "ĂĔĞĬŎŬăĕğĭŏŭЙЎйў"),
    ('\u{307}', "CEGIZcegz", "ĊĖĠİŻċėġż"),
    ('\u{308}', "AEIOUWYaeiouwyΙΥιυІЕеі", "ÄËÏÖÜẄŸäëïöüẅÿΪΫϊϋЇЁёї"),
    ('\u{30a}', "AUau", "ÅŮåů"),
    ('\u{30b}', "OUou", "ŐŰőű"),
    ('\u{30c}', "CDELNRSTZcdelnrstz", "ČĎĚĽŇŘŠŤŽčďěľňřšťž"),
    ('\u{326}', "STst", "ȘȚșț"),
    ('\u{327}', "CGKLNRSTcgklnrst", "ÇĢĶĻŅŖŞŢçģķļņŗşţ"),
    ('\u{328}', "AEIUaeiu", "ĄĘĮŲąęįų"),
];

/// Joins letters with the marks after them where the font has the result. It keeps the letter's place in the text.
pub fn compose(infos: &mut Vec<GlyphInfo>, has: impl Fn(char) -> bool) {
    infos.dedup_by(|mark, letter| {
        let composed = composition(letter.glyph_id, mark.glyph_id).filter(|composed| has(*composed));
        letter.glyph_id = composed.map_or(letter.glyph_id, u32::from);
        composed.is_some()
    });
}

fn composition(letter: u32, mark: u32) -> Option<char> {
    let (_, letters, composed) = COMPOSITIONS.iter().find(|row| u32::from(row.0) == mark)?;
    let index = letters.chars().position(|candidate| u32::from(candidate) == letter)?;
    composed.chars().nth(index)
}

/// Whether a character is `Default_Ignorable_Code_Point`: joiners, direction marks, variation selectors and the like. As in
/// HarfBuzz, Hangul fillers are not, since they have a width.
pub fn is_ignorable(character: u32) -> bool {
    matches!(
        character,
        0xad | 0x34f
            | 0x61c
            | 0x17b4..=0x17b5
            | 0x180b..=0x180e
            | 0x200b..=0x200f
            | 0x202a..=0x202e
            | 0x2060..=0x206f
            | 0xfe00..=0xfe0f
            | 0xfeff
            | 0xfff0..=0xfff8
            | 0x1d173..=0x1d17a
            | 0xe0000..=0xe0fff
    )
}

/// Returns the width in em of a space that a font may lack, as in HarfBuzz, except for the spaces as wide as a digit or
/// a full stop, for which the widths in most fonts are assumed.
pub fn space_width(character: u32) -> Option<f32> {
    Some(match character {
        0x2001 | 0x2003 | 0x3000 => 1.0,
        0x2000 | 0x2002 | 0x2007 => 1.0 / 2.0,
        0x2004 => 1.0 / 3.0,
        0x2005 | 0x2008 => 1.0 / 4.0,
        0x205f => 4.0 / 18.0,
        0x2009 | 0x202f => 1.0 / 5.0,
        0x2006 => 1.0 / 6.0,
        0x200a => 1.0 / 16.0,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_has_its_composition() {
        for (mark, letters, composed) in COMPOSITIONS {
            assert_eq!(letters.chars().count(), composed.chars().count(), "{mark:?}");
        }
    }
}
