//! Options that pin joints: in the pose that is shown, or baked into the clip that is written.

use std::collections::BTreeMap;

use clap::Args;
use gaitway_character::asset::{Asset, Slot};
use gaitway_retarget::{Pin, PinGoal, Pinning, Recognized};
use gaitway_scene::library::Model;
use gaitway_scene::state::{NameKind, UnknownName, read_pin};
use glam::Affine3A;

use super::failure::{Failure, Outcome};

#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Pins")]
pub(super) struct PinOptions {
    /// Holds a hand or foot, or turns a head: JOINT=at:X,Y,Z (a point, in metres), =joint:OTHER[,X,Y,Z] (a point in the space of
    /// another joint), =look:X,Y,Z or =look:camera. A joint is a name, an index or a body part such as leftHand. With
    /// @START,END,BLEND after it, only from START to END, in seconds, blended in before and out after. Repeatable.
    #[arg(long = "pin", value_name = "JOINT=GOAL", value_parser = read_option)]
    given: Vec<PinOption>,
}

#[derive(Debug, Clone)]
struct PinOption {
    joint: String,
    goal: String,
}

/// Checks all but names, which need the model.
fn read_option(text: &str) -> Result<PinOption, String> {
    let split = text.rsplit_once('=').filter(|(_, goal)| read_pin(goal, |_| Some(0)).is_some());
    split.map(|(joint, goal)| PinOption { joint: joint.to_owned(), goal: goal.to_owned() }).ok_or_else(|| {
        "expected JOINT= and at:X,Y,Z, joint:OTHER[,X,Y,Z], look:X,Y,Z or look:camera, and perhaps @START,END,BLEND"
            .to_owned()
    })
}

impl PinOptions {
    pub(super) fn is_empty(&self) -> bool {
        self.given.is_empty()
    }

    /// Returns the pins by their joints' indices in the file.
    pub(super) fn pins(&self, asset: &Asset, body: &Recognized) -> Outcome<BTreeMap<usize, Pin>> {
        let mut pins = BTreeMap::new();
        for PinOption { joint, goal } in &self.given {
            let number = find_joint(asset, body, joint)?;
            let mut unknown = None;
            let pin =
                read_pin(goal, |other| find_joint(asset, body, other).map_err(|failure| unknown = Some(failure)).ok());
            if let Some(failure) = unknown {
                return Err(failure);
            }
            let Some(pin) = pin.and_then(Pin::checked) else { continue };
            let pinning = Pinning { asset, body, pins: &pins, world_from_model: Affine3A::IDENTITY, eye: None };
            if !pinning.allows(number, pin.goal) {
                let expected = match pin.goal {
                    PinGoal::Joint(..) => "the end of two bones, held at a joint that doesn't move along with them",
                    _ => "the end of two bones",
                };
                return Err(Failure::expected(expected, format!("“{joint}={goal}”")).at("--pin"));
            }
            pins.insert(number, pin);
        }
        Ok(pins)
    }

    /// Returns [`Self::pins`] for a clip in a file, where there is no camera.
    pub(super) fn pins_of_clip(&self, model: &Model) -> Outcome<BTreeMap<usize, Pin>> {
        let pins = self.pins(&model.asset, model.recognition())?;
        if pins.values().any(|pin| pin.goal == PinGoal::Camera) {
            let failure = Failure::expected("a point to look at", "the camera, which a file with a clip doesn't have");
            return Err(failure.at("--pin").with_hint("use look:X,Y,Z"));
        }
        Ok(pins)
    }
}

fn find_joint(asset: &Asset, body: &Recognized, name: &str) -> Outcome<usize> {
    let skeleton = &asset.skeleton;
    let by_part = || body.joint(Slot::from_name(name)?);
    let by_index = || skeleton.joint_of_source(name.trim_start_matches('#').parse().ok()?);
    let found = skeleton.find(name).or_else(by_part).or_else(by_index);
    found.map(|joint| skeleton.source_index(joint)).ok_or_else(|| {
        let names = skeleton.joints().map(|joint| skeleton.label(joint)).collect();
        Failure::from(UnknownName { kind: NameKind::Joint, name: name.to_owned(), names }).at("--pin")
    })
}
