//! Retargeting options (root motion, feet, joints without a source), and the tab's files.

use egui::{RichText, Ui};
use gaitway_character::sort::collect_set;
use gaitway_retarget::{
    ClipRef, Contacts, Feet, JointMap, Keep, PathOrigin, RestChoice, RestChoices, RootOptions, RootPart, Unmapped,
    UpChoice,
};
use gaitway_scene::editor::{ClipFormat, Export, derived_clip};
use gaitway_scene::state::{Command, Inspect, MapEdit, Show, active_clip};

use super::{Contents, Pairing};
use crate::ui::widgets::controls::{self, capitals};
use crate::ui::{Output, Saved, Shown, UiAction, style, text};

const PARTS: [(RootPart, &str); 3] =
    [(RootPart::Keep, text::KEEP), (RootPart::InPlace, text::IN_PLACE), (RootPart::Freeze, text::FREEZE)];

const ORIGINS: [(PathOrigin, &str); 2] = [(PathOrigin::Feet, text::FEET), (PathOrigin::Rest, text::REST)];

const KEEPS: [(Keep, &str); 3] = [(Keep::Auto, text::AUTOMATIC), (Keep::Keep, text::KEEP), (Keep::Drop, text::DROP)];

const UPS: [(UpChoice, &str); 3] = [(UpChoice::Auto, text::AUTOMATIC), (UpChoice::Y, "Y"), (UpChoice::Z, "Z")];

pub(super) fn show(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    map: &JointMap,
    contents: &Contents,
    out: &mut Output,
) {
    let edit = |edit| Command::EditMap { motion: pairing.id(), edit };
    controls::section(ui, "FEET AND CONTACTS");
    let planted = map.feet == Feet::Plant;
    if controls::switch(ui, text::PLANT_FEET, planted) {
        out.commands.push(Command::SetFeet(Some(if planted { Feet::Off } else { Feet::Plant })));
    }
    if shown.state.character.retarget.feet_are_automatic {
        controls::hint(ui, text::PLANTED_AUTOMATICALLY);
    }
    controls::hint(ui, "Planted feet don't slide, and a hovering motion is lowered to the ground.");
    let kept = map.contacts == Contacts::Keep;
    if controls::switch(ui, text::KEEP_CONTACTS, kept) {
        out.commands.push(Command::SetContacts(Some(if kept { Contacts::Off } else { Contacts::Keep })));
    }
    controls::hint(
        ui,
        "Hands touch the body, and hands and knees the ground, where the motion's do. Arms stay out of both.",
    );

    root_motion(ui, map.root, out);

    controls::section(ui, capitals!(text::UNMAPPED_JOINTS));
    unmapped(ui, pairing, map, out);

    rests(ui, pairing, map.rest, shown.state.inspect, out);

    controls::section(ui, capitals!(text::TRANSLATIONS));
    if let Some(translations) = controls::segmented_about(ui, text::TRANSLATIONS, Some(map.translations), &KEEPS) {
        out.commands.push(edit(MapEdit::Translations(translations)));
    }
    controls::section(ui, capitals!(text::SCALES));
    if let Some(scales) = controls::segmented_about(ui, text::SCALES, Some(map.scales), &KEEPS) {
        out.commands.push(edit(MapEdit::Scales(scales)));
    }
    controls::hint(ui, "Automatic keeps them when both skeletons are the same. The hips always travel.");

    controls::section(ui, "SWITCHING CLIPS");
    let settings =
        controls::SliderSettings { range: (0.0, 2.0), default: 0.0, decimals: 2, suffix: " s", logarithmic: false };
    if let Some(secs) = controls::slider(ui, text::CROSSFADE, map.crossfade_secs, settings) {
        out.commands.push(edit(MapEdit::CrossfadeSecs(secs)));
    }

    controls::section(ui, capitals!(text::IGNORED_CHANNELS));
    match &contents.ignored_channels {
        None => controls::hint(ui, "None. To ignore channels of a joint's source, select the joint in the table."),
        Some(joints) => {
            controls::hint(ui, joints);
            if ui.button(text::USE_ALL_CHANNELS).clicked() {
                out.commands.push(edit(MapEdit::UnmuteAll));
            }
        }
    }
}

