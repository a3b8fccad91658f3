//! Sheets: the panels of small screens.

use egui::{Area, Id, Order, Rect, Stroke, Ui, pos2, vec2};

use crate::ui::icons::{ICON_SIZE, Icon, icon_button, icon_size};
use crate::ui::{Output, Sheet, Shown, UiState, clips, style, tabs, text};

/// A sheet at the side isn't narrower, nor much wider.
const SIDE_WIDTH: f32 = 280.0;

/// Of the viewport, a sheet at the bottom leaves at least this height.
const MIN_VIEWPORT_HEIGHT: f32 = 56.0;
/// The same when the user raises it: what the buttons in the viewport's corner take.
const MIN_HEIGHT_ABOVE_RAISED: f32 = 76.0;
/// Where there is less height below the header, a sheet takes all of it: beside a viewport and the transport, it would show nothing.
const MIN_HEIGHT_TO_SHARE: f32 = 300.0;
/// Sheets at least this wide have their close button beside the tabs, narrower ones above.
const MIN_WIDTH_BESIDE_TABS: f32 = 360.0;
/// Height of the handle that a sheet is dragged by.
const HANDLE_HEIGHT: f32 = 24.0;
/// Dragged down by this, a sheet closes.
const CLOSING_DISTANCE: f32 = 48.0;

/// The rectangle of a sheet at the right of what the header leaves free; `None` if half of that isn't wide enough.
pub fn side_rect(free: Rect) -> Option<Rect> {
    let has_room = free.width() > free.height() && free.width() >= 2.0 * SIDE_WIDTH;
    has_room.then(|| free.with_min_x(free.right() - (0.5 * free.width()).min(1.25 * SIDE_WIDTH)))
}

/// Whether a sheet takes all that the header leaves free, the transport's place included.
pub fn takes_all(free: Rect) -> bool {
    free.height() < MIN_HEIGHT_TO_SHARE
}

/// The rectangle of a sheet at the bottom of what the panels leave free, `raised` above its usual height as far as there is room.
pub fn bottom_rect(free: Rect, raised: &mut f32) -> Rect {
    let max_height = |rest: f32| (free.height() - rest).max(0.0);
    let usual_height = (free.height() * 0.66).max(240.0).min(max_height(MIN_VIEWPORT_HEIGHT));
    *raised = raised.min((max_height(MIN_HEIGHT_ABOVE_RAISED) - usual_height).max(0.0));
    free.with_min_y(free.bottom() - usual_height - *raised)
}

pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(sheet) = local.layout.sheet else { return };
    // A sheet opened in this pass has no rectangle yet.
    let Some(rect) = local.layout.sheet_rect else {
        ui.ctx().request_repaint();
        return;
    };
    let area = Area::new(Id::unique(("sheet", sheet as u8))).order(Order::Middle).fixed_pos(rect.min);
    // egui would move a new area to where its default size fits, and so take presses beside the sheet.
    area.constrain(false).show(ui.ctx(), |ui| {
        background(ui, rect);
        // The whole sheet takes the pointer, so that nothing under it moves.
        ui.allocate_rect(rect, egui::Sense::click_and_drag());
        let handle = Rect::from_min_size(rect.min, vec2(rect.width() - 48.0, HANDLE_HEIGHT));
        let handle = ui.interact(handle, ui.scope_id().with("handle"), egui::Sense::drag());
        let raised = &mut local.layout.sheet_raised;
        *raised -= handle.drag_delta().y;
        if handle.drag_stopped() {
            if *raised < -CLOSING_DISTANCE {
                local.layout.sheet = None;
            }
            *raised = raised.max(0.0);
        }
        let size = icon_size(ui, ICON_SIZE);
        let is_beside_tabs = matches!(sheet, Sheet::Inspector) && rect.width() >= MIN_WIDTH_BESIDE_TABS;
        let top = if is_beside_tabs { HANDLE_HEIGHT } else { 4.0 };
        let close = Rect::from_min_size(pos2(rect.right() - size.x - 8.0, rect.top() + top), size);
        let inner = Rect::from_min_max(rect.min + vec2(14.0, 16.0), rect.max - vec2(14.0, 4.0));
        let mut content = ui.new_child(egui::UiBuilder::new().max_rect(inner));
        content.set_clip_rect(inner.expand(4.0).intersect(content.clip_rect()));
        match sheet {
            Sheet::Clips => clips::show(&mut content, shown, local, out),
            Sheet::Inspector => {
                let tabs_top = if is_beside_tabs { close.top() } else { close.bottom() + 2.0 };
                content.add_space(tabs_top - inner.top());
                tabs::show(&mut content, shown, local, if is_beside_tabs { size.x } else { 0.0 }, out);
            }
        }
        let mut corner = ui.new_child(egui::UiBuilder::new().max_rect(close));
        if icon_button(&mut corner, Icon::Close, text::CLOSE_SHEET).clicked() {
            local.layout.sheet = None;
        }
    });
}

fn background(ui: &Ui, rect: Rect) {
    let palette = style::palette(ui);
    let corners = egui::CornerRadius { nw: style::WINDOW_CORNER, ne: style::WINDOW_CORNER, sw: 0, se: 0 };
    ui.painter().rect_filled(rect, corners, palette.panel);
    let line = Stroke::new(1.0, palette.line);
    ui.painter().rect_stroke(rect, corners, line, egui::StrokeKind::Inside);
    let grip = Rect::from_center_size(rect.center_top() + vec2(0.0, 9.0), vec2(36.0, 4.0));
    ui.painter().rect_filled(grip, 2.0, palette.pressed);
}
