//! The Motion tab: which joint follows which, why, and how the motion is carried over.

mod joints;
mod options;
mod picker;

use egui::{RichText, ScrollArea, Ui};

use super::{Output, Saved, Shown, UiAction, UiState, clips, controls, scene_tree, short_name, style};
use crate::anim::JointIndex;
use crate::asset::Asset;
use crate::library::{Library, Model, Motion};
use crate::retarget::{ClipRef, Contradiction, JointMap, Proposal, SourceRef, Unmapped};
use crate::state::{Command, active_clip, choice_of_clip, map_in_force};

pub(super) use picker::show as picker;

/// What the tab remembers.
#[derive(Debug, Default)]
pub(super) struct MotionTab {
    /// The options are shown instead of the joints.
    options: bool,
    search: String,
    /// A joint's source is being chosen.
    picking: Option<picker::Picking>,
}

impl MotionTab {
    /// The list of sources lies over everything and has the keyboard.
    pub fn is_picking(&self) -> bool {
        self.picking.is_some()
    }
}

/// One motion over the shown model.
#[derive(Clone, Copy)]
struct Pairing<'a> {
    model: &'a Model,
    motion: &'a Motion,
    index: usize,
    proposal: Option<&'a Proposal>,
}

impl<'a> Pairing<'a> {
    /// The motion whose clip plays, else the first.
    fn shown(shown: &Shown<'a>) -> Option<Self> {
        let model = shown.library.active()?;
        let playing = active_clip(model, shown.state).and_then(|clip| model.borrowed(clip));
        Self::of(shown.library, playing.map_or(0, |borrowed| borrowed.motion))
    }

    fn of(library: &'a Library, index: usize) -> Option<Self> {
        let (model, motion) = (library.active()?, library.motions().get(index)?);
        Some(Self { model, motion, index, proposal: library.proposal(index) })
    }

    /// Which of the model's clips joints without a source play, and whether it stands still; none: they rest.
    fn own_clip(&self, unmapped: &Unmapped) -> Option<(usize, bool)> {
        let Unmapped::Clip { clip, frozen } = unmapped else { return None };
        let clips = &self.model.asset.clips;
        let index = match clip {
            ClipRef::Index(index) => *index,
            ClipRef::Name(name) => clips.iter().position(|clip| clip.name() == name).unwrap_or(usize::MAX),
        };
        Some((index, *frozen))
    }

    fn clip_title(&self, clip: usize) -> &'a str {
        self.model.clip_titles().get(clip).map_or("a clip that is not there", String::as_str)
    }

    /// The source that a map gives to a target. None: the map does not speak of it; `Some(None)`: deliberately none.
    fn source_in(&self, map: &JointMap, target: usize) -> Option<Option<JointIndex>> {
        let entry = map.joints.get(&format!("#{target}"))?;
        let skeleton = &self.motion.asset.skeleton;
        Some(entry.source.as_ref().and_then(|source| match source {
            SourceRef::Number(number) => skeleton.joint_of_source(*number),
            SourceRef::Name(name) => skeleton.find(name),
        }))
    }
}

/// With less height than this the whole tab scrolls, else only what is under its head.
const ROOMY_HEIGHT: f32 = 480.0;

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(pairing) = Pairing::shown(shown) else { return };
    let map = map_in_force(shown.library, shown.state, pairing.index).unwrap_or_default();
    let tab = &mut local.motion;
    if ui.available_height() >= ROOMY_HEIGHT {
        head(ui, shown, &pairing, &map, tab, out);
        scrolled(ui, tab.options, |ui| body(ui, shown, &pairing, &map, tab, out));
    } else {
        scrolled(ui, tab.options, |ui| {
            head(ui, shown, &pairing, &map, tab, out);
            body(ui, shown, &pairing, &map, tab, out);
        });
    }
}

/// `options` keeps the places of the two parts apart.
fn scrolled(ui: &mut Ui, options: bool, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().id_salt(("motion", options)).auto_shrink([false, false]).show(ui, |ui| {
        // Room for the floating scroll bar.
        ui.set_max_width(ui.available_width() - 6.0);
        contents(ui);
        ui.add_space(12.0);
    });
}

fn head(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>, map: &JointMap, tab: &mut MotionTab, out: &mut Output) {
    header(ui, shown, pairing, map, out);
    ui.add_space(4.0);
    let parts = [(false, "Joints"), (true, "Options")];
    if let Some(options) = controls::segmented(ui, Some(tab.options), &parts) {
        tab.options = options;
    }
    ui.add_space(2.0);
    if !tab.options {
        clips::search_field(ui, &mut tab.search, "Search joints of the model");
        ui.add_space(2.0);
    }
}

