//! Which joint of an asset is which part of a human body: the file's own word first, then known vocabularies, then what
//! names and hierarchy suggest, then shape. Says of each joint how it was found.

mod assemble;
mod facing;
mod known;
mod names;
mod shape;
mod tree;
mod vocabulary;
mod words;

use std::collections::BTreeMap;
use std::fmt;

use glam::Vec3;

use crate::anim::{JointIndex, Pose, SampleCursor};
use crate::asset::{Asset, Humanoid, Slot};
use tree::Tree;

pub use names::{Name, Side};

/// What [`recognize`] found. Empty for what is not a human body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recognized {
    pub parts: BTreeMap<Slot, Part>,
    pub facing: Facing,
    /// Where the evidence disagrees; what is in `parts` is the decision.
    pub contradictions: Vec<Contradiction>,
}

/// One joint that was recognised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    pub joint: JointIndex,
    pub reason: Reason,
    /// 0 (a guess) to 1 (the file says so).
    pub confidence: f32,
}

/// How a joint was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reason {
    /// The file's own humanoid map (VRM, VRMA).
    File,
    /// The two skeletons name it alike.
    SameName,
    /// A known vocabulary, by its name.
    Vocabulary(&'static str),
    /// Words in its name.
    Words,
    /// Its place among joints found otherwise.
    Hierarchy,
    /// Where it lies.
    Geometry,
}

/// For people: “Mixamo name”, “where it lies”.
impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("the file says so"),
            Self::SameName => f.write_str("same name"),
            Self::Vocabulary(vocabulary) => write!(f, "{vocabulary} name"),
            Self::Words => f.write_str("words in its name"),
            Self::Hierarchy => f.write_str("what it hangs on"),
            Self::Geometry => f.write_str("where it lies"),
        }
    }
}

/// Which way the character looks at its rest, in model space. Each from its own evidence, so that they can be compared.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Facing {
    /// From the feet to the head: the body's own, +Y unless the rest lies down.
    pub up: Option<Vec3>,
    /// From the right side to the left, as the sides were decided (names beat geometry); across `up`.
    pub left: Option<Vec3>,
    /// Where toes, eyes and face point, without any word on left and right; across `up`.
    pub forward: Option<Vec3>,
}

impl Facing {
    /// True when what is called left lies to the right of where the toes point: the model is mirrored or its names are
    /// swapped, and (right → left) × up points backwards.
    pub fn is_mirrored(&self) -> bool {
        match (self.up, self.left, self.forward) {
            (Some(up), Some(left), Some(forward)) => left.cross(up).dot(forward) < 0.0,
            _ => false,
        }
    }
}

/// Evidence that disagrees with the decision.
#[derive(Debug, Clone, PartialEq)]
pub enum Contradiction {
    /// Named for one side, lies on the other as the toes point.
    Side { slot: Slot, joint: JointIndex, name: String },
}

impl Recognized {
    pub fn joint(&self, slot: Slot) -> Option<JointIndex> {
        self.parts.get(&slot).map(|part| part.joint)
    }

    pub fn slot(&self, joint: JointIndex) -> Option<Slot> {
        self.parts.iter().find(|(_, part)| part.joint == joint).map(|(&slot, _)| slot)
    }

    pub fn humanoid(&self) -> Humanoid {
        Humanoid(self.parts.iter().map(|(&slot, part)| (slot, part.joint)).collect())
    }
}

/// Where words leave so much of a body open, they may mean something else.
const SURE_PARTIAL: f32 = 0.7;

/// Fewer parts than this are no humanoid map that a file means.
const FEWEST_OF_FILE: usize = 6;

/// Cosine between upper body and legs that whoever has a tail must reach to count as human.
const STRAIGHT: f32 = 0.8;

