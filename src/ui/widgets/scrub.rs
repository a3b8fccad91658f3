//! The scrub bar: key marks, the playhead, and handles for the in and out points. All times are in clip seconds.

use egui::{Color32, Rect, Response, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use gaitway_character::anim::{Clip, TimeRange};

use super::{accessible, style};
use crate::ui::text;

pub struct Scrub<'a> {
    /// `None` for the rest pose, which has nothing to scrub.
    pub clip: Option<&'a Clip>,
    pub time_secs: f64,
    pub frames_per_sec: f64,
    pub range: Option<TimeRange>,
    /// Space left free at the left, for the names of what is shown below at the same scale.
    pub gutter: f32,
}

/// The result of a drag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scrubbed {
    Seek(f64),
    Range(TimeRange),
}

/// Minimum distance between marks in points.
const MARK_SPACING: f32 = 6.0;
/// Minimum distance between times in points.
const TIME_SPACING: f32 = 64.0;

/// Positions of a clip's keys at the resolution of the bar, cached between frames.
#[derive(Debug, Default)]
pub struct KeyMarks {
    /// The clip and the width that the marks were computed for.
    computed_for: Option<(Clip, u32)>,
    /// From 0 (start) to 1 (end). Of keys closer than [`MARK_SPACING`], only the first has a mark.
    positions: Vec<f32>,
    /// Times at regular distances, with their positions.
    times: Vec<(f32, String)>,
}

impl KeyMarks {
    fn refresh(&mut self, clip: &Clip, width: f32) {
        if self.computed_for.as_ref().is_some_and(|(known, at)| known.is_same(clip) && *at == width as u32) {
            return;
        }
        self.computed_for = Some((clip.clone(), width as u32));
        self.positions.clear();
        self.times.clear();
        let duration = clip.duration_secs();
        if duration <= 0.0 {
            return;
        }
        self.times = times(f64::from(duration), f64::from(width));
        let slots = width.max(1.0) as usize;
        let mut first_key = vec![None; slots + 1];
        for time in clip.key_times_secs() {
            let position = time / duration;
            let slot = ((position * slots as f32).round() as usize).min(slots);
            let first = first_key[slot].get_or_insert(position);
            *first = position.min(*first);
        }
        let mut next = 0.0;
        for position in first_key.into_iter().flatten() {
            if position >= next {
                self.positions.push(position);
                next = position + MARK_SPACING / width;
            }
        }
    }
}

/// Times from 0 on, as many as fit into a width in points, 1, 2 or 5 of a power of ten apart.
fn times(duration_secs: f64, width: f64) -> Vec<(f32, String)> {
    let least = duration_secs * f64::from(TIME_SPACING) / width.max(1.0);
    let power = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|&step| step >= least);
    let step = step.unwrap_or(10.0 * power);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let count = (duration_secs / step + 1e-6) as usize;
    (0..=count)
        .map(|at| at as f64 * step)
        .map(|secs| ((secs / duration_secs) as f32, format!("{secs:.decimals$} s")))
        .collect()
}

/// Height of the bar: handles, rail, marks and times.
const HEIGHT: f32 = 52.0;
/// Screens lower than this have no room to spare.
const ROOMY_HEIGHT: f32 = 400.0;
/// Space for the handles at either end of the rail.
pub const MARGIN: f32 = 9.0;

/// Geometry of the bar for one clip.
struct Bar {
    rect: Rect,
    rail: Rect,
    /// Extra space above the handles, for fingers.
    above: f32,
    duration_secs: f64,
}

impl Bar {
    fn x_of(&self, secs: f64) -> f32 {
        self.rail.left() + (secs / self.duration_secs).clamp(0.0, 1.0) as f32 * self.rail.width()
    }

    fn secs_at(&self, x: f32) -> f64 {
        f64::from(((x - self.rail.left()) / self.rail.width()).clamp(0.0, 1.0)) * self.duration_secs
    }
}

