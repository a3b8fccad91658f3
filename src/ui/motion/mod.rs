//! The Motion tab: which joint follows which and why, how the motion is retargeted, and how the clip is edited.
//!
//! While it is open, nothing resolves, hashes or copies maps: its rows are rebuilt when the map changes, and a test checks
//! that more joints don't make a frame allocate more.

mod clicking;
mod detail;
mod figures;
mod joints;
mod namespace;
mod options;
mod picker;
mod rows;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::{Arc, LazyLock};

use egui::{RichText, Ui};
use gaitway_character::anim::{JointIndex, find_clip};
use gaitway_character::asset::Asset;
use gaitway_retarget::{ClipRef, Contradiction, FoundRest, JointMap, Proposal, Reason, Unmapped};
use gaitway_scene::library::{ClipId, Model, ModelClip, ModelId, Motion, MotionId};
use gaitway_scene::state::{ClipChoice, Command, MapEdit, ViewerState, title};

use self::rows::Row;
use super::icons::{Icon, icon_button_sized, icon_size};
use super::{HostState, Output, Shown, UiAction, UiState, change, clips, controls, layers, pins, style};
use crate::ui::text;

pub(super) use clicking::{banner, show as clicking, stop as stop_clicking};
pub(super) use namespace::namespace;
pub(super) use picker::show as picker;

/// The state of the tab.
#[derive(Debug, Default)]
pub struct MotionTab {
    part: Section,
    table: joints::TableView,
    /// The motion last shown, to stay on when its map is cleared and its clip is gone.
    motion: Option<MotionId>,
    /// The open list of sources.
    picking: Option<picker::Picking>,
    /// The joint being picked in the viewport.
    clicking: Option<clicking::Clicking>,
    typed: Option<detail::Typed>,
    turn: Option<detail::Turn>,
    contents: Option<(Inputs, Rc<Contents>)>,
    fit: Option<figures::Fit>,
}

/// What [`Contents`] are made from. The proposal follows from model and motion.
#[derive(Debug)]
struct Inputs {
    model: ModelId,
    motion: Arc<Asset>,
    /// Files of all motions.
    motions: Vec<Arc<Asset>>,
    map: Arc<JointMap>,
    names: BTreeMap<usize, String>,
}

/// What the tab shows of a model, a motion and their map, kept while they do not change.
#[derive(Debug)]
struct Contents {
    /// The joint table.
    rows: Vec<Row>,
    /// Rows that each filter of [`rows::Filter::ALL`] lets through, in words.
    filters: [String; rows::Filter::ALL.len()],
    /// See [`namespace()`].
    namespace: String,
    /// Names of all motions; empty if there is only one.
    motions: Vec<String>,
    mapped: String,
    remarks: Vec<String>,
    /// See [`sides_choice`].
    sides_choice: Option<&'static str>,
    /// See [`options::ignored_channels`].
    ignored_channels: Option<String>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
enum Section {
    #[default]
    Joints,
    Options,
    Clip,
    Figures,
    Files,
}

impl MotionTab {
    /// Whether a joint is being picked in the viewport.
    pub fn is_clicking(&self) -> bool {
        self.clicking.is_some()
    }

    /// Whether the list of sources is open, which takes keyboard input.
    pub fn is_picking(&self) -> bool {
        self.picking.is_some()
    }

    /// Shows the joint table; its first joint gets the focus if `takes_focus`.
    pub fn focus_table(&mut self, takes_focus: bool) {
        self.part = Section::Joints;
        self.table.takes_focus = takes_focus;
    }

    /// Cancels unfinished input, which is about a motion that may be gone.
    pub fn other_motions(&mut self) {
        (self.picking, self.clicking, self.typed, self.turn) = (None, None, None, None);
    }

