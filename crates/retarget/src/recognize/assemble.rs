//! Assembles a body from joints with known words: limbs first, then the hips where legs and spine meet, then what lies
//! between. Words say what a joint may be; the hierarchy decides between candidates.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Side;
use gaitway_character::asset::Slot::{self, *};

use super::known::{self, Known};
use super::limb_words::{ARM, Fits, LEG, Parts, SURE_FIT, align};
use super::names::is_number;
use super::tree::Tree;
use super::words::{self, Word};
use super::{Reason, RecognizedJoint};

/// Confidence by reason.
const VOCABULARY_CONFIDENCE: f32 = 0.95;
const WORDS_CONFIDENCE: f32 = 0.8;
const HIERARCHY_CONFIDENCE: f32 = 0.6;

/// Maximum number of heads, and of joints of a limb, to search; a crowd is not a body.
const MAX_HEADS: usize = 64;
const MAX_LIMB_JOINTS: usize = 64;

/// Factor on the fit of a joint that moves no skin, while others do: control rigs have a copy of each limb.
const STILL_FACTOR: f32 = 0.5;

/// The joints of one leg or arm; `extra` is its toes or its collar bone.
#[derive(Debug, Default, Clone, Copy)]
struct Limb {
    extra: Option<JointIndex>,
    upper: Option<JointIndex>,
    lower: Option<JointIndex>,
    end: Option<JointIndex>,
}

pub(super) fn find(tree: &Tree, known: Option<&Known>) -> BTreeMap<Slot, RecognizedJoint> {
    let mut search = Search { tree, known, words: Vec::new(), parts: BTreeMap::new() };
    search.words = tree.skeleton.joints().map(|joint| search.read(joint)).collect();
    search.run();
    search.parts
}

struct Search<'a> {
    tree: &'a Tree<'a>,
    known: Option<&'a Known>,
    /// Word and side of each joint.
    words: Vec<Option<(Word, Option<Side>)>>,
    parts: BTreeMap<Slot, RecognizedJoint>,
}

