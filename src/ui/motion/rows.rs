//! Contents of the joint table: each joint's source, how certain it is, and the section that the joint is in.
//! Independent of drawing.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Asset, Side, Slot};
use gaitway_character::sort::collect_map;
use gaitway_retarget::{BodyPart, Contradiction, JointMap, Recognized, Unmapped};
use gaitway_scene::state::muted_properties;

use super::namespace::namespace;
use super::{Pairing, joint_text};
use crate::ui::text;

/// Below this confidence a proposal counts as a guess.
const UNSURE: f32 = 0.6;

#[derive(Debug)]
pub(super) struct Row {
    pub joint: JointIndex,
    /// The joint's number in its file.
    pub number: usize,
    pub target: String,
    /// Its humanoid slot in words; empty if it has none.
    pub what: String,
    pub source: Option<JointIndex>,
    /// The source's number and name, or “none”.
    pub source_text: String,
    /// That without the motion's [`namespace`].
    pub short_source: String,
    pub state: State,
    /// The joint's slot, why it has its source, and what contradicts it.
    pub why: String,
    /// All of that in a sentence, for tooltips and screen readers.
    pub follows: String,
    /// Needs review: something contradicts it and the user has not set it.
    pub needs_review: bool,
    pub section: TableSection,
    /// Number of its ancestors in the table.
    pub depth: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    Sure,
    Guess,
    /// Something contradicts it.
    Conflict,
    /// Has no source.
    None,
    /// Some channels of its source are muted.
    Muted,
}

impl State {
    pub fn word(self) -> &'static str {
        match self {
            Self::Sure => text::IS_SURE,
            Self::Guess => text::IS_GUESS,
            Self::Conflict => text::IS_CONFLICT,
            Self::None => text::NO_SOURCE,
            Self::Muted => "muted",
        }
    }
}

/// Which rows are shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Filter {
    #[default]
    All,
    NeedsReview,
    Of(State),
}

impl Filter {
    pub const ALL: [(Self, &str); 7] = [
        (Self::All, text::ALL_JOINTS),
        (Self::NeedsReview, text::NEEDS_REVIEW),
        (Self::Of(State::Sure), "Sure"),
        (Self::Of(State::Guess), "Guesses"),
        (Self::Of(State::Conflict), text::CONFLICTS),
        (Self::Of(State::None), text::UNMAPPED),
        (Self::Of(State::Muted), text::MUTED),
    ];

    pub fn lets_through(self, row: &Row) -> bool {
        match self {
            Self::All => true,
            Self::NeedsReview => row.needs_review,
            Self::Of(state) => row.state == state,
        }
    }
}

/// A section of the table when it is ordered by body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum TableSection {
    Trunk,
    LeftArm,
    LeftFingers,
    RightArm,
    RightFingers,
    LeftLeg,
    RightLeg,
    Other,
}

impl TableSection {
    pub const ALL: [Self; 8] = [
        Self::Trunk,
        Self::LeftArm,
        Self::LeftFingers,
        Self::RightArm,
        Self::RightFingers,
        Self::LeftLeg,
        Self::RightLeg,
        Self::Other,
    ];

    pub fn title(self) -> &'static str {
        match self {
            Self::Trunk => "Trunk and head",
            Self::LeftArm => text::LEFT_ARM,
            Self::LeftFingers => "Left fingers",
            Self::RightArm => text::RIGHT_ARM,
            Self::RightFingers => "Right fingers",
            Self::LeftLeg => "Left leg",
            Self::RightLeg => "Right leg",
            Self::Other => "Other joints",
        }
    }

    fn of(slot: Slot) -> Self {
        match (BodyPart::of(slot), slot.is_finger()) {
            (BodyPart::Hips | BodyPart::Torso | BodyPart::Head, _) => Self::Trunk,
            (BodyPart::LeftArm, false) => Self::LeftArm,
            (BodyPart::LeftArm, true) => Self::LeftFingers,
            (BodyPart::RightArm, false) => Self::RightArm,
            (BodyPart::RightArm, true) => Self::RightFingers,
            (BodyPart::LeftLeg, _) => Self::LeftLeg,
            (BodyPart::RightLeg, _) => Self::RightLeg,
        }
    }
}