    /// Returns the tab's contents, rebuilt when a file, the map or a custom joint name changes.
    fn contents(&mut self, shown: &Shown<'_>, pairing: &Pairing<'_>) -> Rc<Contents> {
        if let Some((inputs, contents)) = &self.contents
            && inputs.are_those_of(shown, pairing)
        {
            return contents.clone();
        }
        let contents = Rc::new(Contents::new(shown, pairing));
        self.contents = Some((Inputs::new(shown, pairing), contents.clone()));
        contents
    }
}

impl Inputs {
    fn new(shown: &Shown<'_>, pairing: &Pairing<'_>) -> Self {
        Self {
            model: pairing.model.id,
            motion: pairing.motion.asset.clone(),
            motions: shown.library.motions().iter().map(|motion| motion.asset.clone()).collect(),
            map: pairing.map.clone(),
            names: pairing.state.character.edits.names.clone(),
        }
    }

    fn are_those_of(&self, shown: &Shown<'_>, pairing: &Pairing<'_>) -> bool {
        let motions = shown.library.motions();
        self.model == pairing.model.id
            && Arc::ptr_eq(&self.motion, &pairing.motion.asset)
            && Arc::ptr_eq(&self.map, pairing.map)
            && self.motions.len() == motions.len()
            && self.motions.iter().zip(motions).all(|(kept, motion)| Arc::ptr_eq(kept, &motion.asset))
            && self.names == pairing.state.character.edits.names
    }
}

impl Contents {
    fn new(shown: &Shown<'_>, pairing: &Pairing<'_>) -> Self {
        let motions = shown.library.motions();
        let rows = rows::rows(pairing, pairing.map);
        let filters = rows::Filter::ALL.map(|(filter, name)| {
            let count = rows.iter().filter(|row| filter.lets_through(row)).count();
            text::counted(name, count)
        });
        let several = motions.len() > 1;
        let mapped = pairing.map.joints.values().filter(|entry| entry.source.is_some()).count();
        Self {
            rows,
            filters,
            namespace: namespace(&pairing.model.asset).to_owned(),
            motions: if several { clips::names_of(motions.iter().map(|motion| &*motion.source)) } else { Vec::new() },
            mapped: text::joints_mapped(mapped, pairing.motion.asset.skeleton.len()),
            remarks: remarks(pairing),
            sides_choice: sides_choice(pairing),
            ignored_channels: options::ignored_channels(pairing.map),
        }
    }
}

/// Stands for the map of a motion that has none.
static NO_MAP: LazyLock<Arc<JointMap>> = LazyLock::new(Arc::default);

/// A motion and the active model.
#[derive(Clone, Copy)]
struct Pairing<'a> {
    model: &'a Model,
    motion: &'a Motion,
    map: &'a Arc<JointMap>,
    proposal: Option<&'a Proposal>,
    /// For custom joint names.
    state: &'a ViewerState,
}

impl<'a> Pairing<'a> {
    /// The motion whose clip plays, else the one last shown, else the first.
    fn shown(shown: &Shown<'a>, before: Option<&MotionId>) -> Option<Self> {
        let playing = shown.clip().and_then(ModelClip::borrowed).map(|borrowed| &borrowed.motion);
        let first = || Self::of(shown, shown.library.motions().first()?.id());
        playing.or(before).and_then(|motion| Self::of(shown, motion)).or_else(first)
    }

    fn of(shown: &Shown<'a>, motion: &MotionId) -> Option<Self> {
        let library = shown.library;
        let (map, proposal) = (library.baked_map(motion).unwrap_or(&NO_MAP), library.proposal(motion));
        let (model, motion) = (library.active()?, library.motion(motion)?);
        Some(Self { model, motion, map, proposal, state: shown.state })
    }

    /// The identity of the motion.
    fn id(&self) -> MotionId {
        self.motion.id().clone()
    }

