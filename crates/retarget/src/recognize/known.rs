//! Finds the known vocabulary that a skeleton's names come from, and the slots it gives them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Side, Slot};

use super::names::Name;
use super::tree::Tree;
use super::vocabulary::{FINGERS, VOCABULARIES, Vocabulary};
use super::words::Word;

/// The slots of one vocabulary.
#[derive(Debug, Default)]
pub(super) struct Known {
    pub vocabulary: &'static str,
    pub slots: BTreeMap<JointIndex, Slot>,
}

/// Fewer slots than this (without fingers) may be chance: `hips`, `head` and `foot` are in many vocabularies.
const MIN_SLOTS: usize = 8;

/// Returns the vocabulary that fits best; None if none fits well enough.
pub(super) fn find(tree: &Tree) -> Option<Known> {
    let keys: Vec<[Key; 2]> = tree.names.iter().map(keys).collect();
    let mut best: Option<(i32, Known)> = None;
    for (vocabulary, slots) in VOCABULARIES.iter().zip(&*SLOTS) {
        let (known, misfits) = read(tree, &keys, vocabulary, slots);
        let found = known.slots.values().filter(|slot| !slot.is_finger()).count();
        if found < MIN_SLOTS {
            continue;
        }
        let score = known.slots.len() as i32 - 2 * misfits as i32;
        if best.as_ref().is_none_or(|(other, _)| score > *other) {
            best = Some((score, known));
        }
    }
    best.map(|(_, known)| known)
}

/// A name for comparison: whether it has a side, and its words.
type Key = (bool, String);

/// With numbers as written, and without leading zeros.
fn keys(name: &Name) -> [Key; 2] {
    [name.key(), name.short_key()].map(|key| (name.side.is_some(), key))
}

/// The slots of a vocabulary by both kinds of keys.
type Slots = [BTreeMap<Key, Slot>; 2];

/// Of each vocabulary. Reading their hundreds of names takes longer than looking up a skeleton's.
static SLOTS: LazyLock<Vec<Slots>> = LazyLock::new(|| VOCABULARIES.iter().map(slots_of).collect());

fn slots_of(vocabulary: &Vocabulary) -> Slots {
    let mut slots = Slots::default();
    for &(name, slot) in vocabulary.body.iter().chain(&fingers(vocabulary)) {
        for (slots, key) in slots.iter_mut().zip(keys(&Name::read(name))) {
            slots.entry(key).or_insert(slot);
        }
    }
    slots
}

/// Returns the slots of the joints that the vocabulary names, and how many of them do not fit the hierarchy.
fn read(tree: &Tree, keys_of: &[[Key; 2]], vocabulary: &Vocabulary, [by_key, by_short_key]: &Slots) -> (Known, usize) {
    let mut candidates: BTreeMap<Slot, Vec<JointIndex>> = BTreeMap::new();
    for joint in tree.skeleton.joints().filter(|joint| tree.usable[joint.get()]) {
        let [exact, short] = &keys_of[joint.get()];
        if let Some(&slot) = by_key.get(exact).or_else(|| by_short_key.get(short)) {
            let is_right = tree.names[joint.get()].side == Some(Side::Right);
            candidates.entry(if is_right { slot.mirrored() } else { slot }).or_default().push(joint);
        }
    }
    let mut known = Known { vocabulary: vocabulary.name, ..Known::default() };
    let mut chosen: BTreeMap<Slot, JointIndex> = BTreeMap::new();
    let mut misfits = 0;
    // Parents come before children in the order of slots.
    for (&slot, joints) in &candidates {
        let above = std::iter::successors(parent_of(slot), |slot| parent_of(*slot)).find_map(|slot| chosen.get(&slot));
        let fits = |joint: &&JointIndex| above.is_none_or(|&above| **joint != above && tree.is_under(**joint, above));
        match joints.iter().find(fits) {
            Some(&joint) => {
                chosen.insert(slot, joint);
                known.slots.insert(joint, slot);
            }
            None => misfits += 1,
        }
    }
    (known, misfits)
}

fn fingers(vocabulary: &Vocabulary) -> Vec<(&'static str, Slot)> {
    vocabulary.fingers.iter().copied().zip(FINGERS).filter(|(name, _)| !name.is_empty()).collect()
}

/// The word for a slot.
pub(super) fn word_of(slot: Slot) -> Word {
    use Slot::*;
    let left = if slot.side() == Some(Side::Right) { slot.mirrored() } else { slot };
    match left {
        Hips => Word::Pelvis,
        Neck => Word::Neck,
        Head => Word::Head,
        Jaw => Word::Jaw,
        LeftEye => Word::Eye,
        LeftShoulder => Word::Clavicle,
        LeftUpperArm => Word::UpperArm,
        LeftLowerArm => Word::LowerArm,
        LeftHand => Word::Hand,
        LeftUpperLeg => Word::UpperLeg,
        LeftLowerLeg => Word::LowerLeg,
        LeftFoot => Word::Foot,
        LeftToes => Word::Toes,
        _ => match FINGERS.iter().position(|finger| *finger == left) {
            Some(at) => Word::Finger((at / 3) as u8),
            None => Word::Torso,
        },
    }
}

/// The parent slot in VRM 1.0, including optional ones.
pub(super) fn parent_of(slot: Slot) -> Option<Slot> {
    use Slot::*;
    if slot.side() == Some(Side::Right) {
        let left = parent_of(slot.mirrored())?;
        return Some(left.mirrored());
    }
    Some(match slot {
        Hips => return None,
        Spine | LeftUpperLeg => Hips,
        Chest => Spine,
        UpperChest => Chest,
        Neck | LeftShoulder => UpperChest,
        Head => Neck,
        Jaw | LeftEye => Head,
        LeftLowerLeg => LeftUpperLeg,
        LeftFoot => LeftLowerLeg,
        LeftToes => LeftFoot,
        LeftUpperArm => LeftShoulder,
        LeftLowerArm => LeftUpperArm,
        LeftHand => LeftLowerArm,
        other => match FINGERS.iter().position(|&finger| finger == other) {
            Some(at) if at % 3 > 0 => FINGERS[at - 1],
            _ => LeftHand,
        },
    })
}

/// The three slots of a finger (0 is the thumb), from the palm outwards.
pub(super) fn finger_slots(finger: u8, side: Side) -> impl Iterator<Item = Slot> {
    let slots = FINGERS.iter().skip(usize::from(finger) * 3).take(3);
    slots.map(move |&slot| if side == Side::Right { slot.mirrored() } else { slot })
}
