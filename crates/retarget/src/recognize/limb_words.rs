//! Which joint of a limb is which of its parts, by names and hierarchy. A name rarely decides alone: a “shoulder” is the upper arm
//! below a clavicle and the collar bone above an upper arm, a “leg” is the thigh above a shin and the shin below a thigh. So each
//! joint has a measure of how well it fits each part, and the parts get the joints that fit best together, each below the last.

use std::ops::Range;

use gaitway_character::anim::JointIndex;

use super::tree::Tree;
use super::words::Word;

/// How well a joint fits each of a limb's four parts, from the trunk outwards; 0 if it doesn't.
pub(super) type Fits = [f32; 4];

/// The fit of a joint whose name means one part and no other.
pub(super) const SURE_FIT: f32 = 0.9;

/// What a limb loses without a part that every such limb has, if it has one further out.
const MISSING: f32 = 0.3;

/// The parts of a limb, from the trunk outwards.
pub(super) struct Parts {
    fits: fn(Word) -> Fits,
    /// Whether every such limb has the part.
    needed: [bool; 4],
}

/// Collar bone, upper arm, forearm, hand.
pub(super) const ARM: Parts = Parts { fits: arm_fits, needed: [false, true, true, true] };

/// Thigh, shin, foot, toes.
pub(super) const LEG: Parts = Parts { fits: leg_fits, needed: [true, true, true, false] };

impl Parts {
    /// How well a joint with this word fits.
    pub fn fits(&self, word: Word) -> Fits {
        (self.fits)(word)
    }

    /// What is lost without the needed parts of a range.
    fn missing(&self, parts: Range<usize>) -> f32 {
        MISSING * self.needed[parts].iter().filter(|&&needed| needed).count() as f32
    }
}

fn arm_fits(word: Word) -> Fits {
    match word {
        Word::Clavicle => [SURE_FIT, 0.0, 0.0, 0.0],
        Word::Shoulder => [0.65, 0.7, 0.0, 0.0],
        Word::UpperArm => [0.0, SURE_FIT, 0.0, 0.0],
        Word::Arm => [0.0, 0.8, 0.5, 0.0],
        Word::LowerArm => [0.0, 0.0, SURE_FIT, 0.0],
        Word::Hand => [0.0, 0.0, 0.0, SURE_FIT],
        _ => [0.0; 4],
    }
}

fn leg_fits(word: Word) -> Fits {
    match word {
        Word::Hip => [0.5, 0.0, 0.0, 0.0],
        Word::UpperLeg => [SURE_FIT, 0.0, 0.0, 0.0],
        Word::Leg => [0.6, 0.5, 0.0, 0.0],
        Word::LowerLeg => [0.0, SURE_FIT, 0.0, 0.0],
        Word::Foot => [0.0, 0.0, SURE_FIT, 0.3],
        Word::Toes => [0.0, 0.0, 0.0, SURE_FIT],
        _ => [0.0; 4],
    }
}

/// Returns the joint of each part, if any, so that all together fit best: at most one for each, and each below those before it.
/// Of equals, the joint nearer to the trunk. `candidates` are in the skeleton's order.
pub(super) fn align(tree: &Tree, parts: &Parts, candidates: &[(JointIndex, Fits)]) -> [Option<JointIndex>; 4] {
    // The best choice that ends with each candidate as each part: its sum, and the candidate and part before.
    let mut best: Vec<[Choice; 4]> = Vec::with_capacity(candidates.len());
    for (at, &(joint, fits)) in candidates.iter().enumerate() {
        let above: Vec<usize> = (0..at).filter(|&before| tree.is_under(joint, candidates[before].0)).collect();
        let end = |part: usize| {
            let alone = Choice { sum: fits[part] - parts.missing(0..part), before: None };
            let chains = above.iter().flat_map(|&before| (0..part).map(move |earlier| (before, earlier)));
            let chains =
                chains.filter(|&(before, earlier)| best[before][earlier].sum > 0.0).map(|(before, earlier)| {
                    let missing = parts.missing(earlier + 1..part);
                    Choice { sum: best[before][earlier].sum + fits[part] - missing, before: Some((before, earlier)) }
                });
            chains.fold(alone, |best, other| if other.sum > best.sum { other } else { best })
        };
        best.push([0, 1, 2, 3].map(|part| if fits[part] > 0.0 { end(part) } else { Choice::default() }));
    }
    let mut last = None;
    let mut sum = 0.0;
    for (at, ends) in best.iter().enumerate() {
        for (part, end) in ends.iter().enumerate() {
            if end.sum > sum {
                (last, sum) = (Some((at, part)), end.sum);
            }
        }
    }
    let mut joints = [None; 4];
    while let Some((at, part)) = last {
        joints[part] = Some(candidates[at].0);
        last = best[at][part].before;
    }
    joints
}

#[derive(Debug, Clone, Copy, Default)]
struct Choice {
    sum: f32,
    before: Option<(usize, usize)>,
}
