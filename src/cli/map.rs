//! `gaitway map`: proposes a joint map and explains it.

use gaitway_character::anim::Skeleton;
use gaitway_character::asset::Asset;
use gaitway_retarget::{Body, Contradiction, JointMap, Proposal, Recognized, ResolvedMap, Retargeting};
use gaitway_scene::library::{Model, Motion, proposal_for};
use serde_json::{Value, json};

use super::failure::Outcome;
use super::motion::{DOUBTFUL_REST, doubtful_rest, open_motion};
use super::output::{is_standard_output, print_json, print_lines, warn, write_output};
use super::{MapArguments, open};
use crate::files::Disk;

pub(super) fn run(arguments: &MapArguments, disk: &Disk) -> Outcome {
    let model = open(std::slice::from_ref(&arguments.model), disk)?.model;
    let motion = open_motion(&arguments.motion, disk)?;
    let proposed = Proposed::new(&model, &motion)?;
    proposed.warn(arguments);
    if let Some(path) = &arguments.out {
        let map = proposed.map.to_file(&model.asset, &motion.asset);
        write_output(path, map.to_json()?.as_bytes(), &["json"], disk)?;
        if is_standard_output(path) {
            return Ok(());
        }
    }
    if arguments.json {
        return print_json(&proposed.document()?);
    }
    print_lines(proposed.lines())
}

/// A proposed map and what is reported about it.
pub(super) struct Proposed<'a> {
    model: &'a Asset,
    motion: &'a Asset,
    proposal: Proposal,
    map: JointMap,
    /// See [`doubtful_rests`].
    doubtful: Vec<(String, String)>,
}

impl<'a> Proposed<'a> {
    pub fn new(model: &'a Model, motion: &'a Motion) -> Outcome<Self> {
        let proposal = proposal_for(model, motion);
        let map = proposal.to_map(&model.asset, &motion.asset);
        let doubtful = if proposal.pairs.is_empty() {
            Vec::new()
        } else {
            doubtful_rests(model.body(), motion.body(), &map.resolve(&model.asset, &motion.asset)?)
        };
        Ok(Self { model: &model.asset, motion: &motion.asset, proposal, map, doubtful })
    }

    fn warn(&self, arguments: &MapArguments) {
        for (file, found) in [(&arguments.model, &self.proposal.model), (&arguments.motion, &self.proposal.motion)] {
            for text in contradictions_text(found).into_iter().chain(left_out_text(found)) {
                warn(&format!("{}: {text}", file.display()));
            }
        }
        if self.proposal.pairs.is_empty() {
            warn(NOTHING_MATCHES);
        }
        for (clip, message) in &self.doubtful {
            warn(&format!("{}: {clip}: {message}", arguments.motion.display()));
        }
    }

    /// Returns the document of `--json`: the map with what is known about its joints. It can be used as a map.
    pub fn document(&self) -> Outcome<Value> {
        let (target, source) = (&self.model.skeleton, &self.motion.skeleton);
        let mut document =
            serde_json::to_value(self.map.to_file(self.model, self.motion)).map_err(|error| error.to_string())?;
        explain(&self.proposal, &mut document, target);
        let names = |skeleton: &Skeleton, joints: &[_]| -> Vec<String> {
            joints.iter().map(|&joint| skeleton.label(joint)).collect()
        };
        document["unmapped_targets"] = json!(names(target, &self.proposal.unmapped_targets));
        document["unused_sources"] = json!(names(source, &self.proposal.unused_sources));
        document["warnings"] = warnings(&self.proposal, [target, source], &self.doubtful);
        Ok(document)
    }

    fn lines(&self) -> impl Iterator<Item = String> {
        self.proposal.pairs.iter().map(|pair| {
            let (target, source) = (self.model.skeleton.label(pair.target), self.motion.skeleton.label(pair.source));
            let (slot, confidence) = (pair.slot.map_or("", |slot| slot.name()), 100.0 * pair.confidence);
            format!("{target:<32} {source:<32} {slot:<24} {confidence:>4.0} %  {}", pair.reason)
        })
    }
}

/// The map is still written, without sources, to be filled in.
const NOTHING_MATCHES: &str = "no joint of the model matches the motion by name, body part or position: the map is empty; \
                               fill in its sources (docs/joint-maps.md)";

/// The warnings of the document, about the model's and the motion's skeleton.
fn warnings(proposal: &Proposal, skeletons: [&Skeleton; 2], doubtful: &[(String, String)]) -> Value {
    let mut warnings = Vec::new();
    let mut add = |code: &str, message: &str, place: &str| {
        warnings.push(json!({ "code": code, "message": message, "where": place }));
    };
    for (found, skeleton) in [&proposal.model, &proposal.motion].into_iter().zip(skeletons) {
        if let Some(text) = contradictions_text(found) {
            add("sides-contradict", &text, &found.contradictions.iter().map(place).collect::<Vec<_>>().join(", "));
        }
        if let Some(text) = left_out_text(found) {
            let joints: Vec<String> = found.left_out.values().map(|part| skeleton.label(part.joint)).collect();
            add("unclear-joints", &text, &joints.join(", "));
        }
    }
    if proposal.pairs.is_empty() {
        add("nothing-matches", NOTHING_MATCHES, "");
    }
    for (clip, message) in doubtful {
        add(DOUBTFUL_REST, message, clip);
    }
    Value::Array(warnings)
}

/// Names of the clips whose rest is not certain, each with a warning.
fn doubtful_rests(model: Body, motion: Body, map: &ResolvedMap) -> Vec<(String, String)> {
    let clips = motion.asset.clips.iter().enumerate();
    let doubtful = clips.filter_map(|(index, clip)| {
        let rest = Retargeting::new(model, motion, index, map).ok()?.motion_rest();
        Some((clip.name().to_owned(), doubtful_rest(rest)?))
    });
    doubtful.collect()
}

/// Adds slot, reason and confidence to each joint of a map's document.
fn explain(proposal: &Proposal, document: &mut Value, skeleton: &Skeleton) {
    for pair in &proposal.pairs {
        let entry = &mut document["joints"][skeleton.label(pair.target)];
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

/// Describes all contradictions of one file in one sentence; `None` if there are none.
fn contradictions_text(found: &Recognized) -> Option<String> {
    let names: Vec<&str> = found.contradictions.iter().map(place).collect();
    let (first, last) = (names.first()?, names.last()?);
    let matched = if found.by_position {
        "they were matched by position. To match them by name, swap left and right in the map"
    } else {
        "they were matched by name"
    };
    Some(format!(
        "{} joints from “{first}” to “{last}” have left/right names on the opposite side, judging by the direction of the feet: \
         the model is mirrored, or its names are swapped; {matched}",
        names.len()
    ))
}

/// Describes the body parts of one file that were too uncertain to map; `None` if there are none.
fn left_out_text(found: &Recognized) -> Option<String> {
    let slots: Vec<&str> = found.left_out.keys().map(|slot| slot.name()).collect();
    let all = slots.join(", ");
    match slots.len() {
        0 => None,
        1 => Some(format!("1 body part could not be located reliably and was left unmapped: {all}")),
        count => Some(format!("{count} body parts could not be located reliably and were left unmapped: {all}")),
    }
}
