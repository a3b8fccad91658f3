//! The pose to evaluate, for `gaitway pose` and `gaitway render`: its options, and how they change what an editor shows.

use clap::{Args, ValueEnum};
use gaitway_character::anim::{ClipQuery, LoopMode, find_clip};
use gaitway_character::mesh::SkinningMode;
use gaitway_scene::editor::Editor;
use gaitway_scene::library::Model;
use gaitway_scene::state::{ClipChoice, Command, unknown_clip};

use super::failure::{Failure, Outcome};
use super::layer::{self, LayerOptions};
use super::motion::Overrides;
use super::pin::PinOptions;

/// The pose to evaluate.
#[derive(Debug, Args)]
pub(super) struct Moment {
    /// A clip's name or index [default: the rest pose]. With --motion, clips of the motion come first, and the default is its
    /// first clip.
    #[arg(long, value_name = "CLIP", allow_negative_numbers = true)]
    clip: Option<String>,
    #[command(flatten)]
    layers: LayerOptions,
    /// Seconds into the clip, clamped to its end.
    #[arg(long, value_name = "SECS", allow_negative_numbers = true, value_parser = read_seconds)]
    time: Option<f64>,
    /// The skinning method.
    #[arg(long, value_enum)]
    skinning: Option<Skinning>,
    #[command(flatten)]
    pins: PinOptions,
}

impl Moment {
    /// Returns what these options override in a link.
    pub(super) fn overrides(&self) -> Overrides {
        Overrides { clip: self.clip.is_some(), layers: !self.layers.layers.is_empty(), variant: false }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Skinning {
    Linear,
    Rigid,
    DualQuaternion,
}

fn read_seconds(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "expected seconds, such as 1.5".to_owned())
}

/// Shows a clip by name or index. With `has_motion`, retargeted clips come first, and the default is the first of them.
pub(super) fn show_clip(editor: &mut Editor, clip: Option<&str>, has_motion: bool) -> Outcome {
    let Some(model) = editor.library().active() else { return Ok(()) };
    let retargeted = |name: &str| retargeted_clip(model, name).filter(|_| has_motion);
    let choice = match clip {
        Some(name) => Some(retargeted(name).unwrap_or_else(|| ClipChoice::called(name))),
        None => retargeted("0"),
    };
    if let Some(choice) = choice {
        editor.apply(Command::SetClip(choice));
    }
    if let (Some(_), Some(model)) = (clip, editor.library().active())
        && let Some(unknown) = unknown_clip(model, editor.state())
    {
        return Err(Failure::from(unknown).in_file(&model.source));
    }
    Ok(())
}

/// Applies the given options and keeps the rest. With `has_motion`, retargeted clips come first.
pub(super) fn apply_moment(editor: &mut Editor, moment: &Moment, has_motion: bool) -> Outcome {
    editor.apply(Command::SetPlaying(false));
    show_clip(editor, moment.clip.as_deref(), has_motion)?;
    if let (false, Some(model)) = (moment.layers.layers.is_empty(), editor.library().active()) {
        layer::check(&moment.layers.layers, model)?;
        editor.apply(Command::SetLayers(moment.layers.layers.clone()));
    }
    if let Some(time_secs) = moment.time {
        if !time_secs.is_finite() {
            return Err(Failure::expected("a number of seconds", time_secs.to_string()).at("--time"));
        }
        editor.apply(Command::SetRange(None));
        editor.apply(Command::SetLoopMode(LoopMode::Once));
        editor.apply(Command::Seek(time_secs));
    }
    if let Some(skinning) = moment.skinning {
        editor.apply(Command::SetSkinning(match skinning {
            Skinning::Linear => SkinningMode::Linear,
            Skinning::Rigid => SkinningMode::Rigid,
            Skinning::DualQuaternion => SkinningMode::DualQuaternion,
        }));
    }
    if let Some(model) = editor.library().active().filter(|_| !moment.pins.is_empty()) {
        for (joint, pin) in moment.pins.pins(&model.asset, model.recognition())? {
            editor.apply(Command::SetPin { joint, pin: Some(pin) });
        }
    }
    Ok(())
}

/// Finds a retargeted clip by name, or by index among the retargeted ones.
fn retargeted_clip(model: &Model, name: &str) -> Option<ClipChoice> {
    let clips = model.clips().borrowed().map(|(_, borrowed)| &borrowed.clip);
    let (clip, _) = model.clips().borrowed().nth(find_clip(clips, ClipQuery::NameOrIndex(name))?)?;
    Some(ClipChoice::Clip(clip.id().clone()))
}
