//! What plays in a view.

use super::playhead::{active_clip, chosen_clip, play_range, world_from_model};
use super::{CharacterView, Fade, Playhead, ViewerState};
use crate::library::{Held, Model, ModelClip, Moment, Outgoing, Take};

/// Returns what a view plays: the active clip with everything that the view lays over it.
pub fn active_take<'a>(model: &'a Model, state: &'a ViewerState) -> Take<'a> {
    let clip = active_clip(model, state);
    let take = take_of(model, clip, state);
    Take { range: clip.map_or(take.range, |clip| play_range(clip, state)), ..take }
}

/// Returns the same of another clip, the whole of it.
pub fn take_of<'a>(model: &'a Model, clip: Option<&'a ModelClip>, state: &'a ViewerState) -> Take<'a> {
    let ViewerState { character: CharacterView { edits, .. }, playback, display, .. } = state;
    Take {
        loop_mode: playback.loop_mode,
        layers: &edits.layers,
        held: Held { rotations: &edits.pose, morph_weights: &edits.morph, expressions: &edits.expressions },
        pins: &edits.pins,
        look_at: display.look_at,
        springs: display.springs,
        world_from_model: world_from_model(edits.up),
        ..Take::new(model, clip)
    }
}

/// Returns the time of a view in its [`active_take`].
pub fn moment<'a>(model: &'a Model, state: &ViewerState) -> Moment<'a> {
    let Playhead { time_secs, fade, .. } = &state.character.playhead;
    let from = fade.as_ref().map(|Fade { clip, time_secs, elapsed_secs }| {
        let from = chosen_clip(model, clip);
        Outgoing {
            clip: from.map(ModelClip::over_layers),
            time_secs: *time_secs,
            elapsed_secs: *elapsed_secs,
            length_secs: crossfade_secs(from, active_clip(model, state)),
        }
    });
    Moment { elapsed_secs: *time_secs, from }
}

/// Returns the length of the crossfade between two clips.
pub(super) fn crossfade_secs(from: Option<&ModelClip>, to: Option<&ModelClip>) -> f64 {
    [from, to].map(|clip| clip.map_or(0.0, ModelClip::crossfade_secs)).into_iter().fold(0.0, f64::max)
}
