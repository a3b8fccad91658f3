//! The list of all pins in the Motion tab, and tracks under the timeline: when pins with times hold, and what.

use std::borrow::Cow;

use egui::{Ui, vec2};
use gaitway_retarget::{Pin, PinGoal, PinTimes};
use gaitway_scene::state::{Command, title};

use super::icons::{Icon, icon_button_sized, icon_size};
use super::widgets::controls::{self, capitals};
use super::{Output, Shown, text, tracks};

const BUTTON_SIZE: f32 = 28.0;

/// A pin and what it is called.
struct Named<'a> {
    /// Number of the pinned joint in the file.
    number: usize,
    pin: Pin,
    joint: Cow<'a, str>,
    /// Name of the joint that it is pinned to.
    goal: Option<Cow<'a, str>>,
}

impl Named<'_> {
    fn what(&self) -> String {
        text::pin_to(&self.joint, self.pin.goal, self.goal.as_deref())
    }
}

/// Those of the pins that `wanted` accepts.
fn pins<'a>(shown: &Shown<'a>, wanted: fn(&Pin) -> bool) -> impl Iterator<Item = Named<'a>> + use<'a> {
    let Shown { library, state, .. } = *shown;
    let pins =
        library.active().into_iter().flat_map(|model| state.character.edits.pins.iter().map(move |pin| (model, pin)));
    pins.filter(move |(_, (_, pin))| wanted(pin)).filter_map(|(model, (&number, &pin))| {
        let name = |number| Some(title(Some(state), &model.asset, model.asset.skeleton.joint_of_source(number)?));
        let goal = if let PinGoal::Joint(other, _) = pin.goal { name(other) } else { None };
        Some(Named { number, pin, joint: name(number)?, goal })
    })
}

/// The pins with times: what is pinned to what, in short and in full.
fn timed<'a>(shown: &Shown<'a>) -> impl Iterator<Item = ([String; 2], PinTimes)> + use<'a> {
    pins(shown, |pin| pin.times.is_some()).filter_map(|named| {
        let times = named.pin.times?;
        let goal = named.goal.as_deref().map(tracks::short);
        Some(([text::pin_name(tracks::short(&named.joint), named.pin.goal, goal), named.what()], times))
    })
}

/// Says where joints are pinned, and lists all pins: a row selects its joint.
pub(super) fn section(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let has_body = shown.library.active().is_some_and(|model| !model.body().slots.0.is_empty());
    let mut pins = pins(shown, |_| true).peekable();
    if !has_body && pins.peek().is_none() {
        return;
    }
    controls::section(ui, capitals!(text::PINS));
    controls::hint(ui, text::ABOUT_PINS);
    for named in pins {
        let is_selected = shown.state.selection.joint == Some(named.number);
        let row = |ui: &mut Ui| {
            let button = icon_size(ui, BUTTON_SIZE);
            let size = vec2(ui.available_width() - button.x - ui.spacing().item_spacing.x, button.y);
            let row = ui.allocate_ui(size, |ui| controls::list_row(ui, &named.what(), "", is_selected)).inner;
            if row.clicked() {
                out.commands.push(Command::SelectJoint((!is_selected).then_some(named.number)));
            }
            let remove = text::remove_pin(&named.joint);
            if icon_button_sized(ui, Icon::Close, &remove, BUTTON_SIZE).clicked() {
                out.commands.push(Command::SetPin { joint: named.number, pin: None });
            }
        };
        ui.push_id(("pin", named.number), |ui| ui.horizontal(row));
    }
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
