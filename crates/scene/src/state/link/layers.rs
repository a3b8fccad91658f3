//! The layers of a view, one `layers` key each, the lowest first: `CLIP`, or `CLIP:` and its settings, such as
//! `Wave:weight:0.5,additive,mask:left-arm:right-arm`. Names are escaped as joint names are. The command line has the same text.

use gaitway_retarget::{BodyPart, ClipLayer, LayerMask, LayerMode};

use super::changes::{clip_text, read_clip};
use super::values::finite;
use crate::library::LayeredClip;

pub(super) const EXPECTED: &str = "a clip and its settings: Wave:weight:0.5,speed:2,start:0.3,additive,mask:left-arm:12; \
                                   parts are hips, torso, head, left-arm, right-arm, left-leg and right-leg";

pub(super) fn text(LayeredClip { clip, layer }: &LayeredClip) -> String {
    let default = ClipLayer::default();
    let mut words = Vec::new();
    let numbers = [
        ("weight", layer.weight, default.weight),
        ("speed", layer.speed, default.speed),
        ("start", layer.start_secs, default.start_secs),
    ];
    let changed = numbers.into_iter().filter(|(_, value, default)| value != default);
    words.extend(changed.map(|(word, value, _)| format!("{word}:{value}")));
    match layer.mode {
        LayerMode::Override => {}
        LayerMode::Additive => words.push("additive".to_owned()),
        LayerMode::AdditiveToRest => words.push("additive:rest".to_owned()),
    }
    if !layer.mask.is_all() {
        let parts = BodyPart::ALL.into_iter().filter(|(part, _)| layer.mask.has(*part));
        let parts = parts.map(|(_, name)| name.to_owned());
        let items: Vec<String> = parts.chain(layer.mask.joints.iter().map(ToString::to_string)).collect();
        words.push(format!("mask:{}", items.join(":")));
    }
    let name = clip_text(clip);
    if words.is_empty() { name } else { format!("{name}:{}", words.join(",")) }
}

/// Reads what [`text()`] writes.
pub(super) fn read(text: &str) -> Option<LayeredClip> {
    let (name, words) = text.split_once(':').unwrap_or((text, ""));
    let (clip, mut layer) = (read_clip(name)?, ClipLayer::default());
    for word in words.split(',').filter(|_| !words.is_empty()) {
        let (kind, value) = word.trim().split_once(':').unwrap_or((word.trim(), ""));
        match (kind, value) {
            ("weight", number) => layer.weight = finite(number)?,
            ("speed", number) => layer.speed = finite(number)?,
            ("start", number) => layer.start_secs = finite(number)?,
            ("additive", "") => layer.mode = LayerMode::Additive,
            ("additive", "rest") => layer.mode = LayerMode::AdditiveToRest,
            ("mask", items) => items.split(':').try_for_each(|item| add_to_mask(&mut layer.mask, item))?,
            _ => return None,
        }
    }
    Some(LayeredClip { clip, layer })
}

/// Adds a part of the body or a joint.
fn add_to_mask(mask: &mut LayerMask, item: &str) -> Option<()> {
    match BodyPart::ALL.into_iter().find(|(_, name)| *name == item) {
        Some((part, _)) if mask.has(part) => {}
        Some((part, _)) => mask.toggle(part),
        None => {
            mask.joints.insert(item.parse().ok()?);
        }
    }
    Some(())
}
