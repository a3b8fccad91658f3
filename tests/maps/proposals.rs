//! What is proposed for two files.

use gaitway::anim::JointIndex;
use gaitway::asset::Asset;
use gaitway::retarget::{Proposal, propose};

use crate::data::open;

/// The number of the source joint that each named target follows.
fn check(model: &Asset, proposal: &Proposal, motion: &Asset, expected: &[(&str, usize)]) {
    for (name, number) in expected {
        let target = model.skeleton.find(name).unwrap_or_else(|| panic!("{name}"));
        let source = proposal.pairs.iter().find(|pair| pair.target == target).map(|pair| pair.source);
        assert_eq!(source.map(|joint| motion.skeleton.source_index(joint)), Some(*number), "{name}");
    }
}

#[test]
fn the_dwarf_gets_the_table_that_people_wrote_by_hand() {
    let (Some(dwarf), Some(walk)) = (open("cosc422/dwarf.glb"), open("cosc422/original/Dwarf/avatar_walk.bvh")) else {
        return;
    };
    let proposal = propose(&dwarf, &walk);
    check(
        &dwarf,
        &proposal,
        &walk,
        &[
            ("head", 5),
            ("spine1", 4),
            ("spine2", 2),
            ("lhip", 15),
            ("rhip", 18),
            ("lknee", 16),
            ("rknee", 19),
            ("lankle", 17),
            ("rankle", 20),
        ],
    );
    assert!(!proposal.model.contradictions.is_empty(), "lhip lies at the right");
    assert!(proposal.motion.contradictions.is_empty());
}

#[test]
fn names_decide_where_most_are_shared() {
    let (Some(mannequin), Some(run)) = (open("cosc422/mannequin.glb"), open("cosc422/mannequin_run.glb")) else {
        return;
    };
    let proposal = propose(&mannequin, &run);
    // All nodes of the motion but the one that only wraps them have their name in the model.
    assert_eq!(proposal.pairs.len(), run.skeleton.len());
    assert!(proposal.unused_sources.is_empty() && proposal.unmapped_targets.is_empty());
    let name = |asset: &Asset, joint: JointIndex| asset.skeleton.name(joint).to_owned();
    assert!(proposal.pairs.iter().all(|pair| name(&mannequin, pair.target) == name(&run, pair.source)));
}