/// The choices of both rest poses, and of the motion's up axis.
fn rests(ui: &mut Ui, pairing: &Pairing<'_>, rest: RestChoices, inspect: Inspect, out: &mut Output) {
    let edit = |rest| Command::EditMap { motion: pairing.id(), edit: MapEdit::Rest(rest) };
    controls::section(ui, capitals!(text::REST_POSE_ALIGNMENT));
    if let Some(model) = rest_choice(ui, "Model", text::REST_OF_MODEL, rest.model) {
        out.commands.push(edit(RestChoices { model, ..rest }));
    }
    if let Some(motion) = rest_choice(ui, "Motion", text::REST_OF_MOTION, rest.motion) {
        out.commands.push(edit(RestChoices { motion, ..rest }));
    }
    if controls::switch(ui, text::COMPARE_RESTS, inspect.rests) {
        let rests = !inspect.rests;
        out.commands.push(Command::SetInspect(Inspect { rests, split: inspect.split && !rests, ..inspect }));
    }
    controls::hint(ui, "The clip from each rest pose of the motion, side by side.");

    controls::section(ui, capitals!(text::UP_OF_MOTION));
    if let Some(up) = controls::segmented_about(ui, text::UP_OF_MOTION, Some(rest.up), &UPS) {
        out.commands.push(edit(RestChoices { up, ..rest }));
    }
}

/// The choices for each part of the root motion.
fn root_motion(ui: &mut Ui, root: RootOptions, out: &mut Output) {
    let set = |root: RootOptions| Command::SetRoot(Some(root));
    controls::section(ui, capitals!(text::ROOT_HORIZONTAL));
    if let Some(horizontal) = controls::segmented_about(ui, text::ROOT_HORIZONTAL, Some(root.horizontal), &PARTS) {
        out.commands.push(set(RootOptions { horizontal, ..root }));
    }
    controls::hint(ui, "In place: the character walks on the spot and still sways.");
    controls::section(ui, capitals!(text::ROOT_ORIGIN));
    if let Some(origin) = controls::segmented_about(ui, text::ROOT_ORIGIN, Some(root.origin), &ORIGINS) {
        out.commands.push(set(RootOptions { origin, ..root }));
    }
    controls::hint(
        ui,
        "Feet: they are where the motion's are, scaled to the model. Rest: the path is measured from both rest poses.",
    );
    controls::section(ui, capitals!(text::ROOT_VERTICAL));
    if let Some(vertical) = controls::segmented_about(ui, text::ROOT_VERTICAL, Some(root.vertical), &PARTS) {
        out.commands.push(set(RootOptions { vertical, ..root }));
    }
    controls::section(ui, capitals!(text::ROOT_TURN));
    if let Some(yaw) = controls::segmented_about(ui, text::ROOT_TURN, Some(root.yaw), &PARTS) {
        out.commands.push(set(RootOptions { yaw, ..root }));
    }
    ui.add_space(4.0);
    if controls::switch(ui, text::EXTRACT_ROOT_MOTION, root.extract) {
        out.commands.push(set(RootOptions { extract: !root.extract, ..root }));
    }
}

/// Says how many joints of the motion have ignored channels; `None` if none has.
pub(super) fn ignored_channels(map: &JointMap) -> Option<String> {
    let joints = collect_set(map.muted_channels.iter().map(|channel| channel.source));
    match joints.len() {
        0 => None,
        1 => Some("Channels of 1 joint in the motion.".to_owned()),
        count => Some(format!("Channels of {count} joints in the motion.")),
    }
}

