//! Texts and how wide they are, with the crates in this folder (`tests/ui/text_widths.rs`) and without (`original`).

use egui::{Color32, Context, FontId, RawInput};

const SIZES: [f32; 6] = [10.5, 12.0, 13.0, 14.0, 17.0, 28.0];

const TEXTS: [&str; 24] = [
    "The quick brown fox jumps over the lazy dog. 0123456789",
    "AVATAR To Wa LT Yo P. Ty 11 74 “A” L’T",
    "mixamorig:LeftUpLeg_end.001",
    "AV",
    "To",
    "office affluent fjord flag",
    "ÄÖÜäöüß Çà éèêë ñõ Åøæ þð ÿ ¿¡ «»",
    "Łódź Škoda Dvořák Żółć Őű Ğış Ļķ ĳ ŉ",
    "Ταχίστη αλώπηξ ΆΈΉΊΌΎΏ ϊϋΐΰ ΑΥΤΑ",
    "Съешь же ещё этих мягких ГАТУ Тара Ђђ Її Ґґ Џ",
    "50 % · 1.25× ± 3° – 4 — … • ‘x’ “y” „z“ ‚q‛ ‹a› †‡",
    "m² cm³ µm ½ ¼ © ® ™ € £ ¥ § ¶ ¬ ∂ ∆ ∏ ∑ √ ∞ ∫ ≈ ≠ ≤ ≥ ◊",
    "a\u{a0}b c\u{ad}d 1\u{2009}000 2\u{202f}000",
    "a\tb",
    "left\nright, the longer line",
    "← → ↑ ↓ ⇧ ⌘ ⌥ ⚠ ✔ ↺ ▶",
    "日本 ジョイント",
    "x\u{200d}y\u{200b}z\u{fe0f}w\u{feff}",
    "‑a‐b‒c―d−e\u{2003}f\u{2002}g",
    "ỲẀẁŴŵ ŸỳÝ",
    "a/b\\c|d{e}f[g](h)<i>=j+k*l^m~n`o#p@q&r!s?t\"u'v;w:x,y$z",
    "ꜣ😀k",
    "   ",
    "",
];

/// Returns a line for each text: its glyphs, and its widths in points.
pub fn measured(context: &Context) -> Vec<String> {
    let mut lines = Vec::new();
    let mut output = context.run_ui(RawInput::default(), |ui| {
        lines = TEXTS.map(|text| measure(ui, text)).into();
    });
    output.textures_delta.clear();
    lines
}

fn measure(ui: &egui::Ui, text: &str) -> String {
    let galleys =
        SIZES.map(|size| ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(size), Color32::WHITE));
    let glyphs = galleys[0].rows.iter().map(|row| row.glyphs.len()).sum::<usize>();
    let widths = galleys.each_ref().map(|galley| galley.intrinsic_size().x);
    format!("{text:?}: {glyphs} glyphs, {widths:?}")
}
