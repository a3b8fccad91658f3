//! Tracks under the timeline: when pins with times hold.

use std::borrow::Cow;

use egui::Ui;

use super::{Shown, text, tracks};
use crate::retarget::PinTimes;
use crate::state::title;

/// The pins with times, with the names of their joints.
fn timed<'a>(shown: &Shown<'a>) -> impl Iterator<Item = (Cow<'a, str>, PinTimes)> + use<'a> {
    let Shown { library, state, .. } = *shown;
    let pins = library.active().into_iter().flat_map(|model| state.edits.pins.iter().map(move |pin| (model, pin)));
    pins.filter_map(|(model, (&joint, pin))| {
        let joint = model.asset.skeleton.joint_of_source(joint)?;
        Some((title(Some(state), &model.asset, joint), pin.times?))
    })
}

/// Returns the width that the names of the joints take at the left of the timeline; 0 if there are none.
pub(super) fn gutter(ui: &Ui, shown: &Shown<'_>) -> f32 {
    tracks::widest(ui, &mut timed(shown).map(|(name, _)| tracks::short(&name).to_owned()))
}

/// Shows a track for each of these pins: a bar while it holds, paler while it is blended in and out.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, gutter: f32) {
    let Some(duration_secs) = tracks::duration_secs(shown) else { return };
    for (name, times) in timed(shown) {
        let when = text::pin_times(times);
        let (_, response) =
            tracks::row(ui, shown, gutter, tracks::short(&name), &text::pin_track(&name, &when), |ui, lane| {
                let x_of = |secs: f64| lane.left() + (secs / duration_secs) as f32 * lane.width();
                let PinTimes { start_secs, end_secs, blend_secs } = times;
                for (blend_secs, opacity) in [(blend_secs, 0.25), (0.0, 0.45)] {
                    tracks::bar(ui, lane, [x_of(start_secs - blend_secs), x_of(end_secs + blend_secs)], opacity);
                }
            });
        response.on_hover_text_at_pointer(when);
    }
}
