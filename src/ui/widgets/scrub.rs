//! The scrub bar: key marks, the playhead, and handles for the in and out points. Knows only times in clip seconds.

use egui::{Color32, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::style;
use crate::anim::{Clip, TimeRange};
use crate::library::ModelId;

pub struct Scrub<'a> {
    /// None: the rest pose, nothing to scrub.
    pub clip: Option<&'a Clip>,
    pub time_secs: f64,
    pub range: Option<TimeRange>,
}

/// What was dragged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scrubbed {
    Seek(f64),
    Range(TimeRange),
}

/// Marks closer than this cannot be told apart; that many in a row are one bar.
const CLOSE: f32 = 3.0;
const MANY: usize = 8;

/// Where the keys of a clip lie, as far as they can be told apart at the bar's width; kept from frame to frame.
#[derive(Debug, Default)]
pub struct KeyMarks {
    of: Option<(ModelId, usize, u32, u32, usize)>,
    /// From 0 (start) to 1 (end): single keys, and keys too close for marks of their own, as first and last.
    stretches: Vec<[f32; 2]>,
}

impl KeyMarks {
    fn refresh(&mut self, clip: &Clip, of: (ModelId, usize), width: f32) {
        // A borrowed clip may become another one under the same number.
        let keys = clip.timelines().iter().map(|times| times.len()).sum();
        let of = (of.0, of.1, width as u32, clip.duration_secs().to_bits(), keys);
        if self.of == Some(of) {
            return;
        }
        self.of = Some(of);
        self.stretches.clear();
        let duration = clip.duration_secs();
        if duration <= 0.0 {
            return;
        }
        let slots = (width / CLOSE).max(1.0) as usize;
        let mut first_key = vec![None; slots + 1];
        for &time in clip.timelines().iter().flatten() {
            let position = time / duration;
            let slot = ((position * slots as f32).round() as usize).min(slots);
            first_key[slot].get_or_insert(position);
        }
        for keys in first_key.chunk_by(|one, next| one.is_some() == next.is_some()) {
            let Some((&Some(first), &Some(last))) = keys.first().zip(keys.last()) else { continue };
            match keys.len() < MANY {
                true => self.stretches.extend(keys.iter().flatten().map(|&key| [key, key])),
                false => self.stretches.push([first, last]),
            }
        }
    }
}

/// Height of the whole bar: a lane for the handles, the rail, and the marks.
const HEIGHT: f32 = 42.0;
/// How far from either end the rail begins, so that the handles fit.
pub const MARGIN: f32 = 9.0;