/// Returns the relevant joints in the order of the skeleton: those the map mentions and those of skins (all joints if there
/// is no skin).
pub(super) fn rows(pairing: &Pairing<'_>, map: &JointMap) -> Vec<Row> {
    let asset = &pairing.model.asset;
    let skeleton = &asset.skeleton;
    let mut in_skin = vec![false; skeleton.len()];
    for joint in asset.skins.iter().flat_map(|skin| skin.joints()) {
        in_skin[joint.get()] = true;
    }
    let has_skins = !asset.skins.is_empty();
    let given: Vec<Option<Option<JointIndex>>> =
        skeleton.joints().map(|joint| pairing.source_in(map, skeleton.source_index(joint))).collect();
    let whole = PairFacts::new(pairing, &given);
    // By joint; a joint without a slot belongs to the section of its parent.
    let mut sections: Vec<TableSection> = Vec::with_capacity(skeleton.len());
    let mut depths: Vec<usize> = Vec::with_capacity(skeleton.len());
    let mut rows = Vec::new();
    for joint in skeleton.joints() {
        let given = given[joint.get()];
        let matters = given.is_some() || !has_skins || in_skin[joint.get()];
        let parent = skeleton.parent(joint);
        let slot = whole.target_slots.get(&joint).copied();
        let above = parent.map_or(TableSection::Other, |parent| sections[parent.get()]);
        sections.push(slot.map_or(above, TableSection::of));
        let depth = parent.map_or(0, |parent| depths[parent.get()]);
        depths.push(depth + usize::from(matters));
        if matters {
            let mut row = whole.row(pairing, map, joint, slot, given);
            (row.section, row.depth) = (sections[joint.get()], depth);
            rows.push(row);
        }
    }
    rows
}

/// Facts that involve all pairs.
struct PairFacts<'a> {
    target_slots: BTreeMap<JointIndex, Slot>,
    source_slots: BTreeMap<JointIndex, Slot>,
    /// Joints named for one side but placed on the other.
    misplaced_targets: Vec<JointIndex>,
    misplaced_sources: Vec<JointIndex>,
    /// Targets by the source they follow.
    followers: BTreeMap<JointIndex, Vec<JointIndex>>,
    /// Most joints follow the other side: the sides were swapped on purpose.
    swapped: bool,
    /// That of the motion.
    namespace: &'a str,
}

impl<'a> PairFacts<'a> {
    fn new(pairing: &Pairing<'a>, given: &[Option<Option<JointIndex>>]) -> Self {
        // Where position decided, the slots are on the sides where the joints lie.
        let misplaced = |recognized: &Recognized| -> Vec<JointIndex> {
            let joint = |contradiction: &Contradiction| {
                let Contradiction::Side { joint, .. } = contradiction;
                *joint
            };
            recognized.contradictions.iter().filter(|_| !recognized.by_position).map(joint).collect()
        };
        let mut whole = Self {
            target_slots: BTreeMap::new(),
            source_slots: BTreeMap::new(),
            misplaced_targets: Vec::new(),
            misplaced_sources: Vec::new(),
            followers: BTreeMap::new(),
            swapped: false,
            namespace: namespace(&pairing.motion.asset),
        };
        if let Some(proposal) = pairing.proposal {
            let slots = |parts: &BTreeMap<Slot, gaitway_retarget::RecognizedJoint>| {
                collect_map(parts.iter().map(|(&slot, part)| (part.joint, slot)))
            };
            whole.target_slots = slots(&proposal.model.parts);
            whole.source_slots = slots(&proposal.motion.parts);
            whole.misplaced_targets = misplaced(&proposal.model);
            whole.misplaced_sources = misplaced(&proposal.motion);
        }
        let mut crossing = 0_i32;
        for (target, source) in pairing.model.asset.skeleton.joints().zip(given) {
            let Some(source) = source.flatten() else { continue };
            whole.followers.entry(source).or_default().push(target);
            if let Some((target, source)) = whole.sides(target, source) {
                crossing += if target == source { -1 } else { 1 };
            }
        }
        whole.swapped = crossing > 0;
        whole
    }

    fn sides(&self, target: JointIndex, source: JointIndex) -> Option<(Side, Side)> {
        let of = |slots: &BTreeMap<JointIndex, Slot>, joint| slots.get(&joint).copied().and_then(Slot::side);
        Some((of(&self.target_slots, target)?, of(&self.source_slots, source)?))
    }

    /// Describes what contradicts a pair.
    fn conflict(&self, pairing: &Pairing<'_>, target: JointIndex, source: JointIndex) -> Option<String> {
        let misplaced = [self.misplaced_targets.contains(&target), self.misplaced_sources.contains(&source)];
        if let Some((target_side, source_side)) = self.sides(target, source) {
            let lies = |side: Side, misplaced| if misplaced { side.other() } else { side };
            if misplaced != [false; 2] {
                if lies(target_side, misplaced[0]) != lies(source_side, misplaced[1]) {
                    return Some("named for one side, lies on the other".to_owned());
                }
            } else if (target_side != source_side) != self.swapped {
                return Some("sides differ".to_owned());
            }
        }
        let mut others = self.followers.get(&source).into_iter().flatten().filter(|&&other| other != target);
        let first = others.next()?;
        let more = others.count();
        let and = if more == 0 { String::new() } else { format!(" and {more} more") };
        Some(format!("shared with {}{and}", pairing.target_title(*first)))
    }

    /// Whether the motion has this slot and nothing follows it.
    fn has_free_source(&self, slot: Option<Slot>) -> bool {
        self.source_slots.iter().any(|(source, other)| Some(*other) == slot && !self.followers.contains_key(source))
    }