/// Shows the bar; returns what was dragged, and whether the playhead is held.
pub fn show(ui: &mut Ui, scrub: &Scrub<'_>, marks: &mut KeyMarks) -> (Option<Scrubbed>, bool) {
    // Fingers get more room above the handles and below the rail, if the screen has it.
    let is_roomy = style::is_for_fingers(ui) && ui.ctx().content_rect().height() >= ROOMY_HEIGHT;
    let (above, below) = if is_roomy { (14.0, 5.0) } else { (0.0, 0.0) };
    let height = above + HEIGHT + below;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let rect = rect.with_min_x(rect.left() + scrub.gutter).with_min_y(rect.top() + above);
    let rail =
        Rect::from_x_y_ranges(rect.left() + MARGIN..=rect.right() - MARGIN, rect.top() + 20.0..=rect.top() + 25.0);
    let Some(clip) = scrub.clip.filter(|clip| clip.duration_secs() > 0.0) else {
        ui.painter().rect_filled(rail, 2.5, style::palette(ui).surface);
        return (None, false);
    };
    let duration_secs = f64::from(clip.duration_secs());
    let bar = Bar { rect, rail, above, duration_secs };
    let range = scrub.range.unwrap_or(TimeRange { start_secs: 0.0, end_secs: duration_secs });

    let seek_area = Rect::from_x_y_ranges(rect.x_range(), rect.top() + 13.0..=rect.bottom());
    let seek = ui.interact(seek_area, ui.scope_id().with("seek"), Sense::click_and_drag());
    seek.widget_info(|| WidgetInfo::slider(true, scrub.time_secs, text::TIME));
    let is_held = seek.is_pointer_button_down_on();
    let step_secs = 1.0 / scrub.frames_per_sec;
    let requested = accessible::time_slider(ui, &seek, scrub.time_secs, duration_secs, step_secs);
    let mut scrubbed = requested.map(Scrubbed::Seek);
    if is_held && let Some(pointer) = seek.interact_pointer_pos() {
        // No request while the pointer rests, so that nothing is redrawn.
        let secs = bar.secs_at(pointer.x);
        scrubbed = (secs != scrub.time_secs).then_some(Scrubbed::Seek(secs));
    }
    // Each stops a frame before the other, which `Command::SetRange` would push along.
    let start = |secs: f64| TimeRange { start_secs: secs.min((range.end_secs - step_secs).max(0.0)), ..range };
    let end = |secs: f64| TimeRange { end_secs: secs.max((range.start_secs + step_secs).min(duration_secs)), ..range };
    let dragged = [handle(ui, &bar, range, -1.0, scrub).map(start), handle(ui, &bar, range, 1.0, scrub).map(end)];
    for range in dragged.into_iter().flatten() {
        scrubbed = (scrub.range != Some(range)).then_some(Scrubbed::Range(range));
    }
    marks.refresh(clip, rail.width());
    paint_rail(ui, &bar, range, scrub.time_secs, marks);
    paint_playhead(ui, &bar, scrub, &seek, is_held);
    (scrubbed, is_held)
}

/// A handle of the range; returns the time that it is dragged to. `side` is -1 for the in point and 1 for the out point.
fn handle(ui: &Ui, bar: &Bar, range: TimeRange, side: f32, scrub: &Scrub<'_>) -> Option<f64> {
    let palette = style::palette(ui);
    let is_start = side < 0.0;
    let (label, secs) = if is_start { (text::IN_POINT, range.start_secs) } else { (text::OUT_POINT, range.end_secs) };
    let x = bar.x_of(secs);
    let middle = 0.5 * (bar.x_of(range.start_secs) + bar.x_of(range.end_secs));
    // The least that can be aimed at (WCAG 2.5.8); larger for fingers, to the sides and upwards, where nothing else is. Where the
    // handles meet, each keeps its side.
    let (width, beyond) = (24.0 + 2.0 * bar.above, 9.0 + bar.above);
    let inner = if is_start { (x + beyond).min(middle) } else { (x - beyond).max(middle) };
    let center = pos2(inner + side * 0.5 * width, bar.rect.top() + 7.0 - 0.5 * bar.above);
    let grab = Rect::from_center_size(center, vec2(width, 24.0 + bar.above));
    let handle = ui.interact(grab, ui.scope_id().with(label), Sense::drag());
    handle.widget_info(|| WidgetInfo::slider(true, secs, label));
    let requested = accessible::time_slider(ui, &handle, secs, bar.duration_secs, 1.0 / scrub.frames_per_sec);
    let pointer = handle.interact_pointer_pos().filter(|_| handle.dragged());
    let color = match (handle.hovered() || handle.dragged(), scrub.range.is_some()) {
        (true, _) => palette.accent,
        (false, true) => palette.text,
        (false, false) => palette.weak_text.gamma_multiply(0.6),
    };
    flag(ui.painter(), x, bar.rect.top() + 3.0, side, bar.rail.bottom(), color);
    handle.on_hover_cursor(egui::CursorIcon::ResizeHorizontal).on_hover_text(format!("{label}. Drag to set."));
    pointer.map(|pointer| bar.secs_at(pointer.x)).or(requested)
}

