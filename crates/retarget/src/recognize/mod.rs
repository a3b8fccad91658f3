//! Finds the joints of an asset that fill the humanoid slots: by the file's own humanoid map, else by known vocabularies,
//! words and hierarchy, else by shape. Records how each joint was found.

mod assemble;
mod by_shape;
mod creature;
mod evidence;
mod facing;
mod fingers;
mod known;
mod languages;
mod limb_words;
mod limbs;
mod names;
mod shape;
mod tree;
mod vocabulary;
mod words;

use std::collections::BTreeMap;
use std::fmt;

use gaitway_character::anim::{JointIndex, Pose, SampleCursor};
use gaitway_character::asset::{Asset, Humanoid, Slot};
use gaitway_character::sort::collect_map;
use glam::Vec3;

use crate::body::Anatomy;
use crate::pose::mirror_from_model;

use by_shape::Found;
use evidence::Evidence;
pub(crate) use evidence::middle_of_skin;
use tree::Tree;

pub(crate) use creature::chains;
pub use names::Name;
pub use names::words;

/// The result of [`recognize`]; empty for anything but a human body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recognized {
    /// The joint that fills each slot.
    pub parts: BTreeMap<Slot, RecognizedJoint>,
    /// The joints that most likely fill other slots, but not certainly enough: they were left out of `parts`.
    pub left_out: BTreeMap<Slot, RecognizedJoint>,
    /// Which way the body faces at rest.
    pub facing: Facing,
    /// Evidence against what was decided in `parts`.
    pub contradictions: Vec<Contradiction>,
    /// Whether the joints' positions decided left and right against their names, for all joints together.
    pub by_position: bool,
    /// The chains of the body, and what belongs to them.
    pub anatomy: Anatomy,
}

/// The joint of a slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecognizedJoint {
    /// The joint that fills the slot.
    pub joint: JointIndex,
    /// How it was found.
    pub reason: Reason,
    /// 0 (a guess) to 1 (the file says so).
    pub confidence: f32,
}

/// How a joint was matched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reason {
    /// The file's own humanoid map (VRM, VRMA).
    File,
    /// Both skeletons give it the same name.
    SameName,
    /// It is called as in a known vocabulary, whose name this is. Others have names in common with it.
    Vocabulary(&'static str),
    /// Words in its name.
    Words,
    /// Its position between joints that were found otherwise.
    Hierarchy,
    /// Its position in space.
    Geometry,
}

/// A text for the UI: “named as in Mixamo”, “position in space”.
impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("the file says so"),
            Self::SameName => f.write_str("same name"),
            Self::Vocabulary(vocabulary) => write!(f, "named as in {vocabulary}"),
            Self::Words => f.write_str("words in its name"),
            Self::Hierarchy => f.write_str("position in the hierarchy"),
            Self::Geometry => f.write_str("position in space"),
        }
    }
}

/// Which way the character faces at rest, in model space. Each direction comes from its own evidence, so that they can be
/// compared.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Facing {
    /// From the feet to the head; +Y unless the character rests lying down.
    pub up: Option<Vec3>,
    /// From the right side to the left as they were decided; perpendicular to `up`.
    pub left: Option<Vec3>,
    /// Where toes, eyes and knees point, regardless of left and right; perpendicular to `up`.
    pub forward: Option<Vec3>,
}

impl Facing {
    fn map(self, by: impl Fn(Vec3) -> Vec3) -> Self {
        Self { up: self.up.map(&by), left: self.left.map(&by), forward: self.forward.map(&by) }
    }

    /// Whether the side named left is on the right as the toes point: the model is mirrored or its names are swapped, and
    /// (right → left) × up points backwards.
    pub fn is_mirrored(&self) -> bool {
        match (self.up, self.left, self.forward) {
            (Some(up), Some(left), Some(forward)) => left.cross(up).dot(forward) < 0.0,
            _ => false,
        }
    }
}

/// Evidence that contradicts a decision.
#[derive(Debug, Clone, PartialEq)]
pub enum Contradiction {
    /// Named for one side but on the other, as the feet point. [`Recognized::by_position`] says which was followed.
    Side {
        /// The slot that the joint fills.
        slot: Slot,
        /// The joint that lies on the wrong side of its counterpart.
        joint: JointIndex,
        /// Its name.
        name: String,
    },
}

impl Recognized {
    /// Returns the joint that fills a slot.
    pub fn joint(&self, slot: Slot) -> Option<JointIndex> {
        self.parts.get(&slot).map(|part| part.joint)
    }

    /// Returns the slot that a joint fills.
    pub fn slot(&self, joint: JointIndex) -> Option<Slot> {
        self.parts.iter().find(|(_, part)| part.joint == joint).map(|(&slot, _)| slot)
    }