/// Finds the parts of a human body. The same asset always gives the same answer.
pub fn recognize(asset: &Asset) -> Recognized {
    let mut tree = Tree::new(asset);
    let own = asset.humanoid.as_ref().map(of_file).filter(|parts| parts.len() >= FEWEST_OF_FILE);
    let says_so = own.is_some();
    let parts = match own {
        Some(own) => with_fingers(&tree, own),
        None => by_names(&tree).unwrap_or_else(|| shape::find(&tree)),
    };
    if parts.is_empty() {
        return Recognized::default();
    }
    stand_up(asset, &mut tree, &parts);
    // Four legs under a level back: names of a dog's joints are often those of a human.
    let is_level = facing::straightness(&tree, &parts).is_some_and(|straightness| straightness < STRAIGHT);
    if !says_so && is_level && has_parts_of_creature(&tree) {
        return Recognized::default();
    }
    let facing = facing::find(&tree, &parts);
    let contradictions = facing::contradictions(&tree, &parts, &facing);
    Recognized { parts, facing, contradictions }
}

fn of_file(humanoid: &Humanoid) -> BTreeMap<Slot, Part> {
    let part = |joint| Part { joint, reason: Reason::File, confidence: 1.0 };
    humanoid.0.iter().map(|(&slot, &joint)| (slot, part(joint))).collect()
}

/// Files often leave some fingers out that they have. Other parts that are left out may be meant to be.
fn with_fingers(tree: &Tree, mut parts: BTreeMap<Slot, Part>) -> BTreeMap<Slot, Part> {
    for (slot, part) in by_names(tree).unwrap_or_default() {
        let is_free = |other: &Part| other.joint != part.joint;
        let above = std::iter::successors(known::parent_of(slot), |slot| known::parent_of(*slot));
        let hangs_right = above
            .filter_map(|slot| parts.get(&slot))
            .next()
            .is_some_and(|above| tree.is_under(part.joint, above.joint));
        if known::is_finger(slot) && !parts.contains_key(&slot) && parts.values().all(is_free) && hangs_right {
            parts.insert(slot, part);
        }
    }
    parts
}

/// None when the names are not those of a body, or of too little of it.
fn by_names(tree: &Tree) -> Option<BTreeMap<Slot, Part>> {
    let known = known::find(tree);
    let mut parts = assemble::find(tree, known.as_ref());
    if is_whole(&parts) {
        return Some(parts);
    }
    if known.is_some() && !has_parts_of_creature(tree) {
        for part in parts.values_mut() {
            part.confidence *= SURE_PARTIAL;
        }
        return Some(parts);
    }
    // Words were there, and they spoke against a body: its shape would only mislead.
    let spoken = tree.words.iter().flatten().count();
    (spoken > tree.skeleton.len() / 4 || has_parts_of_creature(tree)).then(BTreeMap::new)
}

/// Whether hips, head, arms and legs are there. Hands, feet and the spine may be missing in simple figures.
fn is_whole(parts: &BTreeMap<Slot, Part>) -> bool {
    use Slot::*;
    let limbs = [LeftUpperLeg, LeftLowerLeg, LeftUpperArm, LeftLowerArm];
    let sides = limbs.into_iter().chain(limbs.map(Slot::mirrored));
    [Hips, Head].into_iter().chain(sides).all(|slot| parts.contains_key(&slot))
}

fn has_parts_of_creature(tree: &Tree) -> bool {
    tree.names.iter().any(words::is_of_creature)
}

/// The rest of many motion files is no pose of a body (all bones along one axis); then the first frame is looked at.
fn stand_up(asset: &Asset, tree: &mut Tree, parts: &BTreeMap<Slot, Part>) {
    let Some(clip) = asset.clips.first().filter(|_| asset.skins.is_empty()) else { return };
    let at_rest = facing::straightness(tree, parts);
    if at_rest.is_none_or(|straightness| straightness > 0.5) {
        return;
    }
    let mut pose: Pose = asset.skeleton.rest().clone();
    clip.sample(&asset.skeleton, 0.0, &mut SampleCursor::default(), &mut pose);
    tree.stand(&pose);
    if facing::straightness(tree, parts) < at_rest {
        tree.stand(asset.skeleton.rest());
    }
}