impl Search<'_> {
    /// A vocabulary wins over single words.
    fn read(&self, joint: JointIndex) -> Option<(Word, Option<Side>)> {
        match self.known.and_then(|known| known.slots.get(&joint)) {
            Some(&slot) => Some((known::word_of(slot), slot.side())),
            None => self.tree.word(joint).map(|word| (word, self.tree.names[joint.get()].side)),
        }
    }

    fn run(&mut self) {
        let legs = [Side::Left, Side::Right].map(|side| self.leg(side));
        let arms = [Side::Left, Side::Right].map(|side| self.arm(side));
        let meeting = |limbs: &[Limb; 2]| self.tree.meeting(limbs[0].upper?, limbs[1].upper?);
        let (pelvis, shoulders) = (meeting(&legs), meeting(&arms));
        let head = self.head(pelvis, shoulders);
        let hips = self.hips(pelvis, head.or(shoulders));
        if let Some(hips) = hips {
            self.put(Hips, hips, if Some(hips) == pelvis { Reason::Words } else { Reason::Hierarchy });
            self.trunk(hips, head, shoulders);
        }
        if let Some(head) = head {
            self.put(Head, head, Reason::Words);
            self.face(head);
        }
        for (side, leg) in [Side::Left, Side::Right].into_iter().zip(legs) {
            let slots = [LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes];
            self.put_limb(side, slots, [leg.upper, leg.lower, leg.end, leg.extra]);
        }
        for (side, arm) in [Side::Left, Side::Right].into_iter().zip(arms) {
            let slots = [LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand];
            self.put_limb(side, slots, [arm.extra, arm.upper, arm.lower, arm.end]);
            if let Some(hand) = arm.end.or(arm.lower) {
                self.fingers(side, hand);
            }
        }
    }

    /// In the skeleton's order, so that descendants come after their ancestors.
    fn all(&self, side: Option<Side>, word: Word) -> Vec<JointIndex> {
        self.tree.skeleton.joints().filter(|joint| self.words[joint.get()] == Some((word, side))).collect()
    }

    fn under(&self, joints: &[JointIndex], above: JointIndex) -> Option<JointIndex> {
        joints.iter().copied().find(|&joint| joint != above && self.tree.is_under(joint, above))
    }

    /// Aligns the joints of a side with the parts of a limb.
    fn limb(&self, side: Side, parts: &Parts) -> [Option<JointIndex>; 4] {
        let fits = self.tree.skeleton.joints().map(|joint| (joint, self.fits(joint, side, parts)));
        let candidates = fits.filter(|(_, fits)| fits.iter().any(|&fit| fit > 0.0)).take(MAX_LIMB_JOINTS);
        align(self.tree, parts, &candidates.collect::<Vec<_>>())
    }

    /// How well a joint fits the parts of a limb, by what the vocabulary says and by the words of its name.
    fn fits(&self, joint: JointIndex, side: Side, parts: &Parts) -> Fits {
        let known = self.known.and_then(|known| known.slots.get(&joint)).filter(|slot| slot.side() == Some(side));
        let word = self.tree.word(joint).filter(|_| self.tree.names[joint.get()].side == Some(side));
        let mut fits = word.map_or([0.0; 4], |word| parts.fits(word));
        if let Some(&slot) = known {
            // It means one part of the limb, not all that the word may mean elsewhere.
            for (fit, meant) in fits.iter_mut().zip(parts.fits(known::word_of(slot))) {
                *fit = if meant == SURE_FIT { SURE_FIT } else { *fit };
            }
        }
        let factor = if self.tree.moves_skin(joint) == Some(false) { STILL_FACTOR } else { 1.0 };
        fits.map(|fit| factor * fit)
    }

    /// Of the joints between two parts of a limb whose names say nothing, the one that divides it most evenly.
    fn unnamed_between(&self, upper: JointIndex, end: JointIndex) -> Option<JointIndex> {
        let distance = |a: JointIndex, b: JointIndex| self.tree.position(a).distance(self.tree.position(b));
        let unevenness = |joint: &JointIndex| (distance(upper, *joint) / distance(*joint, end)).ln().abs();
        let between =
            self.tree.path(upper, end).into_iter().filter(|&joint| joint != end && self.words[joint.get()].is_none());
        between.min_by(|a, b| unevenness(a).total_cmp(&unevenness(b)))
    }

    fn leg(&self, side: Side) -> Limb {
        let [upper, named_lower, foot, toes] = self.limb(side, &LEG);
        let lower = named_lower.or_else(|| self.unnamed_between(upper?, foot?));
        // In many game rigs, feet follow a control and are not descendants of the leg.
        let feet = self.all(Some(side), Word::Foot);
        let end = foot.or_else(|| lower.and(feet.first().copied()));
        let extra = toes.or_else(|| {
            let foot = end?;
            self.under(&self.all(Some(side), Word::Toes), foot).or_else(|| self.under(&feet, foot))
        });
        Limb { extra, upper, lower, end }
    }

    fn arm(&self, side: Side) -> Limb {
        let [extra, upper, named_lower, hand] = self.limb(side, &ARM);
        let lower = named_lower.or_else(|| self.unnamed_between(upper?, hand?));
        let end = hand.or_else(|| self.tip_below(lower?));
        Limb { extra, upper, lower, end }
    }

    /// The only joint that could be the hand of a forearm, if its name doesn't say what it is, or only that it is an end.
    fn tip_below(&self, forearm: JointIndex) -> Option<JointIndex> {
        let could_be = |joint: &JointIndex| {
            let word = self.words[joint.get()];
            (word.is_none() || words::is_end(&self.tree.names[joint.get()]))
                && self.tree.moves_skin(*joint) != Some(false)
        };
        let mut found = self.tree.children(forearm).iter().copied().filter(could_be);
        found.next().filter(|_| found.next().is_none())
    }

    /// The head nearest to the body: controls are often called head as well.
    fn head(&self, pelvis: Option<JointIndex>, shoulders: Option<JointIndex>) -> Option<JointIndex> {
        let heads = self.all(None, Word::Head);
        let Some(body) = shoulders.or(pelvis) else { return heads.first().copied() };
        let mut best: Option<(usize, JointIndex)> = None;
        for head in heads.into_iter().take(MAX_HEADS) {
            let Some(meeting) = self.tree.meeting(head, body) else { continue };
            let depth = self.tree.upwards(meeting).count();
            if best.is_none_or(|(other, _)| depth > other) {
                best = Some((depth, head));
            }
        }
        best.map(|(_, head)| head).or_else(|| {
            let neck = self.all(None, Word::Neck).last().copied()?;
            self.tree.children(neck).first().copied()
        })
    }

    /// Where legs and spine meet; a pelvis beside the spine moves only the legs.
    fn hips(&self, pelvis: Option<JointIndex>, top: Option<JointIndex>) -> Option<JointIndex> {
        let named = self.all(None, Word::Pelvis);
        let Some(pelvis) = pelvis else {
            return named.into_iter().find(|&joint| top.is_none_or(|top| self.tree.is_under(top, joint)));
        };
        let Some(top) = top else { return Some(pelvis) };
        let meeting = self.tree.meeting(pelvis, top)?;
        let is_container = self.tree.skeleton.parent(meeting).is_none() && self.words[meeting.get()].is_none();
        if is_container {
            return named.into_iter().find(|&joint| self.tree.is_under(top, joint)).or(Some(meeting));
        }
        Some(meeting)
    }

    /// Spine, chest and neck: the joints between hips and head.
    fn trunk(&mut self, hips: JointIndex, head: Option<JointIndex>, shoulders: Option<JointIndex>) {
        let Some(top) = head.or(shoulders) else { return };
        let mut path = self.tree.path(hips, top);
        if head.is_some() {
            path.pop();
        }
        let word = |joint: JointIndex| self.words[joint.get()].map(|(word, _)| word);
        let shoulders_at = shoulders.and_then(|shoulders| path.iter().position(|&joint| joint == shoulders));
        // What the arms hang on is a neck only if nothing above it is: some vocabularies count the spine up to the head.
        let is_neck =
            |&joint: &JointIndex| word(joint) == Some(Word::Neck) || self.tree.word(joint) == Some(Word::Neck);
        let above_shoulders = shoulders_at.and_then(|at| Some(at + 1 + path.get(at + 1..)?.iter().position(is_neck)?));
        let named_neck = above_shoulders.or_else(|| path.iter().position(is_neck));
        let chest_end = named_neck.into_iter().chain(shoulders_at.map(|at| at + 1)).min().unwrap_or(path.len());
        let neck = match named_neck {
            Some(at) => Some((path[at], Reason::Words)),
            None if head.is_some() && shoulders_at.is_some() => path
                .get(chest_end..)
                .and_then(|above| above.iter().rev().find(|&&joint| word(joint) != Some(Word::Aside)))
                .map(|&joint| (joint, Reason::Hierarchy)),
            None => None,
        };
        let path = path.get(..chest_end).unwrap_or_default();
        let mut torso: Vec<JointIndex> = path
            .iter()
            .copied()
            .filter(|&joint| [word(joint), self.tree.word(joint)].contains(&Some(Word::Torso)))
            .collect();
        let reason = if torso.is_empty() { Reason::Hierarchy } else { Reason::Words };
        if torso.is_empty() {
            torso = path.iter().copied().filter(|&joint| word(joint).is_none()).collect();
        }
        for (slot, joint) in spread(&torso) {
            self.put(slot, joint, reason);
        }
        if let Some((neck, reason)) = neck {
            self.put(Neck, neck, reason);
        }
    }

    fn face(&mut self, head: JointIndex) {
        for (slot, side, word) in
            [(LeftEye, Some(Side::Left), Word::Eye), (RightEye, Some(Side::Right), Word::Eye), (Jaw, None, Word::Jaw)]
        {
            if let Some(joint) = self.under(&self.all(side, word), head) {
                self.put(slot, joint, Reason::Words);
            }
        }
    }

    /// Each finger from the palm outwards, as far as there are slots; the joints after that are tips.
    fn fingers(&mut self, side: Side, hand: JointIndex) {
        for finger in 0..5_u8 {
            let mut above = hand;
            let mut joints = self.all(Some(side), Word::Finger(finger));
            if finger > 0 && self.begins_in_palm(&joints, hand) {
                joints.remove(0);
            }
            for slot in known::finger_slots(finger, side) {
                let Some(joint) = self.under(&joints, above) else { break };
                self.put(slot, joint, Reason::Words);
                above = joint;
            }
        }
    }

    /// Whether the first joint of a finger lies in the palm: it begins near the wrist, is longer than what follows, and has no number,
    /// unlike the first phalanx below it.
    fn begins_in_palm(&self, joints: &[JointIndex], hand: JointIndex) -> bool {
        let [palm, first, second, _, ..] = *joints else { return false };
        let numbers =
            [palm, first].map(|joint| self.tree.names[joint.get()].words.iter().rfind(|word| is_number(word)));
        let is_named =
            matches!(numbers, [None, Some(number)] if number.trim_start_matches('0') == "1" && number.len() < 3);
        let distance = |a: JointIndex, b: JointIndex| self.tree.position(a).distance(self.tree.position(b));
        let inner = distance(palm, first);
        let is_chain = joints.windows(2).all(|pair| self.tree.is_under(pair[1], pair[0]));
        is_chain && is_named && inner > distance(first, second) && distance(hand, palm) < inner
    }

    fn put_limb(&mut self, side: Side, slots: [Slot; 4], joints: [Option<JointIndex>; 4]) {
        for (slot, joint) in slots.into_iter().zip(joints) {
            if let Some(joint) = joint {
                let slot = if side == Side::Right { slot.mirrored() } else { slot };
                self.put(slot, joint, Reason::Words);
            }
        }
    }

    fn put(&mut self, slot: Slot, joint: JointIndex, reason: Reason) {
        if self.parts.values().any(|part| part.joint == joint) {
            return;
        }
        let known = self.known.filter(|known| known.slots.get(&joint) == Some(&slot));
        let word = self.words[joint.get()].is_some();
        let (reason, confidence) = match known {
            Some(known) => (Reason::Vocabulary(known.vocabulary), VOCABULARY_CONFIDENCE),
            None if reason == Reason::Words && word => (Reason::Words, WORDS_CONFIDENCE),
            None => (Reason::Hierarchy, HIERARCHY_CONFIDENCE),
        };
        self.parts.insert(slot, RecognizedJoint { joint, reason, confidence });
    }
}

/// Spreads the joints between hips and neck over the three slots of the trunk: lowest, middle, highest.
pub(super) fn spread(torso: &[JointIndex]) -> Vec<(Slot, JointIndex)> {
    match *torso {
        [] => Vec::new(),
        [spine] => vec![(Spine, spine)],
        [spine, chest] => vec![(Spine, spine), (Chest, chest)],
        [spine, .., upper] => vec![(Spine, spine), (Chest, torso[(torso.len() - 1) / 2]), (UpperChest, upper)],
    }
}