    /// Returns the joints by slot, without how they were found.
    pub fn humanoid(&self) -> Humanoid {
        Humanoid(collect_map(self.parts.iter().map(|(&slot, part)| (slot, part.joint))))
    }
}

/// Factor on the confidence in names that leave much of a body unmatched: they may mean something else.
const PARTIAL_BODY_FACTOR: f32 = 0.7;

/// Confidence in a joint whose name is wrong about the side: its position overrode the name, so it needs review.
const SWAPPED_CONFIDENCE: f32 = 0.55;

/// A file's own humanoid map with fewer slots than this may have other parts beside them.
const WHOLE_FILE_SLOTS: usize = 6;

/// A creature with a tail counts as human only from this cosine between upper body and legs.
const MIN_CREATURE_STRAIGHTNESS: f32 = 0.8;

/// Finds the joints of a human body; deterministic.
pub fn recognize(asset: &Asset) -> Recognized {
    let mut tree = Tree::new(asset);
    let from_file = asset.humanoid.as_ref().map(from_file).filter(|parts| !parts.is_empty());
    let is_declared = from_file.is_some();
    let Found { mut parts, left_out } = match from_file {
        Some(parts) => Found { parts: completed_map(asset, &tree, parts), ..Found::default() },
        None => find(asset, &tree),
    };
    if parts.is_empty() {
        return Recognized::default();
    }
    pose_upright(asset, &mut tree, &parts);
    // Four legs under a level back: the joints of a dog often have human names.
    let is_level =
        facing::straightness(&tree, &parts).is_some_and(|straightness| straightness < MIN_CREATURE_STRAIGHTNESS);
    if !is_declared && is_level && names_a_creature(&tree) {
        return Recognized::default();
    }
    let feet_point = facing::feet_point(asset, &tree, &parts);
    let mut facing = facing::find(&tree, &parts, feet_point);
    let mut contradictions = facing::contradictions(&tree, &parts, &facing);
    let mut by_position = !is_declared && facing::position_decides(&parts, feet_point, &contradictions);
    if by_position {
        parts = with_sides_swapped(parts);
        facing = facing::find(&tree, &parts, feet_point);
        for Contradiction::Side { slot, .. } in &mut contradictions {
            *slot = slot.mirrored();
        }
    } else {
        let named_otherwise = named_otherwise(&tree, &parts);
        by_position = !named_otherwise.is_empty();
        contradictions.extend(named_otherwise);
    }
    let model_from_mirror = mirror_from_model(&asset.skeleton).inverse();
    let facing = facing.map(|direction| model_from_mirror.transform_vector3(direction));
    let recognized = Recognized { parts, left_out, facing, contradictions, by_position, anatomy: Anatomy::default() };
    Recognized { anatomy: Anatomy::new(asset, &recognized.humanoid()), ..recognized }
}

/// The joints whose position has decided against the side in their name.
fn named_otherwise(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>) -> Vec<Contradiction> {
    let is_otherwise = |(slot, part): &(&Slot, &RecognizedJoint)| {
        let named = tree.names[part.joint.get()].side;
        part.reason == Reason::Geometry && slot.side().is_some() && named.is_some() && named != slot.side()
    };
    let contradiction = |(&slot, part): (&Slot, &RecognizedJoint)| Contradiction::Side {
        slot,
        joint: part.joint,
        name: tree.skeleton.name(part.joint).to_owned(),
    };
    parts.iter().filter(is_otherwise).map(contradiction).collect()
}

/// Gives each joint the slot of the other side, with at most the confidence of a name that is wrong about the side.
fn with_sides_swapped(parts: BTreeMap<Slot, RecognizedJoint>) -> BTreeMap<Slot, RecognizedJoint> {
    let swapped =
        parts.into_iter().map(|(slot, RecognizedJoint { joint, reason, confidence })| match slot.mirrored() {
            same if same == slot => (slot, RecognizedJoint { joint, reason, confidence }),
            other => {
                let confidence = confidence.min(SWAPPED_CONFIDENCE);
                (other, RecognizedJoint { joint, reason: Reason::Geometry, confidence })
            }
        });
    collect_map(swapped)
}

fn from_file(humanoid: &Humanoid) -> BTreeMap<Slot, RecognizedJoint> {
    let declared = |joint| RecognizedJoint { joint, reason: Reason::File, confidence: 1.0 };
    collect_map(humanoid.0.iter().map(|(&slot, &joint)| (slot, declared(joint))))
}

