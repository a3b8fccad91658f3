//! Tracks under the timeline: when pins with times hold, and what.

use egui::Ui;

use super::{Shown, text, tracks};
use crate::retarget::{PinGoal, PinTimes};
use crate::state::title;

/// The pins with times: what is pinned to what, in short and in full.
fn timed<'a>(shown: &Shown<'a>) -> impl Iterator<Item = ([String; 2], PinTimes)> + use<'a> {
    let Shown { library, state, .. } = *shown;
    let pins = library.active().into_iter().flat_map(|model| state.edits.pins.iter().map(move |pin| (model, pin)));
    pins.filter_map(|(model, (&joint, pin))| {
        let times = pin.times?;
        let name = |joint| Some(title(Some(state), &model.asset, model.asset.skeleton.joint_of_source(joint)?));
        let joint = name(joint)?;
        let goal = if let PinGoal::Joint(other, _) = pin.goal { name(other) } else { None };
        let goal = goal.as_deref();
        let short = text::pin_name(tracks::short(&joint), pin.goal, goal.map(tracks::short));
        Some(([short, text::pin_to(&joint, pin.goal, goal)], times))
    })
}

/// Returns the width that the names of the pins take at the left of the timeline; 0 if there are none.
pub(super) fn gutter(ui: &Ui, shown: &Shown<'_>) -> f32 {
    tracks::widest(ui, &mut timed(shown).map(|([name, _], _)| name))
}

/// Shows a track for each of these pins: a bar while it holds, paler while it is blended in and out.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, gutter: f32) {
    let Some(duration_secs) = tracks::duration_secs(shown) else { return };
    for ([short, name], times) in timed(shown) {
        let about = text::pin_track(&name, &text::pin_times(times));
        let (_, response) = tracks::row(ui, shown, gutter, &short, &about, |ui, lane| {
            let x_of = |secs: f64| lane.left() + (secs / duration_secs) as f32 * lane.width();
            let PinTimes { start_secs, end_secs, blend_secs } = times;
            for (blend_secs, opacity) in [(blend_secs, 0.25), (0.0, 0.45)] {
                tracks::bar(ui, lane, [x_of(start_secs - blend_secs), x_of(end_secs + blend_secs)], opacity);
            }
        });
        response.on_hover_text_at_pointer(about);
    }
}
