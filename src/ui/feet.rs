//! Foot-contact tracks under the timeline: when each foot is planted, and how fast it slides meanwhile.

use egui::{Rect, Sense, Stroke, Ui, pos2, vec2};
use gaitway_retarget::FootTrack;
use gaitway_scene::library::Model;
use gaitway_scene::state::title;

use super::tracks::{row, short, widest};
use super::{Shown, scrub, style, text};

/// Height of the line that explains colours and scale.
const LEGEND_HEIGHT: f32 = 16.0;
/// The slide speed whose bar fills a track.
const MAX_METRES_PER_SEC: f32 = 0.5;

/// The tracks of a borrowed clip with the names of the feet.
struct Tracks<'a> {
    model: &'a Model,
    tracks: &'a [FootTrack],
    duration_secs: f32,
}

impl<'a> Tracks<'a> {
    /// `None` if there are none.
    fn of(shown: &Shown<'a>) -> Option<Self> {
        let (model, clip) = (shown.library.active()?, shown.clip()?);
        let (tracks, duration_secs) = (shown.library.foot_tracks(clip.id()), clip.clip().duration_secs());
        (!tracks.is_empty() && duration_secs > 0.0).then_some(Self { model, tracks, duration_secs })
    }

    fn name(&self, shown: &Shown<'_>, track: &FootTrack) -> String {
        title(Some(shown.state), &self.model.asset, track.joint).into_owned()
    }
}

/// Returns the width that the names of the feet take at the left; 0 if there are no tracks.
pub(super) fn gutter(ui: &Ui, shown: &Shown<'_>) -> f32 {
    let Some(tracks) = Tracks::of(shown) else { return 0.0 };
    widest(ui, &mut tracks.tracks.iter().map(|track| short(&tracks.name(shown, track)).to_owned()))
}

/// Shows the tracks of a borrowed clip, with their names in the gutter and their legend below.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, gutter: f32) {
    let Some(tracks) = Tracks::of(shown) else { return };
    let duration_secs = tracks.duration_secs;
    for track in tracks.tracks {
        let name = tracks.name(shown, track);
        let (lane, response) = row(ui, shown, gutter, short(&name), &text::foot_contacts(&name), |ui, lane| {
            contacts(ui, lane, track, duration_secs);
        });
        if let Some(pointer) = response.hover_pos() {
            let secs = (pointer.x - lane.left()) / lane.width() * duration_secs;
            let at = track.times.partition_point(|&time| time < secs).min(track.times.len().saturating_sub(1));
            let contact = if track.touching.get(at) == Some(&true) { "contact" } else { "no contact" };
            let speed = 100.0 * track.metres_per_sec.get(at).copied().unwrap_or(0.0);
            response.on_hover_text_at_pointer(format!("{name}: {contact}, {speed:.0} cm/s over the ground"));
        }
    }
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), LEGEND_HEIGHT), Sense::hover());
    legend(ui, rect.with_min_x(rect.left() + gutter + scrub::MARGIN));
}

/// Explains the colours and the height of the bars, as far as there is room.
fn legend(ui: &Ui, room: Rect) {
    const SQUARE: f32 = 8.0;
    let palette = style::palette(ui);
    let mut x = room.left() + 2.0;
    for (color, label) in [(palette.chosen, text::FOOT_CONTACT), (palette.warning, text::FOOT_SLIDE)] {
        let galley = ui.painter().layout_no_wrap(label.to_owned(), style::SMALL, palette.weak_text);
        if x + SQUARE + 4.0 + galley.size().x > room.right() {
            return;
        }
        let square = Rect::from_center_size(pos2(x + 0.5 * SQUARE, room.center().y), egui::Vec2::splat(SQUARE));
        ui.painter().rect(square, 2.0, color, Stroke::new(1.0, palette.panel), egui::StrokeKind::Outside);
        let at = pos2(square.right() + 4.0, room.center().y - 0.5 * galley.size().y);
        x = at.x + galley.size().x + 12.0;
        ui.painter().galley(at, galley, palette.weak_text);
    }
}

/// A tint while the source's foot is planted, and in it a bar whose height is the slide speed of the model's foot. A line
/// marks half of the scale.
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
    let half = Stroke::new(1.0, palette.weak_text.gamma_multiply(0.35));
    painter.hline(lane.x_range(), lane.center().y, half);
}
