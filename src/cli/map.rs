//! `gaitway map`: proposes which joint follows which, and says why.

use std::fmt::Write;

use anyhow::{Context, bail};
use serde_json::{Value, json};

use super::borrow::{joint_name, open_motion};
use super::{MapArguments, open, print_bytes, print_json};
use crate::retarget::{Contradiction, Proposal, propose};

pub(super) fn run(arguments: &MapArguments) -> anyhow::Result<()> {
    let model = open(std::slice::from_ref(&arguments.model))?.model.asset;
    let motion = open_motion(&arguments.motion)?.asset;
    let proposal = propose(&model, &motion);
    let map = proposal.to_map(&model, &motion);
    for contradiction in proposal.model.contradictions.iter().chain(&proposal.motion.contradictions) {
        eprintln!("warning: {}", contradiction_text(contradiction));
    }
    if proposal.pairs.is_empty() {
        bail!(
            "no joint of the model and of the motion could be brought together by name, body part or place; write a map by \
             hand (docs/joint-maps.md)"
        );
    }
    if let Some(path) = &arguments.out {
        std::fs::write(path, map.to_json()?).with_context(|| format!("{}", path.display()))?;
    }
    if arguments.json {
        let mut document = serde_json::to_value(&map)?;
        explain(&proposal, &mut document, &model.skeleton);
        let names = |skeleton, joints: &[_]| -> Vec<String> {
            joints.iter().map(|&joint| joint_name(skeleton, joint)).collect()
        };
        document["unmapped_targets"] = json!(names(&model.skeleton, &proposal.unmapped_targets));
        document["unused_sources"] = json!(names(&motion.skeleton, &proposal.unused_sources));
        let both = proposal.model.contradictions.iter().chain(&proposal.motion.contradictions);
        document["warnings"] = both
            .map(|found| json!({ "code": "sides-contradict", "message": contradiction_text(found), "where": place(found) }))
            .collect();
        return print_json(&document);
    }
    let mut text = String::new();
    for pair in &proposal.pairs {
        let (target, source) = (joint_name(&model.skeleton, pair.target), joint_name(&motion.skeleton, pair.source));
        let slot = pair.slot.map_or("", |slot| slot.name());
        // Writing to a string cannot fail.
        let _ =
            writeln!(text, "{target:<32} {source:<32} {slot:<24} {:>4.0} %  {}", 100.0 * pair.confidence, pair.reason);
    }
    print_bytes(text.as_bytes())
}

/// Adds slot, reason and confidence to each joint of a map's document.
fn explain(proposal: &Proposal, document: &mut Value, skeleton: &crate::anim::Skeleton) {
    for pair in &proposal.pairs {
        let entry = &mut document["joints"][joint_name(skeleton, pair.target)];
        if entry.is_object() {
            entry["slot"] = json!(pair.slot.map(|slot| slot.name()));
            entry["reason"] = json!(pair.reason.to_string());
            entry["confidence"] = json!((f64::from(pair.confidence) * 1000.0).round() / 1000.0);
        }
    }
}

fn place(contradiction: &Contradiction) -> &str {
    let Contradiction::Side { name, .. } = contradiction;
    name
}

pub(super) fn contradiction_text(contradiction: &Contradiction) -> String {
    let Contradiction::Side { slot, name, .. } = contradiction;
    format!(
        "“{name}” is taken for {} by its name, but lies on the other side as the toes point: the model is mirrored, or its \
         names are swapped",
        slot.name()
    )
}