/// `of` says which clip of which model this is. True in the second place while the playhead is held.
pub fn show(ui: &mut Ui, scrub: &Scrub<'_>, of: (ModelId, usize), marks: &mut KeyMarks) -> (Option<Scrubbed>, bool) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let rail =
        Rect::from_x_y_ranges(rect.left() + MARGIN..=rect.right() - MARGIN, rect.top() + 20.0..=rect.top() + 25.0);
    let palette = style::palette(ui);
    let painter = ui.painter().clone();
    let Some(clip) = scrub.clip.filter(|clip| clip.duration_secs() > 0.0) else {
        painter.rect_filled(rail, 2.5, palette.surface);
        return (None, false);
    };
    let duration = f64::from(clip.duration_secs());
    let x_of = |secs: f64| rail.left() + (secs / duration).clamp(0.0, 1.0) as f32 * rail.width();
    let secs_at = |x: f32| f64::from(((x - rail.left()) / rail.width()).clamp(0.0, 1.0)) * duration;
    let range = scrub.range.unwrap_or(TimeRange { start_secs: 0.0, end_secs: duration });
    let (start_x, end_x) = (x_of(range.start_secs), x_of(range.end_secs));
    let mut scrubbed = None;

    let seek_area = Rect::from_x_y_ranges(rect.x_range(), rect.top() + 13.0..=rect.bottom());
    let seek = ui.interact(seek_area, ui.scope_id().with("seek"), Sense::click_and_drag());
    seek.widget_info(|| WidgetInfo::slider(true, scrub.time_secs, "Time"));
    let held = seek.is_pointer_button_down_on();
    if held && let Some(pointer) = seek.interact_pointer_pos() {
        // Held still, it asks for nothing: nothing needs to be drawn again.
        let secs = secs_at(pointer.x);
        scrubbed = (secs != scrub.time_secs).then_some(Scrubbed::Seek(secs));
    }

    for (label, x, is_start) in [("In point", start_x, true), ("Out point", end_x, false)] {
        let side = if is_start { -1.0 } else { 1.0 };
        let grab = Rect::from_center_size(pos2(x + side * 3.0, rect.top() + 8.0), vec2(18.0, 18.0));
        let handle = ui.interact(grab, ui.scope_id().with(label), Sense::drag());
        let at = if is_start { range.start_secs } else { range.end_secs };
        handle.widget_info(|| WidgetInfo::slider(true, at, label));
        if handle.dragged()
            && let Some(pointer) = handle.interact_pointer_pos()
        {
            let secs = secs_at(pointer.x);
            let range = if is_start {
                TimeRange { start_secs: secs.min(range.end_secs), end_secs: range.end_secs }
            } else {
                TimeRange { start_secs: range.start_secs, end_secs: secs.max(range.start_secs) }
            };
            scrubbed = (scrub.range != Some(range)).then_some(Scrubbed::Range(range));
        }
        let lit = handle.hovered() || handle.dragged();
        let color = match (lit, scrub.range.is_some()) {
            (true, _) => palette.accent,
            (false, true) => palette.text,
            (false, false) => palette.weak_text.gamma_multiply(0.6),
        };
        flag(&painter, x, rect.top() + 3.0, side, rail.bottom(), color);
        handle
            .on_hover_cursor(egui::CursorIcon::ResizeHorizontal)
            .on_hover_text(format!("{label}: drag to play a part"));
    }

    marks.refresh(clip, of, rail.width());
    painter.rect_filled(rail, 2.5, palette.pressed);
    let inside = Rect::from_x_y_ranges(start_x..=end_x, rail.y_range());
    painter.rect_filled(inside, 2.5, palette.accent.gamma_multiply(0.35));
    let x = x_of(scrub.time_secs);
    let played = Rect::from_x_y_ranges(start_x..=x.max(start_x), rail.y_range());
    painter.rect_filled(played, 2.5, palette.accent);
    for &stretch in &marks.stretches {
        let [first, last] = stretch.map(|position| rail.left() + position * rail.width());
        let color = palette.weak_text.gamma_multiply(0.75);
        if first == last {
            painter.vline(first, rail.bottom() + 5.0..=rail.bottom() + 11.0, Stroke::new(1.0, color));
        } else {
            let bar = Rect::from_x_y_ranges(first..=last, rail.bottom() + 7.0..=rail.bottom() + 9.0);
            painter.rect_filled(bar, 1.0, color.gamma_multiply(0.6));
        }
    }
    let center = pos2(x, rail.center().y);
    let radius = if held || seek.hovered() { 8.0 } else { 7.0 };
    painter.circle(center, radius, palette.accent, Stroke::new(2.0, palette.panel));
    if seek.has_focus() {
        painter.circle_stroke(center, radius + 2.0, Stroke::new(1.5, palette.text));
    }
    if seek.hovered()
        && !held
        && let Some(pointer) = ui.input(|input| input.pointer.hover_pos())
    {
        let hover_x = pointer.x.clamp(rail.left(), rail.right());
        painter.vline(hover_x, rail.top() - 3.0..=rail.bottom() + 3.0, Stroke::new(1.0, palette.weak_text));
    }
    (scrubbed, held)
}

/// A small flag on a pole that points away from the range.
fn flag(painter: &egui::Painter, x: f32, top: f32, side: f32, bottom: f32, color: Color32) {
    painter.vline(x, top..=bottom, Stroke::new(1.2, color));
    let points = vec![pos2(x, top), pos2(x + side * 7.0, top + 4.5), pos2(x, top + 9.0)];
    painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
}
