//! Glyphs, advances and kerning of the interface's font, in its units (1,000 per em).

use std::time::{Duration, Instant};

use harfrust::{BufferFlags, GlyphBuffer, ShapeOptions, ShaperData, UnicodeBuffer};
use skrifa::FontRef;

const FONT: &[u8] = include_bytes!("../../../../assets/font/Ubuntu-Light-derivative-Gaitway.ttf");

/// Read from the font's `GPOS` table with fontTools: what its lookups add up to. "Kï" and its like are listed one by one (format
/// 1), the others belong to classes (format 2).
const KERNING: [(&str, i32); 17] = [
    ("AV", -50),
    ("To", -44),
    ("LT", -102),
    ("P.", -78),
    ("r,", -44),
    ("L’", -105),
    ("Kï", 21),
    ("Tî", 21),
    ("fì", 30),
    ("nn", 0),
    ("11", 0),
    ("ΑΥ", -67),
    ("Τα", -34),
    ("Γϊ", -28),
    ("ГА", -52),
    ("Та", -34),
    ("Гї", 42),
];

fn shape(data: &ShaperData, font: &FontRef<'_>, mut buffer: UnicodeBuffer, text: &str) -> GlyphBuffer {
    let mut flags = BufferFlags::empty();
    flags |= BufferFlags::BEGINNING_OF_TEXT;
    buffer.set_flags(flags);
    buffer.push_str(text);
    buffer.guess_segment_properties();
    data.shaper(font).instance(None).build().shape(buffer, ShapeOptions::new())
}

/// Glyphs with the offsets of their text and their advances.
fn glyphs(text: &str) -> Vec<(u32, u32, i32)> {
    let font = FontRef::new(FONT).unwrap();
    let shaped = shape(&ShaperData::new(&font), &font, UnicodeBuffer::new(), text);
    assert!(shaped.glyph_positions().iter().all(|position| (position.x_offset, position.y_offset) == (0, 0)));
    let pairs = shaped.glyph_infos().iter().zip(shaped.glyph_positions());
    pairs.map(|(info, position)| (info.glyph_id, info.cluster, position.x_advance)).collect()
}

fn width(text: &str) -> i32 {
    glyphs(text).iter().map(|glyph| glyph.2).sum()
}

#[test]
fn pairs_are_kerned_in_every_script() {
    for (pair, kerning) in KERNING {
        let apart: i32 = pair.chars().map(|character| width(&character.to_string())).sum();
        assert_eq!(width(pair) - apart, kerning, "{pair}");
    }
}

#[test]
fn each_character_is_one_glyph_in_its_place() {
    let glyphs = glyphs("aжa");
    assert_eq!(glyphs.iter().map(|glyph| glyph.1).collect::<Vec<_>>(), [0, 1, 3]);
    assert_eq!(glyphs[0].0, glyphs[2].0);
    assert!(glyphs.iter().all(|glyph| glyph.0 != 0 && glyph.2 > 0));
    assert!(self::glyphs("").is_empty());
}

#[test]
fn missing_characters_are_glyph_zero() {
    assert_eq!(glyphs("日a")[0].0, 0);
}

#[test]
fn letters_and_accents_are_joined_where_the_font_has_the_result() {
    for (apart, joined) in [("e\u{301}", "é"), ("и\u{306}", "й"), ("ι\u{308}\u{301}", "ΐ"), ("s\u{326}", "ș")] {
        assert_eq!(glyphs(apart), glyphs(joined));
    }
    let clusters: Vec<u32> = glyphs("Cafe\u{301}.glb").iter().map(|glyph| glyph.1).collect();
    assert_eq!(clusters, [0, 1, 2, 3, 6, 7, 8, 9]);
    // No letter has both.
    assert_eq!(glyphs("q\u{301}").len(), 2);
    assert_eq!(glyphs("\u{301}").len(), 1);
}

#[test]
fn invisible_characters_have_no_width() {
    assert_eq!(width("x\u{ad}\u{200d}\u{fe0f}\u{feff}"), width("x"));
    assert!(glyphs("\u{200b}").iter().all(|glyph| glyph.0 != 0));
}

#[test]
fn buffers_are_reused() {
    let font = FontRef::new(FONT).unwrap();
    let data = ShaperData::new(&font);
    let shaped = shape(&data, &font, UnicodeBuffer::new(), "The first text");
    let (infos, positions) = (shaped.glyph_infos().as_ptr(), shaped.glyph_positions().as_ptr());
    let shaped = shape(&data, &font, shaped.clear(), "Another");
    assert_eq!(shaped.glyph_infos().len(), 7);
    assert_eq!((infos, positions), (shaped.glyph_infos().as_ptr(), shaped.glyph_positions().as_ptr()));
}

#[test]
fn the_time_grows_with_the_length_of_the_text() {
    let font = FontRef::new(FONT).unwrap();
    let data = ShaperData::new(&font);
    let time = |length: usize| {
        let text = "Ae\u{301}V To ".repeat(length);
        let once = || {
            let start = Instant::now();
            shape(&data, &font, UnicodeBuffer::new(), &text);
            start.elapsed()
        };
        (0..5).map(|_| once()).min().unwrap_or(Duration::MAX)
    };
    // 16 times if linear, 256 if quadratic.
    let (short, long) = (time(200), time(3200));
    assert!(long < short * 64, "{short:?} {long:?}");
}

#[test]
fn spaces_that_the_font_lacks_have_their_width() {
    assert_eq!(glyphs("\u{2003}"), [(glyphs(" ")[0].0, 0, 1000)]);
    assert_eq!(width("\u{2002}\u{2004}"), 500 + 333);
    assert_eq!(width("\u{a0}"), width(" "));
}
