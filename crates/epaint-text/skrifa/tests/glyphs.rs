//! The interface's fonts as this crate reads them, against ttf-parser and against the rules of alignment.

use std::path::{Path, PathBuf};

use skrifa::instance::{Location, LocationRef, Size};
use skrifa::outline::{DrawSettings, HintingInstance, OutlinePen, Target};
use skrifa::{FontRef, GlyphId, MetadataProvider};

/// Segments of a path, each with its end last.
#[derive(Debug, Default, PartialEq)]
struct Segments(Vec<Vec<[f32; 2]>>);

impl OutlinePen for Segments {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.push(vec![[x, y]]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.push(vec![[x, y]]);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.0.push(vec![[cx, cy], [x, y]]);
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        self.0.push(vec![[cx0, cy0], [cx1, cy1], [x, y]]);
    }

    fn close(&mut self) {
        self.0.push(Vec::new());
    }
}

impl ttf_parser::OutlineBuilder for Segments {
    fn move_to(&mut self, x: f32, y: f32) {
        OutlinePen::move_to(self, x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        OutlinePen::line_to(self, x, y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        OutlinePen::quad_to(self, cx, cy, x, y);
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        OutlinePen::curve_to(self, cx0, cy0, cx1, cy1, x, y);
    }

    fn close(&mut self) {
        OutlinePen::close(self);
    }
}

fn fonts() -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new("../../../assets/font");
    let fonts = ["Ubuntu-Light-derivative-Gaitway.ttf", "Ubuntu-Light-derivative-Gaitway-Latin.ttf"];
    fonts.map(|name| folder.join(name)).map(|path| (path.clone(), std::fs::read(path).unwrap())).into()
}

fn unscaled(font: &FontRef<'_>, glyph: GlyphId) -> Segments {
    let mut path = Segments::default();
    let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
    font.outline_glyphs().get(glyph).unwrap().draw(settings, &mut path).unwrap();
    path
}

/// Returns the heights of a letter's points in pixels.
fn hinted(font: &FontRef<'_>, letter: char, pixels_per_em: f32) -> Vec<f32> {
    let glyphs = font.outline_glyphs();
    let location = Location;
    let size = Size::new(pixels_per_em);
    let hinting = HintingInstance::new(&glyphs, size, (&location).into(), Target::default()).unwrap();
    let mut path = Segments::default();
    let glyph = glyphs.get(font.charmap().map(letter).unwrap()).unwrap();
    glyph.draw(DrawSettings::hinted(&hinting, false), &mut path).unwrap();
    path.0.iter().filter_map(|segment| Some(segment.last()?[1])).collect()
}

#[test]
fn glyphs_are_those_that_ttf_parser_reads() {
    for (name, bytes) in fonts() {
        let font = FontRef::new(&bytes).unwrap();
        let face = ttf_parser::Face::parse(&bytes, 0).unwrap();
        let metrics = font.glyph_metrics(Size::unscaled(), LocationRef::default());
        let line = font.metrics(Size::unscaled(), LocationRef::default());
        assert_eq!(line.units_per_em, face.units_per_em());
        let expected = [face.ascender(), face.descender(), face.line_gap()].map(f32::from);
        assert_eq!([line.ascent, line.descent, line.leading], expected, "{name:?}");
        for number in 0..face.number_of_glyphs() {
            let mut expected = Segments::default();
            face.outline_glyph(ttf_parser::GlyphId(number), &mut expected);
            assert_eq!(unscaled(&font, GlyphId::from(number)), expected, "{name:?}, glyph {number}");
            let advance = face.glyph_hor_advance(ttf_parser::GlyphId(number)).map(f32::from);
            assert_eq!(metrics.advance_width(GlyphId::from(number)), advance, "{name:?}, glyph {number}");
        }
    }
}

#[test]
fn characters_have_the_glyphs_that_ttf_parser_finds() {
    for (name, bytes) in fonts() {
        let font = FontRef::new(&bytes).unwrap();
        let face = ttf_parser::Face::parse(&bytes, 0).unwrap();
        let charmap = font.charmap();
        for character in (0..0x1_0000).filter_map(char::from_u32) {
            let expected = face.glyph_index(character).map(|glyph| GlyphId::from(glyph.0));
            assert_eq!(charmap.map(character), expected, "{name:?}, {character:?}");
        }
        assert!(charmap.mappings().count() > 300);
        assert!(charmap.mappings().all(|(character, glyph)| charmap.map(character) == Some(glyph)));
    }
}

#[test]
fn letters_end_at_whole_rows() {
    let (_, bytes) = fonts().remove(0);
    let font = FontRef::new(&bytes).unwrap();
    for size in [10.5, 12.0, 14.0, 17.5, 21.0, 28.0] {
        for letter in "xzHIEFTLDlhkpq".chars() {
            let heights = hinted(&font, letter, size);
            let [bottom, top] = [heights.iter().copied().reduce(f32::min), heights.iter().copied().reduce(f32::max)]
                .map(|end| end.unwrap());
            for end in [bottom, top] {
                assert!((end - end.round()).abs() < 1e-4, "{letter} at {size}: from {bottom} to {top}");
            }
        }
    }
}
