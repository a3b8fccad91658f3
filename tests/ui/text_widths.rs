//! Widths of texts in the interface's font, which must match the original text shaper, which crates/harfrust replaces.

use egui::{Color32, Context, FontId, RawInput};

const SIZES: [f32; 6] = [10.5, 12.0, 13.0, 14.0, 17.0, 28.0];

/// Texts, their glyphs and their widths in points. Printed by this test's measurement with harfrust 0.12.0, vello_cpu
/// 0.2.0, egui 0.37.0 and all glyphs of Ubuntu Light, before the `[patch.crates-io]` section of Cargo.toml was written.
#[rustfmt::skip]
const TEXTS: [(&str, usize, [f32; 6]); 24] = [
    ("The quick brown fox jumps over the lazy dog. 0123456789", 55, [271.71875, 310.53125, 336.40625, 362.28125, 439.90625, 724.5625]),
    ("AVATAR To Wa LT Yo P. Ty 11 74 “A” L’T", 38, [177.09375, 202.40625, 219.28125, 236.125, 286.75, 472.28125]),
    ("mixamorig:LeftUpLeg_end.001", 27, [145.0, 165.71875, 179.53125, 193.34375, 234.78125, 386.6875]),
    ("AV", 2, [12.75, 14.59375, 15.78125, 17.0, 20.65625, 34.03125]),
    ("To", 2, [11.40625, 13.03125, 14.125, 15.21875, 18.46875, 30.40625]),
    ("office affluent fjord flag", 26, [112.53125, 128.59375, 139.3125, 150.03125, 182.1875, 300.0625]),
    ("ÄÖÜäöüß Çà éèêë ñõ Åøæ þð ÿ ¿¡ «»", 33, [166.9375, 190.78125, 206.6875, 222.5625, 270.28125, 445.15625]),
    ("Łódź Škoda Dvořák Żółć Őű Ğış Ļķ ĳ ŉ", 36, [171.40625, 195.875, 212.21875, 228.53125, 277.5, 457.0625]),
    ("Ταχίστη αλώπηξ ΆΈΉΊΌΎΏ ϊϋΐΰ ΑΥΤΑ", 32, [173.65625, 198.46875, 215.03125, 231.5625, 281.1875, 463.125]),
    ("Съешь же ещё этих мягких ГАТУ Тара Ђђ Її Ґґ Џ", 45, [222.9375, 254.78125, 276.03125, 297.25, 360.96875, 594.53125]),
    ("50 % · 1.25× ± 3° – 4 — … • ‘x’ “y” „z“ ‚q‛ ‹a› †‡", 50, [209.90625, 239.875, 259.875, 279.875, 339.84375, 559.71875]),
    ("m² cm³ µm ½ ¼ © ® ™ € £ ¥ § ¶ ¬ ∂ ∆ ∏ ∑ √ ∞ ∫ ≈ ≠ ≤ ≥ ◊", 55, [254.15625, 290.46875, 314.6875, 338.875, 411.5, 677.78125]),
    ("a\u{a0}b c\u{ad}d 1\u{2009}000 2\u{202f}000", 19, [81.75, 93.4375, 101.21875, 109.03125, 132.375, 218.03125]),
    ("a\tb", 3, [21.03125, 24.0625, 26.0625, 28.0625, 34.0625, 56.125]),
    ("left\nright, the longer line", 26, [95.5, 109.125, 118.25, 127.34375, 154.625, 254.65625]),
    ("← → ↑ ↓ ⇧ ⌘ ⌥ ⚠ ✔ ↺ ▶", 21, [81.6875, 93.375, 101.125, 108.90625, 132.25, 217.84375]),
    ("日本 ジョイント", 8, [39.15625, 44.75, 48.46875, 52.1875, 63.375, 104.375]),
    ("x\u{200d}y\u{200b}z\u{fe0f}w\u{feff}", 8, [23.125, 26.4375, 28.625, 30.84375, 37.4375, 61.6875]),
    ("‑a‐b‒c―d−e\u{2003}f\u{2002}g", 14, [86.03125, 98.3125, 106.5, 114.6875, 139.25, 229.375]),
    ("ỲẀẁŴŵ ŸỳÝ", 9, [61.15625, 69.875, 75.71875, 81.53125, 99.0, 163.0625]),
    ("a/b\\c|d{e}f[g](h)<i>=j+k*l^m~n`o#p@q&r!s?t\"u'v;w:x,y$z", 54, [261.78125, 299.1875, 324.09375, 349.03125, 423.8125, 698.0625]),
    ("ꜣ😀k", 3, [15.6875, 17.9375, 19.4375, 20.9375, 25.40625, 41.875]),
    ("   ", 3, [7.1875, 8.21875, 8.90625, 9.5625, 11.625, 19.15625]),
    ("", 0, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
];

#[test]
fn texts_are_as_wide_as_with_the_original_shaper() {
    let context = Context::default();
    gaitway::ui::install(&context);
    let mut output = context.run_ui(RawInput::default(), |ui| {
        for (text, glyph_count, widths) in TEXTS {
            let galleys = SIZES
                .map(|size| ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(size), Color32::WHITE));
            assert_eq!(galleys.each_ref().map(|galley| galley.intrinsic_size().x), widths, "{text:?}");
            let count = galleys[0].rows.iter().map(|row| row.glyphs.len()).sum::<usize>();
            assert_eq!(count, glyph_count, "{text:?}");
        }
    });
    output.textures_delta.clear();
}
