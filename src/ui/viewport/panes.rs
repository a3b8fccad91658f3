//! Where things are on the screen: the panes of the side-by-side comparison, and world-space points in them.

use egui::{Pos2, Rect, pos2, vec2};
use glam::Vec2;

use crate::ui::Shown;

/// The panes of the viewport, row by row.
pub fn pane_rects(shown: &Shown<'_>, rect: Rect) -> Vec<Rect> {
    let [columns, rows] = shown.frame.panes.map(|count| count.max(1));
    let size = rect.size() / vec2(columns as f32, rows as f32);
    let at = |row: u32, column: u32| Rect::from_min_size(rect.min + vec2(column as f32, row as f32) * size, size);
    (0..rows).flat_map(|row| (0..columns).map(move |column| at(row, column))).collect()
}

/// The height that the labels at the lower edges of panes take, if there are several.
pub fn label_height(shown: &Shown<'_>) -> f32 {
    if shown.frame.panes.iter().any(|&count| count > 1) { 24.0 } else { 0.0 }
}

/// The pane under a point, or else the first one.
pub fn pane_at(shown: &Shown<'_>, rect: Rect, position: Option<Pos2>) -> Rect {
    let panes = pane_rects(shown, rect);
    panes.get(pane_index(&panes, position)).copied().unwrap_or(rect)
}

/// The index of the pane under a point, or else of the first one.
pub fn pane_index(panes: &[Rect], position: Option<Pos2>) -> usize {
    position.and_then(|position| panes.iter().position(|pane| pane.contains(position))).unwrap_or(0)
}

/// Normalized device coordinates of a point in a pane.
pub fn to_ndc(pane: Rect, position: Pos2) -> Vec2 {
    let part = (position - pane.min) / pane.size();
    Vec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y)
}

/// Projects a world-space point into a pane; `None` behind the camera.
pub fn to_screen(shown: &Shown<'_>, rect: Rect, world: glam::Vec3) -> Option<Pos2> {
    let view = &shown.frame.view;
    let projected = view.projection_from_view * view.view_from_world * world.extend(1.0);
    let ndc = Vec2::new(projected.x, projected.y) / projected.w;
    (projected.w > 0.0 && ndc.is_finite()).then(|| {
        pos2(
            egui::lerp(rect.left()..=rect.right(), 0.5 + 0.5 * ndc.x),
            egui::lerp(rect.top()..=rect.bottom(), 0.5 - 0.5 * ndc.y),
        )
    })
}