    /// Which of the model's own clips joints without a source play, and whether it is frozen; None if they rest.
    fn own_clip(&self, unmapped: &Unmapped) -> Option<(usize, bool)> {
        let Unmapped::Clip { clip, frozen } = unmapped else { return None };
        let missing = if let ClipRef::Index(index) = clip { *index } else { usize::MAX };
        Some((find_clip(self.model.asset.clips.iter(), clip.query()).unwrap_or(missing), *frozen))
    }

    /// The display name of a joint of the model.
    fn target_title(&self, joint: JointIndex) -> Cow<'a, str> {
        title(Some(self.state), &self.model.asset, joint)
    }

    fn clip_title(&self, clip: usize) -> &'a str {
        self.model.clip(&ClipId::Own(clip)).map_or("a clip that is not there", ModelClip::title)
    }

    /// A target's source. None if the map does not mention the target, `Some(None)` if it deliberately has none.
    fn source_in(&self, map: &JointMap, target: usize) -> Option<Option<JointIndex>> {
        let source = map.source_of(target)?;
        Some(source.and_then(|source| self.motion.asset.skeleton.joint_of_source(source)))
    }
}

/// In a panel lower than this the whole tab scrolls, otherwise only the part below its head.
const ROOMY_HEIGHT: f32 = 480.0;

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(pairing) = Pairing::shown(shown, local.motion.motion.as_ref()) else {
        return controls::scrolled(ui, ("motion", Section::Clip), |ui| {
            clip(ui, shown, out);
            ui.add_space(8.0);
            controls::hint(ui, text::WHAT_A_MOTION_ADDS);
        });
    };
    let map = pairing.map;
    local.motion.motion = Some(pairing.id());
    let part = local.motion.part;
    let contents = local.motion.contents(shown, &pairing);
    // Each part keeps its own scroll position.
    let place = ("motion", part);
    if ui.available_height() >= ROOMY_HEIGHT {
        head(ui, shown, &pairing, map, &contents, local, out);
        controls::scrolled(ui, place, |ui| body(ui, shown, &pairing, &contents, local, out));
    } else {
        controls::scrolled(ui, place, |ui| {
            head(ui, shown, &pairing, map, &contents, local, out);
            body(ui, shown, &pairing, &contents, local, out);
        });
    }
}

fn head(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    map: &JointMap,
    contents: &Contents,
    local: &mut UiState,
    out: &mut Output,
) {
    header(ui, shown, pairing, contents, out);
    ui.add_space(4.0);
    let parts = [
        (Section::Joints, text::JOINTS),
        (Section::Options, text::OPTIONS),
        (Section::Clip, text::CLIP),
        (Section::Figures, text::FIT),
        (Section::Files, text::FILES),
    ];
    if let Some(part) = controls::segmented(ui, text::MOTION_PART, Some(local.motion.part), &parts) {
        local.motion.part = part;
    }
    ui.add_space(2.0);
    if local.motion.part == Section::Joints {
        edits(ui, pairing, map, contents, local, out);
        clips::search_field(ui, &mut local.motion.table.search, text::SEARCH_JOINTS);
        joints::choices(ui, pairing, contents, &mut local.motion.table);
        ui.add_space(2.0);
    }
}

fn body(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    contents: &Rc<Contents>,
    local: &mut UiState,
    out: &mut Output,
) {
    let (map, tab) = (pairing.map, &mut local.motion);
    match tab.part {
        Section::Joints => controls::list(ui, controls::List::Table, text::JOINTS_AND_SOURCES, |ui| {
            joints::show(ui, shown, pairing, map, contents, tab, out);
        }),
        Section::Options => {
            if shown.clip().is_some_and(|clip| clip.borrowed().is_none()) {
                controls::hint(ui, text::OWN_CLIP_PLAYS);
            }
            options::show(ui, shown, pairing, map, contents, out);
        }
        Section::Clip => clip(ui, shown, out),
        Section::Figures => figures::show(ui, shown, pairing, contents, tab),
        Section::Files => options::files(ui, shown, pairing, out),
    }
}