/// Adds what a humanoid map lacks: fingers, which maps often leave out, while other slots may be left out on purpose; to a map of a
/// few bones, everything.
fn completed_map(
    asset: &Asset,
    tree: &Tree,
    mut parts: BTreeMap<Slot, RecognizedJoint>,
) -> BTreeMap<Slot, RecognizedJoint> {
    let others = if parts.len() >= WHOLE_FILE_SLOTS {
        let mut named = assemble::find(tree, known::find(tree).as_ref());
        named.retain(|slot, _| slot.is_finger());
        named
    } else {
        find(asset, tree).parts
    };
    complete(tree, &mut parts, others);
    parts
}

/// Finds a body by names and, unless they give a whole one, also by shape.
fn find(asset: &Asset, tree: &Tree) -> Found {
    let known = known::find(tree);
    let mut named = assemble::find(tree, known.as_ref());
    if has_whole_body(&named) {
        return Found { parts: named, ..Found::default() };
    }
    if names_a_creature(tree) {
        return Found::default();
    }
    named.values_mut().for_each(|part| part.confidence *= PARTIAL_BODY_FACTOR);
    let mut shaped = by_shape::find(tree, &Evidence::new(asset));
    let agree = |(slot, part): (&Slot, &RecognizedJoint)| Some(named.get(slot)?.joint == part.joint);
    let agreements: Vec<bool> = shaped.parts.iter().filter_map(agree).collect();
    let contradict = agreements.iter().filter(|&&agrees| !agrees).count() * 2 > agreements.len();
    if known.is_some() && (contradict || shaped.parts.is_empty()) {
        return Found { parts: named, ..Found::default() };
    }
    // What the words mean is no human body: its shape would only mislead.
    let known_words = tree.words.iter().flatten().count();
    let is_figure = !shaped.parts.is_empty() || has_limbs(&named);
    if !is_figure || contradict && known_words > tree.skeleton.len() / 4 {
        return Found::default();
    }
    if known.is_some() {
        complete(tree, &mut named, shaped.parts);
        Found { parts: named, left_out: shaped.left_out }
    } else {
        complete(tree, &mut shaped.parts, named);
        shaped.left_out.retain(|slot, _| !shaped.parts.contains_key(slot));
        shaped
    }
}

/// Adds the parts that a body lacks and that fit in: of joints that are free, below those of the parts above and above those of
/// the parts below.
fn complete(tree: &Tree, body: &mut BTreeMap<Slot, RecognizedJoint>, others: BTreeMap<Slot, RecognizedJoint>) {
    for (slot, part) in others {
        let is_below = |below: Slot, above: Slot| {
            std::iter::successors(known::parent_of(below), |slot| known::parent_of(*slot)).any(|other| other == above)
        };
        let fits = |(&other, there): (&Slot, &RecognizedJoint)| {
            other != slot
                && there.joint != part.joint
                && (!is_below(slot, other) || tree.is_under(part.joint, there.joint))
                && (!is_below(other, slot) || tree.is_under(there.joint, part.joint))
        };
        if body.iter().all(fits) {
            body.insert(slot, part);
        }
    }
}

/// Whether hips, head, arms and legs are there. Simple figures may lack hands, feet and a spine.
fn has_whole_body(parts: &BTreeMap<Slot, RecognizedJoint>) -> bool {
    use Slot::*;
    let limbs = [LeftUpperLeg, LeftLowerLeg, LeftUpperArm, LeftLowerArm];
    let sides = limbs.into_iter().chain(limbs.map(Slot::mirrored));
    [Hips, Head].into_iter().chain(sides).all(|slot| parts.contains_key(&slot))
}

/// Whether a head, arms and legs are there, as in a figure of rigid parts.
fn has_limbs(parts: &BTreeMap<Slot, RecognizedJoint>) -> bool {
    use Slot::*;
    [Head, LeftUpperLeg, RightUpperLeg, LeftUpperArm, RightUpperArm].into_iter().all(|slot| parts.contains_key(&slot))
}

fn names_a_creature(tree: &Tree) -> bool {
    tree.names.iter().any(words::is_of_creature)
}

/// Uses the first frame for files whose rest is not a pose of a body: motion capture often rests with all bones along one
/// axis.
fn pose_upright(asset: &Asset, tree: &mut Tree, parts: &BTreeMap<Slot, RecognizedJoint>) {
    let Some(clip) = asset.clips.first().filter(|_| asset.skins.is_empty()) else { return };
    let at_rest = facing::straightness(tree, parts);
    if at_rest.is_none_or(|straightness| straightness > 0.5) {
        return;
    }
    let mut pose: Pose = asset.skeleton.rest().clone();
    clip.sample(&asset.skeleton, 0.0, &mut SampleCursor::default(), &mut pose);
    tree.set_pose(&pose);
    if facing::straightness(tree, parts) < at_rest {
        tree.set_pose(asset.skeleton.rest());
    }
}
