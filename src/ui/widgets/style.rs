//! The style of the panels: a palette for each system theme, and egui's style derived from it. The look of the scene is part
//! of the view state and doesn't depend on the theme.

use std::sync::Arc;

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Rect, Response, Shadow, Stroke,
    StrokeKind, Style, TextStyle, Theme, Ui, Vec2, Visuals,
};

/// The colours of a theme, named by their purpose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Palette {
    pub panel: Color32,
    /// Cards and fields on a panel.
    pub surface: Color32,
    pub hover: Color32,
    pub pressed: Color32,
    pub line: Color32,
    pub text: Color32,
    pub weak_text: Color32,
    pub accent: Color32,
    /// Text on `accent`.
    pub on_accent: Color32,
    /// Background of selected items, a tint of the accent.
    pub chosen: Color32,
    pub warning: Color32,
    pub error: Color32,
}

const LIGHT: Palette = theme(0);
const DARK: Palette = theme(1);

/// Radius of buttons, fields, rows and cards.
pub const CORNER: u8 = length("corner");
/// Radius of windows, menus and messages.
pub const WINDOW_CORNER: u8 = length("window-corner");
/// Between the edge of a window and its contents.
pub const WINDOW_MARGIN: i8 = length("window-margin") as i8;
/// Minimum size of controls for fingers. Not square: a narrow header has to hold six buttons, the name and the menu.
const FINGER_SIZE: Vec2 = Vec2::new(38.0, length("touch") as f32);
/// Minimum size of controls for a pointer.
const POINTER_SIZE: Vec2 = Vec2::splat(28.0);

/// The three sizes of text: titles, what controls and lists say, and notes, headings of groups and numbers.
pub const HEADING: FontId = FontId::proportional(length("heading") as f32);
pub const BODY: FontId = FontId::proportional(length("body") as f32);
pub const SMALL: FontId = FontId::proportional(length("small") as f32);

/// What the panels share with the page around the canvas. Read when this is compiled, which fails if a value is missing.
const THEME: &str = include_str!("../../../web/theme.css");

/// Returns [`THEME`] from a value on.
const fn value(name: &str) -> &'static str {
    let (theme, name) = (THEME.as_bytes(), name.as_bytes());
    let mut start = 2;
    // Past the end, an index fails.
    loop {
        let mut at = 0;
        while at < name.len() && theme[start + at] == name[at] {
            at += 1;
        }
        if at == name.len() && theme[start - 2] == b'-' && theme[start - 1] == b'-' && theme[start + at] == b':' {
            return THEME.split_at(start + at + 2).1;
        }
        start += 1;
    }
}

#[expect(clippy::panic, reason = "it fails when this is compiled, not when it runs")]
const fn number(text: &str, digits: usize, radix: u32) -> u32 {
    match u32::from_str_radix(text.split_at(digits).0, radix) {
        Ok(number) => number,
        Err(_) => panic!(),
    }
}

const fn length(name: &str) -> u8 {
    let text = value(name);
    number(text, if text.as_bytes()[1] == b'p' { 1 } else { 2 }, 10) as u8
}

/// A colour of one theme: the first or the second in `light-dark(#rrggbb, #rrggbb)`.
const fn color(name: &str, index: usize) -> Color32 {
    let [_, red, green, blue] = number(value(name).split_at(12 + 9 * index).1, 6, 16).to_be_bytes();
    Color32::from_rgb(red, green, blue)
}

const fn theme(index: usize) -> Palette {
    Palette {
        panel: color("panel", index),
        surface: color("surface", index),
        hover: color("hover", index),
        pressed: color("pressed", index),
        line: color("line", index),
        text: color("text", index),
        weak_text: color("weak-text", index),
        accent: color("accent", index),
        on_accent: color("on-accent", index),
        chosen: color("chosen", index),
        warning: color("warning", index),
        error: color("error", index),
    }
}

/// The palette of the current theme.
pub fn palette(ui: &egui::Ui) -> Palette {
    if ui.visuals().dark_mode { DARK } else { LIGHT }
}

/// Sets the fonts and both styles; egui follows the system theme.
pub fn install(context: &egui::Context) {
    context.set_fonts(fonts());
    context.set_theme(egui::ThemePreference::System);
    for (theme, palette) in [(Theme::Dark, DARK), (Theme::Light, LIGHT)] {
        context.set_style_of(theme, style(theme, &palette));
    }
}

/// Makes the controls of this `Ui`, and of all menus and windows, large enough for fingers or for a pointer.
pub fn size_controls(ui: &mut Ui, for_fingers: bool) {
    let size = if for_fingers { FINGER_SIZE } else { POINTER_SIZE };
    if ui.spacing().interact_size != size {
        ui.ctx().all_styles_mut(|style| style.spacing.interact_size = size);
        ui.spacing_mut().interact_size = size;
    }
}

