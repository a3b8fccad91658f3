//! The strip under the timeline: when each foot stands, and how fast it slides meanwhile.

use egui::{FontId, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::{Shown, scrub, style};
use crate::retarget::FootTrack;
use crate::state::title;

const LANE: f32 = 16.0;
/// Of the letters in a lane, and what of the lane is hidden under them.
const SMALL: f32 = 10.5;
const VEIL: f32 = 0.85;
/// A slide of this speed fills a lane.
const FULL_METRES_PER_SEC: f32 = 0.5;

/// Nothing for clips that are not borrowed.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>) {
    let (Some(model), Some(clip), Some(index)) = (shown.library.active(), shown.clip(), shown.clip_index()) else {
        return;
    };
    let tracks = shown.library.foot_tracks(index);
    let duration_secs = clip.duration_secs();
    if tracks.is_empty() || duration_secs <= 0.0 {
        return;
    }
    for (index, track) in tracks.iter().enumerate() {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LANE), Sense::hover());
        let lane = rect.shrink2(vec2(scrub::MARGIN, 1.0));
        let name = title(Some(shown.state), &model.asset, track.joint);
        response
            .widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Image, true, format!("{name} on the ground")));
        lane_of(ui, lane, track, duration_secs);
        let palette = style::palette(ui);
        // They lie over the first steps: whoever points at the lane wants to see those.
        if !response.hovered() {
            labels(ui, lane, &name, index == 0);
        }
        let x = lane.left() + (shown.clip_time_secs() as f32 / duration_secs).clamp(0.0, 1.0) * lane.width();
        ui.painter().vline(x, lane.y_range(), Stroke::new(1.5, palette.accent));
        if let Some(pointer) = response.hover_pos() {
            let secs = (pointer.x - lane.left()) / lane.width() * duration_secs;
            let at = track.times.partition_point(|&time| time < secs).min(track.times.len().saturating_sub(1));
            let stands = if track.touching.get(at) == Some(&true) { "stands" } else { "in the air" };
            let speed = 100.0 * track.metres_per_sec.get(at).copied().unwrap_or(0.0);
            response.on_hover_text_at_pointer(format!(
                "{name}: {stands}, {speed:.0} cm/s over the ground\nA bar as high as the lane: 50 cm/s or more"
            ));
        }
    }
}

/// The name of a lane's foot, and in the first lane what the colours mean.
fn labels(ui: &Ui, lane: Rect, name: &str, first: bool) {
    let palette = style::palette(ui);
    let named = ui.painter().layout_no_wrap(name.to_owned(), FontId::proportional(SMALL), palette.weak_text);
    let end = lane.left() + named.size().x + 8.0;
    ui.painter().rect_filled(lane.with_max_x(end), 3.0, palette.surface.gamma_multiply(VEIL));
    let at = pos2(lane.left() + 4.0, lane.center().y - 0.5 * named.size().y);
    ui.painter().galley(at, named, palette.weak_text);
    if first {
        legend(ui, lane.with_min_x(end));
    }
}

/// What the colours of the lanes mean, where there is room for it.
fn legend(ui: &Ui, room: Rect) {
    let palette = style::palette(ui);
    let entry =
        |text: &str| ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(SMALL), palette.weak_text);
    let entries = [(palette.chosen, entry("stands")), (palette.warning, entry("slides"))];
    const SQUARE: f32 = 8.0;
    let width = |galley: &egui::Galley| SQUARE + 4.0 + galley.size().x + 10.0;
    let whole = entries.iter().map(|(_, galley)| width(galley)).sum::<f32>();
    if whole > room.width() {
        return;
    }
    ui.painter().rect_filled(room.with_max_x(room.left() + whole), 3.0, palette.surface.gamma_multiply(VEIL));
    let mut x = room.left() + 2.0;
    for (color, galley) in entries {
        let square = Rect::from_center_size(pos2(x + 0.5 * SQUARE, room.center().y), egui::Vec2::splat(SQUARE));
        ui.painter().rect(square, 2.0, color, Stroke::new(1.0, palette.panel), egui::StrokeKind::Outside);
        let at = pos2(square.right() + 4.0, room.center().y - 0.5 * galley.size().y);
        x += width(&galley);
        ui.painter().galley(at, galley, palette.weak_text);
    }
}

/// A tint while the source's foot stands; in it a bar as high as the model's foot slides fast.
fn lane_of(ui: &Ui, lane: Rect, track: &FootTrack, duration_secs: f32) {
    let palette = style::palette(ui);
    let painter = ui.painter_at(lane);
    painter.rect_filled(lane, 3.0, palette.surface);
    let x_of = |secs: f32| lane.left() + secs / duration_secs * lane.width();
    let mut mesh = egui::Mesh::default();
    // Steps that fall on one pixel are one column: the fastest of them counts.
    let (mut start, mut fastest) = (None, 0.0_f32);
    for (at, &time) in track.times.iter().enumerate().skip(1) {
        if !(track.touching[at - 1] && track.touching[at]) {
            continue;
        }
        let from = *start.get_or_insert(x_of(track.times[at - 1]));
        fastest = fastest.max(track.metres_per_sec[at]);
        let to = x_of(time);
        let goes_on = track.touching.get(at + 1) == Some(&true);
        if to - from < 1.0 && goes_on {
            continue;
        }
        mesh.add_colored_rect(Rect::from_min_max(pos2(from, lane.top()), pos2(to, lane.bottom())), palette.chosen);
        let height = (fastest / FULL_METRES_PER_SEC).min(1.0) * lane.height();
        let bar = Rect::from_min_max(pos2(from, lane.bottom() - height), pos2(to, lane.bottom()));
        mesh.add_colored_rect(bar, palette.warning);
        (start, fastest) = (None, 0.0);
    }
    painter.add(mesh);
}