/// Buttons that open, save and remove files.
pub(super) fn files(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>, out: &mut Output) {
    // `problem` disables the button and says why.
    let button = |ui: &mut Ui, text: &str, problem: Option<&str>| {
        let button = egui::Button::new(text).min_size(egui::vec2(ui.available_width(), 32.0));
        let response = ui.add_enabled(problem.is_none(), button);
        problem.map_or(response.clone(), |problem| response.on_disabled_hover_text(problem)).clicked()
    };
    controls::section(ui, "JOINT MAP");
    controls::hint(
        ui,
        "The source of each joint and these options, as JSON. You can also drop a map anywhere. It applies to every motion that it fits.",
    );
    ui.add_space(2.0);
    if button(ui, text::SAVE_MAP, None) {
        out.actions.push(UiAction::Save(Saved::File(Export::Map { motion: pairing.id() })));
    }
    if button(ui, text::LOAD_MAP, None) {
        out.actions.push(UiAction::ChooseMotion);
    }
    controls::section(ui, "MODEL WITH THIS CLIP");
    let clip = active_clip(pairing.model, shown.state);
    controls::hint(ui, "The model's file with the current clip added.");
    ui.add_space(2.0);
    let derived = derived_clip(pairing.model, shown.state);
    let problem = if clip.is_some() { text::IS_IN_FILE } else { text::NEEDS_CLIP };
    if button(ui, text::SAVE_GLB, derived.is_none().then_some(problem))
        && let Some(clip) = derived
    {
        out.actions.push(UiAction::Save(Saved::File(Export::Model { clip: clip.id().clone() })));
    }
    controls::section(ui, "CLIP ALONE");
    controls::hint(ui, "The current clip with its skeleton, without the meshes.");
    ui.add_space(2.0);
    for format in ClipFormat::ALL.into_iter().filter(|format| format.fits(pairing.model)) {
        if button(ui, text::save_clip(format), clip.is_none().then_some(text::NEEDS_CLIP))
            && let Some(clip) = clip
        {
            out.actions.push(UiAction::Save(Saved::File(Export::Clip { clip: clip.id().clone(), format })));
        }
    }
    controls::section(ui, "MOTION");
    let show = shown.state.display.show;
    // Only a borrowed clip has a source to show.
    let is_borrowed = clip.is_some_and(|clip| clip.borrowed().is_some());
    let label = if show.source { text::HIDE_SOURCE } else { text::SHOW_SOURCE };
    if button(ui, label, (!is_borrowed).then_some(text::NEEDS_BORROWED_CLIP)) {
        out.commands.push(Command::SetShow(Show { source: !show.source, over: false, ..show }));
    }
    if button(ui, text::OPEN_INSTEAD, None) {
        out.actions.push(UiAction::ShowMotionAlone(pairing.id()));
    }
    if button(ui, text::REMOVE_MOTION, None) {
        out.actions.push(UiAction::RemoveMotion(pairing.id()));
    }
}

fn rest_choice(ui: &mut Ui, label: &str, name: &str, chosen: RestChoice) -> Option<RestChoice> {
    let mut pressed = None;
    ui.horizontal(|ui| {
        let weak = style::palette(ui).weak_text;
        controls::sized(ui, [52.0, 28.0], egui::Label::new(RichText::new(label).color(weak)));
        controls::chooser(ui, ("rest", label), name, text::rest_choice(chosen), |ui| {
            for choice in RestChoice::ALL {
                if controls::option(ui, choice == chosen, text::rest_choice(choice)) {
                    pressed = Some(choice);
                }
            }
        });
    });
    pressed
}

/// The policies for joints without a source, with their labels.
pub(super) fn policies(pairing: &Pairing<'_>) -> Vec<(Unmapped, String)> {
    let mut policies = vec![(Unmapped::Rest, text::REST.to_owned())];
    for index in 0..pairing.model.asset.clips.len() {
        for frozen in [false, true] {
            let policy = Unmapped::Clip { clip: ClipRef::Index(index), frozen };
            let text = policy_text(pairing, &policy);
            policies.push((policy, text));
        }
    }
    policies
}

pub(super) fn policy_text(pairing: &Pairing<'_>, policy: &Unmapped) -> String {
    match pairing.own_clip(policy) {
        None => text::REST.to_owned(),
        Some((clip, false)) => format!("Play {}", pairing.clip_title(clip)),
        Some((clip, true)) => text::first_key_of(pairing.clip_title(clip)),
    }
}

fn unmapped(ui: &mut Ui, pairing: &Pairing<'_>, map: &JointMap, out: &mut Output) {
    let clips = &pairing.model.asset.clips;
    let playing = pairing.own_clip(&map.unmapped);
    let plays = |clip: usize, frozen: bool| {
        let unmapped = Unmapped::Clip { clip: ClipRef::Index(clip), frozen };
        Command::SetUnmapped(Some(unmapped))
    };
    let chosen = match playing {
        None => text::REST,
        Some((clip, _)) => pairing.clip_title(clip),
    };
    controls::chooser(ui, "unmapped", text::UNMAPPED_JOINTS, chosen, |ui| {
        if controls::option(ui, playing.is_none(), text::REST) {
            out.commands.push(Command::SetUnmapped(Some(Unmapped::Rest)));
        }
        for (index, title) in pairing.model.clips().titles().enumerate().take(clips.len()) {
            let chosen = playing.is_some_and(|(clip, _)| clip == index);
            if controls::option(ui, chosen, title) {
                out.commands.push(plays(index, playing.is_some_and(|(_, frozen)| frozen)));
            }
        }
    });
    match playing {
        Some((clip, frozen)) => {
            if controls::switch(ui, text::HOLD_FIRST_KEY, frozen) {
                out.commands.push(plays(clip, !frozen));
            }
        }
        None if clips.is_empty() => {}
        None => controls::hint(ui, "They can also play one of the model's own clips, which loops independently."),
    }
}
