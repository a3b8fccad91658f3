//! A joint map to start from: by the file's own words, by names that both skeletons share, by parts of the body.

use super::{Contradiction, JointMap, MapEntry, Reason, SourceRef, recognize};
use crate::anim::JointIndex;
use crate::asset::{Asset, Slot};

/// Which joints could follow which, and why.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Proposal {
    /// By target joint, ascending.
    pub pairs: Vec<ProposedPair>,
    pub contradictions: Vec<Contradiction>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedPair {
    pub target: JointIndex,
    pub source: JointIndex,
    pub slot: Option<Slot>,
    pub reason: Reason,
    /// 0 (a guess) to 1 (the files say so).
    pub confidence: f32,
}

pub fn propose(model: &Asset, motion: &Asset) -> Proposal {
    let (targets, sources) = (recognize(model), recognize(motion));
    let mut pairs: Vec<ProposedPair> = targets
        .parts
        .iter()
        .filter_map(|(&slot, target)| {
            let source = sources.parts.get(&slot)?;
            let (reason, confidence) = (target.reason, target.confidence.min(source.confidence));
            Some(ProposedPair { target: target.joint, source: source.joint, slot: Some(slot), reason, confidence })
        })
        .collect();
    pairs.sort_by_key(|pair| pair.target);
    Proposal { pairs, contradictions: targets.contradictions }
}

impl Proposal {
    pub fn to_map(&self, model: &Asset, motion: &Asset) -> JointMap {
        let mut map = JointMap::default();
        for pair in &self.pairs {
            let source = motion.skeleton.source_index(pair.source);
            let entry = MapEntry { source: Some(SourceRef::Number(source)), correction: Default::default(), unmapped: None };
            map.joints.insert(format!("#{}", model.skeleton.source_index(pair.target)), entry);
        }
        map
    }
}
