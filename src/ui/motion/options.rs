//! How the motion is carried over: what becomes of its travel, of joints that follow nothing, of the feet.

use egui::{RichText, Ui};

use super::Pairing;
use crate::retarget::{ClipRef, Feet, JointMap, RestChoice, RestChoices, RootOptions, RootPart, Unmapped};
use crate::state::Command;
use crate::ui::{Output, Shown, UiAction, controls, style};

const PARTS: [(RootPart, &str); 3] =
    [(RootPart::Keep, "Keep"), (RootPart::InPlace, "In place"), (RootPart::Freeze, "Freeze")];

const RESTS: [(RestChoice, &str); 4] = [
    (RestChoice::Auto, "Automatic"),
    (RestChoice::Node, "As the file's nodes stand"),
    (RestChoice::Bind, "As the mesh was bound"),
    (RestChoice::FirstFrame, "The clip's first frame"),
];

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>, map: &JointMap, out: &mut Output) {
    let root = map.root;
    let set = |root: RootOptions| Command::SetRoot(Some(root));
    if let Some(horizontal) = parts(ui, "Over the ground", root.horizontal) {
        out.commands.push(set(RootOptions { horizontal, ..root }));
    }
    controls::hint(ui, "In place takes the way out and leaves the sway.");
    if let Some(vertical) = parts(ui, "Up and down", root.vertical) {
        out.commands.push(set(RootOptions { vertical, ..root }));
    }
    if let Some(yaw) = parts(ui, "Turning", root.yaw) {
        out.commands.push(set(RootOptions { yaw, ..root }));
    }
    ui.add_space(4.0);
    if controls::switch(ui, "Travel on the root joint", root.extract) {
        out.commands.push(set(RootOptions { extract: !root.extract, ..root }));
    }

    controls::section(ui, "FEET");
    let planted = map.feet == Feet::Plant;
    if controls::switch(ui, "Hold feet on the ground", planted) {
        out.commands.push(Command::SetFeet(Some(if planted { Feet::Off } else { Feet::Plant })));
    }

    controls::section(ui, "JOINTS THAT FOLLOW NOTHING");
    unmapped(ui, pairing, map, out);

    controls::section(ui, "REST POSES THAT ARE MATCHED");
    let rest = map.rest;
    if let Some(model) = rest_choice(ui, "Model", rest.model) {
        out.commands.push(set_rest(pairing, map, shown, RestChoices { model, ..rest }));
    }
    if let Some(motion) = rest_choice(ui, "Motion", rest.motion) {
        out.commands.push(set_rest(pairing, map, shown, RestChoices { motion, ..rest }));
    }

    controls::section(ui, "THE FILE");
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(6.0, 6.0);
        let alone =
            ui.button("Show its own skeleton").on_hover_text("Look at the motion by itself instead of the model");
        if alone.clicked() {
            out.actions.push(UiAction::ShowMotionAlone(pairing.index));
        }
        if ui.button("Remove motion").on_hover_text("Borrow nothing any more").clicked() {
            out.actions.push(UiAction::RemoveMotions);
        }
    });
}

fn parts(ui: &mut Ui, about: &str, chosen: RootPart) -> Option<RootPart> {
    controls::section(ui, &about.to_uppercase());
    controls::segmented_about(ui, about, Some(chosen), &PARTS)
}

/// The rest poses are part of the map, with everything else that it says.
fn set_rest(pairing: &Pairing<'_>, map: &JointMap, shown: &Shown<'_>, rest: RestChoices) -> Command {
    // What the view sets over the map stays where it is.
    let bare = crate::state::ViewerState { map: shown.state.map.clone(), ..Default::default() };
    let own = crate::state::map_in_force(shown.library, &bare, pairing.index).unwrap_or_else(|| map.clone());
    Command::SetMap { motion: pairing.index, map: Some(Box::new(JointMap { rest, ..own })) }
}

fn rest_choice(ui: &mut Ui, label: &str, chosen: RestChoice) -> Option<RestChoice> {
    let mut pressed = None;
    ui.horizontal(|ui| {
        let weak = style::palette(ui).weak_text;
        ui.add_sized([52.0, 28.0], egui::Label::new(RichText::new(label).color(weak)));
        let text = RESTS.iter().find(|(choice, _)| *choice == chosen).map_or("", |(_, text)| text);
        let combo = egui::ComboBox::from_id_salt(("rest", label)).width(ui.available_width()).selected_text(text);
        let response = combo.show_ui(ui, |ui| {
            for (choice, text) in RESTS {
                if ui.selectable_label(choice == chosen, text).clicked() {
                    pressed = Some(choice);
                }
            }
        });
        response.response.accessible_name(format!("Rest pose of the {}", label.to_lowercase()));
    });
    pressed
}

fn unmapped(ui: &mut Ui, pairing: &Pairing<'_>, map: &JointMap, out: &mut Output) {
    let clips = &pairing.model.asset.clips;
    let titles = pairing.model.clip_titles();
    let playing = pairing.own_clip(&map.unmapped);
    let plays = |clip: usize, frozen: bool| {
        let unmapped = Unmapped::Clip { clip: ClipRef::Index(clip), frozen };
        Command::SetUnmapped(Some(unmapped))
    };
    let text = match playing {
        None => "Rest",
        Some((clip, _)) => pairing.clip_title(clip),
    };
    let combo = egui::ComboBox::from_id_salt("unmapped").width(ui.available_width()).truncate().selected_text(text);
    let response = combo.show_ui(ui, |ui| {
        if ui.selectable_label(playing.is_none(), "Rest").clicked() {
            out.commands.push(Command::SetUnmapped(Some(Unmapped::Rest)));
        }
        for (index, title) in titles.iter().enumerate().take(clips.len()) {
            let chosen = playing.is_some_and(|(clip, _)| clip == index);
            if ui.selectable_label(chosen, title).clicked() {
                out.commands.push(plays(index, playing.is_some_and(|(_, frozen)| frozen)));
            }
        }
    });
    response.response.accessible_name("Joints that follow nothing");
    match playing {
        Some((clip, frozen)) => {
            if controls::switch(ui, "Stand still at the clip's first key", frozen) {
                out.commands.push(plays(clip, !frozen));
            }
        }
        None if clips.is_empty() => {}
        None => controls::hint(ui, "They can also play one of the model's own clips, each on its own time."),
    }
}