    /// Returns the state of a pair and whether it needs review, and adds the reasons to `why`.
    fn mapped_state(
        &self,
        pairing: &Pairing<'_>,
        map: &JointMap,
        (target, source): (JointIndex, JointIndex),
        is_unsure: bool,
        why: &mut Vec<String>,
    ) -> (State, bool) {
        let number = |asset: &Asset, joint| asset.skeleton.source_index(joint);
        let conflict = self.conflict(pairing, target, source);
        let muted = muted_text(muted_properties(map, number(&pairing.motion.asset, source)));
        let standing = match (&conflict, &muted) {
            (Some(_), _) => (State::Conflict, true),
            (None, Some(_)) => (State::Muted, false),
            (None, None) if is_unsure => (State::Guess, true),
            (None, None) => (State::Sure, false),
        };
        let entry = map.joints.get(&number(&pairing.model.asset, target));
        let is_turned = entry.is_some_and(|entry| entry.correction != glam::Quat::IDENTITY);
        why.extend(conflict);
        why.extend(muted);
        why.extend(is_turned.then(|| text::HAS_OFFSET.to_owned()));
        standing
    }

    fn row(
        &self,
        pairing: &Pairing<'_>,
        map: &JointMap,
        joint: JointIndex,
        slot: Option<Slot>,
        given: Option<Option<JointIndex>>,
    ) -> Row {
        let number = pairing.model.asset.skeleton.source_index(joint);
        let pairs = pairing.proposal.map(|proposal| proposal.pairs.as_slice()).unwrap_or_default();
        let proposed = pairs.binary_search_by_key(&joint, |pair| pair.target).ok().map(|at| &pairs[at]);
        let source = given.flatten();
        let as_proposed = proposed.filter(|pair| Some(pair.source) == source);
        let slot = slot.or_else(|| proposed.and_then(|pair| pair.slot));
        let what = slot.map(slot_text).unwrap_or_default();
        let mut why: Vec<String> = slot.map(|_| what.clone()).into_iter().collect();
        let left_out = pairing.proposal.and_then(|proposal| left_out(&proposal.model, joint));
        why.push(match (source, given, as_proposed) {
            (_, _, Some(pair)) => format!("{} · {}", pair.reason, text::percent(f64::from(pair.confidence))),
            (Some(_), _, None) => "chosen manually".to_owned(),
            (None, Some(None), None) => text::DELIBERATELY_NONE.to_owned(),
            (None, None, None) if left_out.is_some() => {
                let what = left_out.map(slot_text).unwrap_or_default();
                format!("probably the {what}, but too uncertain to map")
            }
            _ => "unmapped".to_owned(),
        });
        let (state, needs_review) = match source {
            None => {
                let own = map.joints.get(&number).and_then(|entry| entry.unmapped.as_ref());
                why.extend(unmapped_text(pairing, own.unwrap_or(&map.unmapped)));
                (State::None, given.is_none() && self.has_free_source(slot.or(left_out)))
            }
            Some(source) => {
                let is_unsure = as_proposed.is_some_and(|pair| pair.confidence < UNSURE);
                self.mapped_state(pairing, map, (joint, source), is_unsure, &mut why)
            }
        };
        let target = pairing.target_title(joint).into_owned();
        let source_text =
            source.map_or_else(|| text::NO_SOURCE.to_owned(), |source| joint_text(&pairing.motion.asset, source));
        let short_source = source_text.replacen(self.namespace, "", 1);
        let why = why.join(" · ");
        Row {
            joint,
            number,
            follows: text::labelled(&text::row(&target, &source_text, state.word()), &why),
            target,
            what,
            source,
            source_text,
            short_source,
            state,
            why,
            needs_review,
            section: TableSection::Other,
            depth: 0,
        }
    }
}

/// The slot that a joint was too uncertain to fill.
fn left_out(recognized: &Recognized, joint: JointIndex) -> Option<Slot> {
    recognized.left_out.iter().find(|(_, part)| part.joint == joint).map(|(&slot, _)| slot)
}

/// What a joint without a source plays instead of resting.
fn unmapped_text(pairing: &Pairing<'_>, unmapped: &Unmapped) -> Option<String> {
    let (clip, is_frozen) = pairing.own_clip(unmapped)?;
    let title = pairing.clip_title(clip);
    Some(if is_frozen { text::holds_first_key(title) } else { format!("plays {title}") })
}

fn muted_text(muted: [bool; 3]) -> Option<String> {
    let muted: Vec<&str> =
        text::CHANNELS.into_iter().zip(muted).filter(|(_, muted)| *muted).map(|(name, _)| name).collect();
    match muted.len() {
        0 => None,
        3 => Some("all channels ignored".to_owned()),
        _ => Some(text::ignored(&muted.join(" and "))),
    }
}

/// `leftUpperArm` as “left upper arm”.
fn slot_text(slot: Slot) -> String {
    let mut text = String::new();
    for letter in slot.name().chars() {
        if letter.is_uppercase() {
            text.push(' ');
        }
        text.extend(letter.to_lowercase());
    }
    text
}
