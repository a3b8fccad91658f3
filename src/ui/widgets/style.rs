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

const DARK: Palette = Palette {
    panel: Color32::from_rgb(0x18, 0x1a, 0x1f),
    surface: Color32::from_rgb(0x23, 0x26, 0x2d),
    hover: Color32::from_rgb(0x2e, 0x32, 0x3b),
    pressed: Color32::from_rgb(0x3a, 0x3f, 0x4a),
    line: Color32::from_rgb(0x2c, 0x30, 0x38),
    text: Color32::from_rgb(0xe4, 0xe7, 0xec),
    weak_text: Color32::from_rgb(0x9a, 0xa2, 0xaf),
    accent: Color32::from_rgb(0x7d, 0x9b, 0xff),
    on_accent: Color32::from_rgb(0x10, 0x14, 0x20),
    chosen: Color32::from_rgb(0x2b, 0x34, 0x55),
    warning: Color32::from_rgb(0xf0, 0xb4, 0x5a),
    error: Color32::from_rgb(0xff, 0x86, 0x7c),
};

const LIGHT: Palette = Palette {
    panel: Color32::from_rgb(0xf7, 0xf8, 0xfa),
    surface: Color32::from_rgb(0xec, 0xee, 0xf2),
    hover: Color32::from_rgb(0xe1, 0xe5, 0xec),
    pressed: Color32::from_rgb(0xd3, 0xd9, 0xe3),
    line: Color32::from_rgb(0xdf, 0xe3, 0xe9),
    text: Color32::from_rgb(0x1d, 0x22, 0x2b),
    weak_text: Color32::from_rgb(0x5b, 0x65, 0x74),
    accent: Color32::from_rgb(0x3d, 0x5c, 0xe0),
    on_accent: Color32::WHITE,
    chosen: Color32::from_rgb(0xd9, 0xe1, 0xfc),
    warning: Color32::from_rgb(0x9a, 0x5b, 0x00),
    error: Color32::from_rgb(0xb4, 0x2a, 0x1f),
};

pub const CORNER: u8 = 7;

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

/// See assets/font/README.md. On the page the browser draws the letters that it lacks, with the system's fonts.
#[cfg(target_arch = "wasm32")]
const UBUNTU_LIGHT: &[u8] = include_bytes!("../../../assets/font/Ubuntu-Light-derivative-Gaitway-Latin.ttf");
#[cfg(not(target_arch = "wasm32"))]
const UBUNTU_LIGHT: &[u8] = include_bytes!("../../../assets/font/Ubuntu-Light-derivative-Gaitway.ttf");

/// One font for all text, with tabular digits for columns of numbers, and egui's icons.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let data: [(&str, &'static [u8]); 2] =
        [("Ubuntu-Light", UBUNTU_LIGHT), ("egui-icons", epaint_default_fonts::EGUI_ICONS)];
    for (name, bytes) in data {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
        for family in [FontFamily::Proportional, FontFamily::Monospace] {
            fonts.families.entry(family).or_default().push(name.to_owned());
        }
    }
    fonts
}

fn style(theme: Theme, palette: &Palette) -> Style {
    let mut style = theme.default_style();
    style.text_styles = [
        (TextStyle::Heading, FontId::new(17.0, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(14.0, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(14.0, FontFamily::Proportional)),
        (TextStyle::Small, FontId::new(12.0, FontFamily::Proportional)),
        (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
    ]
    .into();
    style.visuals = visuals(theme, palette);
    style.animation_time = 0.12;
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.4;

    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(8.0, 6.0);
    spacing.button_padding = Vec2::new(10.0, 5.0);
    spacing.interact_size = Vec2::new(28.0, 28.0);
    spacing.slider_rail_height = 4.0;
    spacing.icon_width = 18.0;
    spacing.icon_width_inner = 10.0;
    spacing.window_margin = Margin::same(16);
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
    visuals.window_corner_radius = CornerRadius::same(12);
    visuals.menu_corner_radius = CornerRadius::same(10);
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