fn paint_rail(ui: &Ui, bar: &Bar, range: TimeRange, time_secs: f64, marks: &KeyMarks) {
    let (palette, painter, rail) = (style::palette(ui), ui.painter(), bar.rail);
    let (start_x, end_x) = (bar.x_of(range.start_secs), bar.x_of(range.end_secs));
    painter.rect_filled(rail, 2.5, palette.pressed);
    let inside = Rect::from_x_y_ranges(start_x..=end_x, rail.y_range());
    painter.rect_filled(inside, 2.5, palette.accent.gamma_multiply(0.35));
    let played = Rect::from_x_y_ranges(start_x..=bar.x_of(time_secs).max(start_x), rail.y_range());
    painter.rect_filled(played, 2.5, palette.accent);
    let color = palette.weak_text.gamma_multiply(0.75);
    for &position in &marks.positions {
        let x = rail.left() + position * rail.width();
        painter.vline(x, rail.bottom() + 5.0..=rail.bottom() + 11.0, Stroke::new(1.0, color));
    }
    for (position, time) in &marks.times {
        let at = pos2(rail.left() + position * rail.width(), rail.bottom() + 12.0);
        let galley = painter.layout_no_wrap(time.clone(), style::SMALL, palette.weak_text);
        // Within the bar at either end.
        let x = (at.x - 0.5 * galley.size().x).clamp(bar.rect.left(), bar.rect.right() - galley.size().x);
        painter.galley(pos2(x, at.y), galley, palette.weak_text);
    }
}

fn paint_playhead(ui: &Ui, bar: &Bar, scrub: &Scrub<'_>, seek: &Response, is_held: bool) {
    let (palette, painter, rail) = (style::palette(ui), ui.painter(), bar.rail);
    let center = pos2(bar.x_of(scrub.time_secs), rail.center().y);
    let radius = if is_held || seek.hovered() { 8.0 } else { 7.0 };
    painter.circle(center, radius, palette.accent, Stroke::new(2.0, palette.panel));
    if seek.has_focus() {
        painter.circle_stroke(center, radius + 2.0, Stroke::new(1.5, palette.text));
    }
    let pointer = ui.input(|input| input.pointer.hover_pos()).filter(|_| seek.hovered() && !is_held);
    if let Some(pointer) = pointer {
        let x = pointer.x.clamp(rail.left(), rail.right());
        painter.vline(x, rail.top() - 3.0..=rail.bottom() + 3.0, Stroke::new(1.0, palette.weak_text));
        let time = text::time_and_frame(bar.secs_at(x), scrub.frames_per_sec);
        let galley = painter.layout_no_wrap(time, style::SMALL, palette.text);
        let half = 0.5 * galley.size().x + 4.0;
        let x = x.clamp(rail.left() + half, (rail.right() - half).max(rail.left() + half));
        let label = Rect::from_center_size(pos2(x, bar.rect.top() + 8.0), galley.size() + vec2(8.0, 2.0));
        painter.rect_filled(label, 4.0, palette.pressed);
        painter.galley(label.center() - 0.5 * galley.size(), galley, palette.text);
    }
}

/// A flag that points away from the range.
fn flag(painter: &egui::Painter, x: f32, top: f32, side: f32, bottom: f32, color: Color32) {
    painter.vline(x, top..=bottom, Stroke::new(1.2, color));
    let points = vec![pos2(x, top), pos2(x + side * 7.0, top + 4.5), pos2(x, top + 9.0)];
    painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use super::{KeyMarks, MARK_SPACING, times};
    use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton};

    #[test]
    fn marks_of_a_long_clip_stay_apart() {
        let skeleton = Skeleton::new(vec![Joint::default()]).expect("one joint");
        let times: Vec<f32> = (0..1800).map(|frame| frame as f32 / 30.0).collect();
        let keys = Keys::Translation((0..1800).map(|frame| glam::Vec3::X * frame as f32).collect());
        let mut clip = ClipBuilder::new("Long", &skeleton);
        clip.channel(JointIndex(0), Interpolation::Linear, &times, keys).expect("as many keys as times");
        let (mut marks, width) = (KeyMarks::default(), 372.0);
        marks.refresh(&clip.build(), width);
        assert!(marks.positions.len() > 40, "{}", marks.positions.len());
        let gaps = marks.positions.windows(2).map(|pair| (pair[1] - pair[0]) * width);
        gaps.for_each(|gap| assert!((MARK_SPACING - 0.01..2.0 * MARK_SPACING).contains(&gap), "{gap}"));
    }

    #[test]
    fn times_are_round_and_apart() {
        let told =
            |duration_secs, width| times(duration_secs, width).into_iter().map(|(_, time)| time).collect::<Vec<_>>();
        assert_eq!(told(1.07, 640.0), ["0.0 s", "0.2 s", "0.4 s", "0.6 s", "0.8 s", "1.0 s"]);
        assert_eq!(told(90.0, 400.0), ["0 s", "20 s", "40 s", "60 s", "80 s"]);
        assert_eq!(told(0.04, 300.0), ["0.00 s", "0.01 s", "0.02 s", "0.03 s", "0.04 s"]);
        for (duration_secs, width) in [(0.033, 300.0), (1.0, 300.0), (7.3, 900.0), (3600.0, 372.0)] {
            let positions: Vec<f32> = times(duration_secs, width).into_iter().map(|(position, _)| position).collect();
            assert!(positions.len() > 1, "{duration_secs}");
            assert!(positions.windows(2).all(|pair| (pair[1] - pair[0]) * width as f32 >= 63.9), "{duration_secs}");
        }
    }
}