fn body(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>, map: &JointMap, tab: &mut MotionTab, out: &mut Output) {
    if tab.options {
        options::show(ui, shown, pairing, map, out);
    } else {
        joints::show(ui, pairing, map, tab);
    }
}

fn header(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>, map: &JointMap, out: &mut Output) {
    let palette = style::palette(ui);
    let motions = shown.library.motions();
    if motions.len() > 1 {
        ui.add_space(4.0);
        let name = short_name(&pairing.motion.source);
        let combo =
            egui::ComboBox::from_id_salt("motion file").width(ui.available_width()).truncate().selected_text(name);
        let response = combo.show_ui(ui, |ui| {
            for (index, motion) in motions.iter().enumerate() {
                if ui.selectable_label(index == pairing.index, short_name(&motion.source)).clicked() {
                    out.commands.extend(first_clip_of(pairing.model, index));
                }
            }
        });
        response.response.accessible_name("Motion file");
    }
    let follow = map.joints.values().filter(|entry| entry.source.is_some()).count();
    let sources = pairing.motion.asset.skeleton.len();
    let text = match follow {
        0 => "No joint follows the motion yet.".to_owned(),
        1 => format!("1 joint follows one of {sources}."),
        _ => format!("{follow} joints follow the motion's {sources}."),
    };
    controls::hint(ui, text);
    for text in remarks(pairing) {
        ui.add(egui::Label::new(RichText::new(text).small().color(palette.warning)).wrap());
    }
    ui.add_space(4.0);
    let clip = active_clip(pairing.model, shown.state).filter(|&clip| pairing.model.borrowed(clip).is_some());
    let width = (ui.available_width() - 6.0) / 2.0;
    let button = |ui: &mut Ui, enabled: bool, text: &str, hover: &str| {
        let button = egui::Button::new(text).min_size(egui::vec2(width, 30.0));
        ui.add_enabled(enabled, button).on_hover_text(hover).clicked()
    };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        if button(ui, true, "Match anew", "Match the joints by names and shape, as at first") {
            out.commands.push(Command::SetMap { motion: pairing.index, map: None });
        }
        if button(ui, clip.is_some(), "Save GLB", "The model with this clip behind its own")
            && let Some(clip) = clip
        {
            out.actions.push(UiAction::Save(Saved::Model { clip }));
        }
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        if button(ui, true, "Load map", "A joint map in JSON") {
            out.actions.push(UiAction::ChooseMotion);
        }
        if button(ui, true, "Save map", "Which joint follows which, as JSON") {
            out.actions.push(UiAction::Save(Saved::Map { motion: pairing.index }));
        }
    });
}

fn first_clip_of(model: &Model, motion: usize) -> Option<Command> {
    let is_its = |&clip: &usize| model.borrowed(clip).is_some_and(|borrowed| borrowed.motion == motion);
    let clip = (model.asset.clips.len()..model.clip_count()).find(is_its)?;
    Some(Command::SetClip(choice_of_clip(model, clip)))
}

/// What a person should know about the two skeletons.
fn remarks(pairing: &Pairing<'_>) -> Vec<String> {
    const MOST: usize = 3;
    let mut remarks = Vec::new();
    let Some(proposal) = pairing.proposal else { return remarks };
    for (who, recognized) in [("model", &proposal.model), ("motion", &proposal.motion)] {
        let sides: Vec<&str> = recognized
            .contradictions
            .iter()
            .map(|contradiction| {
                let Contradiction::Side { name, .. } = contradiction;
                name.as_str()
            })
            .collect();
        if let Some((first, rest)) = sides.split_first() {
            let others = match rest.len() {
                0 => String::new(),
                1 => format!(" (so does {})", rest[0]),
                count => format!(" (so do {count} others)"),
            };
            remarks.push(format!(
                "In the {who}, {first} is named for one side and lies on the other{others}. Names were believed."
            ));
        }
    }
    remarks.truncate(MOST);
    remarks
}

/// A joint as lists show it: its number in the file and its name.
fn joint_text(asset: &Asset, joint: JointIndex) -> String {
    format!("{}  {}", asset.skeleton.source_index(joint), scene_tree::title(asset, joint))
}