/// Edits of the clip that plays, and what is laid over it.
fn clip(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    change::section(ui, shown, out);
    layers::section(ui, shown, out);
    pins::section(ui, shown, out);
}

/// Height of the buttons that edit the whole map.
const EDIT_BUTTON_HEIGHT: f32 = 30.0;

/// Returns whether the button was clicked.
fn button(ui: &mut Ui, width: f32, enabled: bool, text: &str, hover: &str) -> bool {
    let button = egui::Button::new(text).truncate();
    ui.add_enabled_ui(enabled, |ui| controls::sized(ui, [width, EDIT_BUTTON_HEIGHT], button))
        .inner
        .on_hover_text(hover)
        .clicked()
}

/// Undo and redo.
fn arrows(ui: &mut Ui, host: &HostState, out: &mut Output) {
    // Only for edits made in this tab: the step before them may be the motion itself.
    for (icon, label, enabled, action) in [
        (Icon::Undo, text::UNDO_KEY, host.can_undo_retargeting, UiAction::Undo),
        (Icon::Redo, text::REDO_KEY, host.can_redo_retargeting, UiAction::Redo),
    ] {
        let label = controls::with_key(ui, label);
        let pressed = ui.add_enabled_ui(enabled, |ui| icon_button_sized(ui, icon, label, EDIT_BUTTON_HEIGHT)).inner;
        if pressed.clicked() {
            out.actions.push(action);
        }
    }
}

/// Buttons that edit the whole map.
fn edits(
    ui: &mut Ui,
    pairing: &Pairing<'_>,
    map: &JointMap,
    contents: &Contents,
    local: &mut UiState,
    out: &mut Output,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let width = ui.available_width() - 2.0 * (icon_size(ui, EDIT_BUTTON_HEIGHT).x + 6.0);
        let clicking = local.motion.clicking.is_some();
        let (text, hover) = if clicking {
            (text::STOP_PICKING, "Leave the viewport alone again")
        } else {
            (text::PICK_IN_VIEWPORT, "Click a joint of the model, then its source")
        };
        if button(ui, width, true, text, hover) {
            local.motion.clicking = (!clicking).then_some(clicking::Clicking::Target { motion: pairing.id() });
            // On a small screen the sheet makes room for the viewport.
            local.layout.sheet = None;
        }
        arrows(ui, &local.host, out);
    });
    let motion = || pairing.id();
    let any = map.joints.values().any(|entry| entry.source.is_some());
    let swap = |ui: &mut Ui, width: f32, label: &str, out: &mut Output| {
        if button(ui, width, any, label, "Map left joints to right ones and vice versa") {
            out.commands.push(Command::EditMap { motion: motion(), edit: MapEdit::SwapSides });
        }
    };
    // Says what it does, which takes a row, where position and names disagree.
    if let Some(label) = contents.sides_choice {
        let width = ui.available_width();
        swap(ui, width, label, out);
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        // Fits three labels side by side in the narrowest panel.
        ui.spacing_mut().button_padding.x = 4.0;
        let count = if contents.sides_choice.is_some() { 2.0 } else { 3.0 };
        let width = (ui.available_width() - 6.0 * (count - 1.0)) / count;
        if button(ui, width, true, text::REMATCH, "Return to the proposed map") {
            out.commands.push(Command::SetMap { motion: motion(), map: None });
        }
        if contents.sides_choice.is_none() {
            swap(ui, width, text::SWAP_SIDES, out);
        }
        if button(ui, width, any, text::CLEAR_MAP, "Leave all joints unmapped") {
            out.commands.push(Command::EditMap { motion: motion(), edit: MapEdit::Clear });
        }
    });
}

