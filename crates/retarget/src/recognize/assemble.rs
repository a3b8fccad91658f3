//! Assembles a body from joints with known words: limbs first, then the hips where legs and spine meet, then what lies
//! between. Words say what a joint may be; the hierarchy decides between candidates.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Side;
use gaitway_character::asset::Slot::{self, *};

use super::known::{self, Known};
use super::tree::Tree;
use super::words::Word;
use super::{Reason, RecognizedJoint};

/// Confidence by reason.
const VOCABULARY_CONFIDENCE: f32 = 0.95;
const WORDS_CONFIDENCE: f32 = 0.8;
const HIERARCHY_CONFIDENCE: f32 = 0.6;

/// Maximum number of heads to search; a crowd is not a body.
const MAX_HEADS: usize = 64;

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

    /// The ancestors of a joint among `joints`, in their order.
    fn above(&self, joints: &[JointIndex], below: JointIndex) -> impl DoubleEndedIterator<Item = JointIndex> {
        joints.iter().copied().filter(move |&joint| joint != below && self.tree.is_under(below, joint))
    }

    /// The upper half of a limb: the first ancestor by a sure word, then by a vague one, then the last by the joint it hangs on.
    fn upper_of(&self, lower: JointIndex, [sure, vague, base]: [&[JointIndex]; 3]) -> Option<JointIndex> {
        let first = |joints| self.above(joints, lower).next();
        first(sure).or_else(|| first(vague)).or_else(|| self.above(base, lower).next_back())
    }

    /// The joint between the upper half of a limb and its end, if there is only one.
    fn only_between(&self, upper: JointIndex, ends: &[JointIndex]) -> Option<JointIndex> {
        match self.tree.path(upper, self.under(ends, upper)?).as_slice() {
            [between, _] => Some(*between),
            _ => None,
        }
    }

    fn leg(&self, side: Side) -> Limb {
        let all = |word| self.all(Some(side), word);
        let (thighs, hips, legs, shins) = (all(Word::UpperLeg), all(Word::Hip), all(Word::Leg), all(Word::LowerLeg));
        let (feet, toes) = (all(Word::Foot), all(Word::Toes));
        let upper_of = |lower| self.upper_of(lower, [&thighs, &legs, &hips]);
        let mut lower = shins.first().copied();
        let mut upper = lower.and_then(upper_of);
        if lower.is_none() {
            upper = thighs.first().copied();
            lower = match upper {
                Some(upper) => self.under(&legs, upper),
                None => legs.first().and_then(|&first| self.under(&legs, first)).or(legs.first().copied()),
            };
            upper = upper.or_else(|| lower.and_then(upper_of));
        }
        // An unnamed joint between thigh and foot is the shin.
        if let (Some(upper), None) = (upper, lower) {
            lower = self.only_between(upper, &feet);
        }
        // In many game rigs, feet follow a control and are not descendants of the leg.
        let end = lower.and_then(|lower| self.under(&feet, lower).or(feet.first().copied()));
        let extra = end.and_then(|foot| self.under(&toes, foot).or_else(|| self.under(&feet, foot)));
        Limb { extra, upper, lower, end }
    }

    fn arm(&self, side: Side) -> Limb {
        let all = |word| self.all(Some(side), word);
        let (collars, shoulders, uppers) = (all(Word::Clavicle), all(Word::Shoulder), all(Word::UpperArm));
        let (arms, lowers, hands) = (all(Word::Arm), all(Word::LowerArm), all(Word::Hand));
        let mut lower = lowers.first().copied();
        let mut upper = lower.and_then(|lower| self.upper_of(lower, [&uppers, &arms, &shoulders]));
        if lower.is_none() {
            upper = uppers.first().or(arms.first()).or(shoulders.last()).copied();
            lower = upper.and_then(|upper| self.under(&arms, upper).or_else(|| self.only_between(upper, &hands)));
        }
        let end = lower.and_then(|lower| self.under(&hands, lower));
        let extra = upper.and_then(|upper| {
            self.above(&collars, upper).next_back().or_else(|| self.above(&shoulders, upper).next_back())
        });
        Limb { extra, upper, lower, end }
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
        let named_neck = path.iter().position(|&joint| word(joint) == Some(Word::Neck));
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
        let mut torso: Vec<JointIndex> =
            path.iter().copied().filter(|&joint| word(joint) == Some(Word::Torso)).collect();
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
            let joints = self.all(Some(side), Word::Finger(finger));
            for slot in known::finger_slots(finger, side) {
                let Some(joint) = self.under(&joints, above) else { break };
                self.put(slot, joint, Reason::Words);
                above = joint;
            }
        }
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
