//! Tracks under the timeline: when pins with times hold.

use std::borrow::Cow;

use egui::{Rect, Ui, vec2};

use super::{Shown, feet, style, text};
use crate::retarget::PinTimes;
use crate::state::title;

/// The pins with times, with the names of their joints.
fn tracks<'a>(shown: &Shown<'a>) -> impl Iterator<Item = (Cow<'a, str>, PinTimes)> + use<'a> {
    let Shown { library, state, .. } = *shown;
    let pins = library.active().into_iter().flat_map(|model| state.edits.pins.iter().map(move |pin| (model, pin)));
    pins.filter_map(|(model, (&joint, pin))| {
        let joint = model.asset.skeleton.joint_of_source(joint)?;
        Some((title(Some(state), &model.asset, joint), pin.times?))
    })
}

/// Returns the width that the names of the joints take at the left of the timeline; 0 if there are none.
pub(super) fn gutter(ui: &Ui, shown: &Shown<'_>) -> f32 {
    feet::widest(ui, &mut tracks(shown).map(|(name, _)| feet::short(&name).to_owned()))
}

/// Shows a track for each of these pins: a bar while it holds, paler while it is blended in and out.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, gutter: f32) {
    let Some(duration_secs) = shown.clip().map(|clip| f64::from(clip.duration_secs())).filter(|&secs| secs > 0.0)
    else {
        return;
    };
    let color = style::palette(ui).accent;
    for (name, times) in tracks(shown) {
        let when = text::pin_times(times);
        let (_, response) =
            feet::row(ui, shown, gutter, feet::short(&name), &text::pin_track(&name, &when), |ui, lane| {
                let x_of = |secs: f64| lane.left() + (secs / duration_secs) as f32 * lane.width();
                let PinTimes { start_secs, end_secs, blend_secs } = times;
                for (blend_secs, opacity) in [(blend_secs, 0.25), (0.0, 0.45)] {
                    let bar = x_of(start_secs - blend_secs)..=x_of(end_secs + blend_secs);
                    let bar = Rect::from_x_y_ranges(bar, lane.y_range()).shrink2(vec2(0.0, 3.0));
                    ui.painter_at(lane).rect_filled(bar, 3.0, color.gamma_multiply(opacity));
                }
            });
        response.on_hover_text_at_pointer(when);
    }
}