/// Returns whether [`size_controls`] made the controls large enough for fingers.
pub fn is_for_fingers(ui: &Ui) -> bool {
    ui.spacing().interact_size.y >= FINGER_SIZE.y
}

/// Returns the size of a control: `size`, enlarged for fingers if need be.
pub fn press_size(ui: &Ui, size: Vec2) -> Vec2 {
    if is_for_fingers(ui) { size.max(FINGER_SIZE) } else { size }
}

/// The font of all text, TrueType; see assets/font/README.md. The browser draws the letters that it lacks, with the system's
/// fonts.
#[cfg(target_arch = "wasm32")]
pub const FONT: &[u8] = include_bytes!("../../../assets/font/Ubuntu-Light-derivative-Gaitway-Latin.ttf");
/// The font of all text, TrueType; see assets/font/README.md.
#[cfg(not(target_arch = "wasm32"))]
pub const FONT: &[u8] = include_bytes!("../../../assets/font/Ubuntu-Light-derivative-Gaitway.ttf");

/// One font for all text, with tabular digits for columns of numbers.
fn fonts() -> FontDefinitions {
    const NAME: &str = "Ubuntu-Light";
    let mut fonts = FontDefinitions::empty();
    fonts.font_data.insert(NAME.to_owned(), Arc::new(FontData::from_static(FONT)));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec![NAME.to_owned()]);
    }
    fonts
}

fn style(theme: Theme, palette: &Palette) -> Style {
    let mut style = theme.default_style();
    style.text_styles = [
        (TextStyle::Heading, HEADING),
        (TextStyle::Body, BODY),
        (TextStyle::Button, BODY),
        (TextStyle::Small, SMALL),
        (TextStyle::Monospace, SMALL),
    ]
    .into();
    style.visuals = visuals(theme, palette);
    style.animation_time = 0.12;
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.4;

    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(f32::from(const { length("gap") }), 6.0);
    spacing.button_padding = Vec2::new(f32::from(const { length("button-margin") }), 5.0);
    spacing.interact_size = POINTER_SIZE;
    spacing.slider_rail_height = 4.0;
    spacing.icon_width = 18.0;
    spacing.icon_width_inner = 10.0;
    spacing.window_margin = Margin::same(WINDOW_MARGIN);
    spacing.menu_margin = Margin::same(8);
    // A thin bar is there all the time: rows that end at an edge do not say that there are more.
    spacing.scroll = egui::style::ScrollStyle { dormant_handle_opacity: 0.5, ..egui::style::ScrollStyle::floating() };
    style
}

fn visuals(theme: Theme, palette: &Palette) -> Visuals {
    let mut visuals = theme.default_visuals();
    let corner = CornerRadius::same(CORNER);
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(WINDOW_CORNER);
    visuals.menu_corner_radius = CornerRadius::same(WINDOW_CORNER);
    visuals.window_shadow = Shadow {
        offset: [0, 8],
        blur: 28,
        spread: 0,
        color: Color32::from_black_alpha(if visuals.dark_mode { 120 } else { 50 }),
    };
    visuals.popup_shadow = Shadow {
        offset: [0, 4],
        blur: 14,
        spread: 0,
        color: Color32::from_black_alpha(if visuals.dark_mode { 100 } else { 36 }),
    };
    visuals.extreme_bg_color = palette.surface;
    visuals.text_edit_bg_color = Some(palette.surface);
    visuals.faint_bg_color = palette.surface;
    visuals.code_bg_color = palette.surface;
    visuals.weak_text_color = Some(palette.weak_text);
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.hyperlink_color = palette.accent;
    visuals.selection.bg_fill = palette.accent;
    visuals.selection.stroke = Stroke::new(1.0, palette.on_accent);
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    visuals.indent_has_left_vline = false;
    visuals.striped = false;

    let widgets = &mut visuals.widgets;
    for (widget, fill) in [
        (&mut widgets.noninteractive, palette.panel),
        (&mut widgets.inactive, palette.surface),
        (&mut widgets.hovered, palette.hover),
        (&mut widgets.active, palette.pressed),
        (&mut widgets.open, palette.hover),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, palette.text);
        widget.corner_radius = corner;
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    widgets.active.bg_stroke = Stroke::new(1.0, palette.accent);
    visuals
}

/// Returns the background of a button or row.
pub fn fill(palette: &Palette, response: &Response, is_chosen: bool) -> Color32 {
    if is_chosen {
        palette.chosen
    } else if response.hovered() {
        palette.hover
    } else {
        Color32::TRANSPARENT
    }
}

/// Draws a ring inside `rect` while the control has keyboard focus.
pub fn focus_ring(ui: &Ui, response: &Response, rect: Rect, corner: u8, width: f32) {
    if response.has_focus() {
        let stroke = Stroke::new(width, palette(ui).accent);
        ui.painter().rect_stroke(rect, corner, stroke, StrokeKind::Inside);
    }
}
