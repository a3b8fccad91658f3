//! Prints how wide texts are with epaint's own crates; `tests/ui/text_widths.rs` compares them with those of the replacements.

#![forbid(unsafe_code)]

#[path = "../../texts.rs"]
mod texts;

use std::sync::Arc;

use egui::{Context, FontData, FontDefinitions, FontFamily};

const FONT: &[u8] = include_bytes!("../../../../assets/font/Ubuntu-Light-derivative-Gaitway.ttf");

fn main() {
    let mut fonts = FontDefinitions::empty();
    fonts.font_data.insert("font".to_owned(), Arc::new(FontData::from_static(FONT)));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec!["font".to_owned()]);
    }
    let context = Context::default();
    context.set_fonts(fonts);
    for line in texts::measured(&context) {
        println!("{line}");
    }
}
