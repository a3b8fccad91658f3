//! Foot-contact tracks under the timeline: when each foot is planted, and how fast it slides meanwhile.

use egui::{FontId, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::{Shown, scrub, style, text};
use crate::retarget::FootTrack;
use crate::state::title;

const TRACK_HEIGHT: f32 = 16.0;
const FONT_SIZE: f32 = 10.5;
/// Opacity of the background of text in a track.
const TEXT_BACKGROUND: f32 = 0.85;
/// The slide speed whose bar fills a track.
const MAX_METRES_PER_SEC: f32 = 0.5;

/// Shows the tracks of a borrowed clip.
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
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), TRACK_HEIGHT), Sense::hover());
        let lane = rect.shrink2(vec2(scrub::MARGIN, 1.0));
        let name = title(Some(shown.state), &model.asset, track.joint);
        response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Image, true, text::foot_contacts(&name)));
        contacts(ui, lane, track, duration_secs);
        let palette = style::palette(ui);
        // Hidden while hovering: the labels cover the first contacts.
        if !response.hovered() {
            labels(ui, lane, &name, index == 0);
        }
        let x = lane.left() + (shown.clip_time_secs() as f32 / duration_secs).clamp(0.0, 1.0) * lane.width();
        ui.painter().vline(x, lane.y_range(), Stroke::new(1.5, palette.accent));
        if let Some(pointer) = response.hover_pos() {
            let secs = (pointer.x - lane.left()) / lane.width() * duration_secs;
            let at = track.times.partition_point(|&time| time < secs).min(track.times.len().saturating_sub(1));
            let contact = if track.touching.get(at) == Some(&true) { "contact" } else { "no contact" };
            let speed = 100.0 * track.metres_per_sec.get(at).copied().unwrap_or(0.0);
            response.on_hover_text_at_pointer(format!(
                "{name}: {contact}, {speed:.0} cm/s over the ground\nFull height: 50 cm/s or more"
            ));
        }
    }
}

/// The name of the foot, and in the first track the legend.
fn labels(ui: &Ui, lane: Rect, name: &str, first: bool) {
    let palette = style::palette(ui);
    let named = ui.painter().layout_no_wrap(name.to_owned(), FontId::proportional(FONT_SIZE), palette.weak_text);
    let end = lane.left() + named.size().x + 8.0;
    ui.painter().rect_filled(lane.with_max_x(end), 3.0, palette.surface.gamma_multiply(TEXT_BACKGROUND));
    let at = pos2(lane.left() + 4.0, lane.center().y - 0.5 * named.size().y);
    ui.painter().galley(at, named, palette.weak_text);
    if first {
        legend(ui, lane.with_min_x(end));
    }
}

/// Explains the colours if there is room.
fn legend(ui: &Ui, room: Rect) {
    let palette = style::palette(ui);
    let entry =
        |label: &str| ui.painter().layout_no_wrap(label.to_owned(), FontId::proportional(FONT_SIZE), palette.weak_text);
    let entries = [(palette.chosen, entry("contact")), (palette.warning, entry("slide"))];
    const SQUARE: f32 = 8.0;
    let width = |galley: &egui::Galley| SQUARE + 4.0 + galley.size().x + 10.0;
    let whole = entries.iter().map(|(_, galley)| width(galley)).sum::<f32>();
    if whole > room.width() {
        return;
    }
    ui.painter().rect_filled(
        room.with_max_x(room.left() + whole),
        3.0,
        palette.surface.gamma_multiply(TEXT_BACKGROUND),
    );
    let mut x = room.left() + 2.0;
    for (color, galley) in entries {
        let square = Rect::from_center_size(pos2(x + 0.5 * SQUARE, room.center().y), egui::Vec2::splat(SQUARE));
        ui.painter().rect(square, 2.0, color, Stroke::new(1.0, palette.panel), egui::StrokeKind::Outside);
        let at = pos2(square.right() + 4.0, room.center().y - 0.5 * galley.size().y);
        x += width(&galley);
        ui.painter().galley(at, galley, palette.weak_text);
    }
}

/// A tint while the source's foot is planted, and in it a bar whose height is the slide speed of the model's foot.
fn contacts(ui: &Ui, lane: Rect, track: &FootTrack, duration_secs: f32) {
    let palette = style::palette(ui);
    let painter = ui.painter_at(lane);
    painter.rect_filled(lane, 3.0, palette.surface);
    let x_of = |secs: f32| lane.left() + secs / duration_secs * lane.width();
    let mut mesh = egui::Mesh::default();
    // Steps that fall on the same pixel share a column as high as the fastest.
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
        let height = (fastest / MAX_METRES_PER_SEC).min(1.0) * lane.height();
        let bar = Rect::from_min_max(pos2(from, lane.bottom() - height), pos2(to, lane.bottom()));
        mesh.add_colored_rect(bar, palette.warning);
        (start, fastest) = (None, 0.0);
    }
    painter.add(mesh);
}