fn header(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>, contents: &Contents, out: &mut Output) {
    let palette = style::palette(ui);
    let motions = || shown.library.motions().iter().map(Motion::id).zip(&contents.motions);
    if let Some((_, name)) = motions().find(|(motion, _)| *motion == pairing.motion.id()) {
        ui.add_space(4.0);
        controls::chooser(ui, "motion file", text::MOTION_FILE, name, |ui| {
            for (motion, name) in motions() {
                if controls::option(ui, motion == pairing.motion.id(), name) {
                    out.commands.extend(first_clip_of(pairing.model, motion));
                }
            }
        });
    }
    controls::hint(ui, &contents.mapped);
    for text in &contents.remarks {
        ui.add(egui::Label::new(RichText::new(text).small().color(palette.warning)).wrap());
    }
}

fn first_clip_of(model: &Model, motion: &MotionId) -> Option<Command> {
    let (clip, _) = model.clips().borrowed().find(|(_, borrowed)| borrowed.motion == *motion)?;
    Some(Command::SetClip(ClipChoice::Clip(clip.id().clone())))
}

/// Whether most left and right joints are mapped to the side opposite to the proposal.
fn follows_names(pairing: &Pairing<'_>, proposal: &Proposal) -> bool {
    let number = |joint| pairing.motion.asset.skeleton.source_index(joint);
    let mut crossing = 0_i32;
    for pair in &proposal.pairs {
        let is_sided = pair.slot.is_some_and(|slot| slot.mirrored() != slot);
        let target = pairing.model.asset.skeleton.source_index(pair.target);
        let source = pairing.map.joints.get(&target).and_then(|entry| entry.source);
        if let Some(source) = source.filter(|_| is_sided) {
            crossing += if source == number(pair.source) { -1 } else { 1 };
        }
    }
    crossing > 0
}

/// What swapping sides does if position overrode the names of exactly one file: switch between matching sides by position and
/// by name.
fn sides_choice(pairing: &Pairing<'_>) -> Option<&'static str> {
    let proposal = pairing.proposal?;
    let is_by_position = proposal.model.by_position != proposal.motion.by_position
        && proposal.pairs.iter().any(|pair| pair.slot.is_some() && pair.reason != Reason::SameName);
    let label =
        if follows_names(pairing, proposal) { text::MATCH_SIDES_BY_POSITION } else { text::MATCH_SIDES_BY_NAME };
    is_by_position.then_some(label)
}

/// Warnings about the two skeletons.
fn remarks(pairing: &Pairing<'_>) -> Vec<String> {
    const MAX_REMARKS: usize = 4;
    let mut remarks = Vec::new();
    let borrowed = pairing.model.clips().borrowed().filter(|(_, borrowed)| borrowed.motion == *pairing.motion.id());
    let rests: Vec<FoundRest> = borrowed.map(|(_, borrowed)| borrowed.motion_rest).collect();
    if rests.iter().any(FoundRest::is_doubtful) {
        remarks.push(text::DOUBTFUL_REST.to_owned());
    }
    if rests.iter().any(|rest| rest.is_up_doubtful) {
        remarks.push(text::DOUBTFUL_UP.to_owned());
    }
    let Some(proposal) = pairing.proposal else { return remarks };
    let is_swapped = follows_names(pairing, proposal);
    for (who, recognized) in [("model", &proposal.model), ("motion", &proposal.motion)] {
        if let Some(Contradiction::Side { name, .. }) = recognized.contradictions.first() {
            let by_position = recognized.by_position && !is_swapped;
            remarks.push(text::sides_contradict(who, name, recognized.contradictions.len(), by_position));
        }
        if !recognized.left_out.is_empty() {
            remarks.push(text::joints_left_out(who, recognized.left_out.len()));
        }
    }
    remarks.truncate(MAX_REMARKS);
    remarks
}

/// A joint as shown in lists: its number in the file and its name.
fn joint_text(asset: &Asset, joint: JointIndex) -> String {
    text::joint(asset.skeleton.source_index(joint), &title(None, asset, joint))
}
