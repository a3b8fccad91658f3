//! Crossfades between clips, with the duration from the joint map.

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_retarget::{JointMap, propose};
use gaitway_scene::library::{Library, Motion};
use gaitway_scene::state::{CharacterView, ClipChoice, Command, Playback, Playhead, ViewerState, apply};

use crate::by_place::ByPlace;
use crate::data::{sampled, walker};

/// The walker with its own clips retargeted to itself and a crossfade of 0.4 s.
fn walker_with_crossfade() -> Library {
    let mut library = walker();
    let asset = library.active().expect("a model").asset.clone();
    let map = JointMap { crossfade_secs: 0.4, ..propose(&asset, &asset).to_map(&asset, &asset) };
    library.set_motions(vec![Motion::new("dance.glb".to_owned(), asset)]);
    library.borrow_each(vec![Some(map)]);
    assert_eq!(library.borrow_errors(), []);
    library
}

fn pose(library: &Library, state: &ViewerState) -> gaitway_character::anim::Pose {
    sampled(library.active().expect("a model"), state).pose
}

#[test]
fn changing_the_clip_fades_for_exactly_the_duration() {
    let library = walker_with_crossfade();
    let own = library.active().expect("a model").asset.clips.len();
    let mut state = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::called("0"), ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    apply(&mut state, &library, Command::Advance(0.3));
    let before = pose(&library, &state);
    apply(&mut state, &library, Command::SetClip(ClipChoice::called(&own.to_string())));
    for (now, before) in pose(&library, &state).locals().zip(before.locals()) {
        assert!(now.rotation.angle_between(before.rotation) < 1e-3, "nothing jumps");
        assert!(now.translation.abs_diff_eq(before.translation, 1e-6), "nothing jumps");
    }
    apply(&mut state, &library, Command::Advance(0.2));
    assert!(state.character.playhead.fade.is_some());
    let (mixed, alone) = (
        pose(&library, &state),
        pose(
            &library,
            &ViewerState {
                character: CharacterView {
                    playhead: Playhead { fade: None, ..state.character.playhead.clone() },
                    ..state.clone().character
                },
                ..state.clone()
            },
        ),
    );
    assert_ne!(mixed, alone);
    assert!(mixed.locals().all(|local| local.rotation.is_normalized()));
    apply(&mut state, &library, Command::Advance(0.21));
    assert_eq!(state.character.playhead.fade, None);
}

#[test]
fn nothing_fades_while_paused_or_between_the_models_own_clips() {
    let library = walker_with_crossfade();
    let change = |state: &mut ViewerState, clip: usize| {
        apply(state, &library, Command::SetClip(ClipChoice::called(&clip.to_string())));
        state.character.playhead.fade.clone()
    };
    let mut playing = ViewerState::default();
    assert_eq!(change(&mut playing, 1), None, "the model's own clips have no map");
    let own = library.active().expect("a model").asset.clips.len();
    let mut paused =
        ViewerState { playback: Playback { playing: false, ..Playback::default() }, ..ViewerState::default() };
    assert_eq!(change(&mut paused, own), None);
}

/// The rest pose has no time of its own, and a clip that ends before the crossfade ends as itself.
#[test]
fn a_crossfade_into_the_rest_pose_or_past_the_end_of_a_clip_completes() {
    let library = walker_with_crossfade();
    let own = library.active().expect("a model").asset.clips.len();
    let playing = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::called(&own.to_string()), ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let mut resting = playing.clone();
    apply(&mut resting, &library, Command::Advance(0.3));
    apply(&mut resting, &library, Command::SetClip(ClipChoice::RestPose));
    assert!(resting.character.playhead.fade.is_some());
    apply(&mut resting, &library, Command::Advance(0.2));
    assert!(resting.character.playhead.fade.is_some(), "half of it");
    apply(&mut resting, &library, Command::Advance(0.21));
    assert_eq!((resting.character.playhead.fade, resting.character.playhead.time_secs), (None, 0.0));
    let mut once = playing;
    apply(&mut once, &library, Command::SetLoopMode(LoopMode::Once));
    apply(&mut once, &library, Command::SetClip(ClipChoice::First));
    let secs = library.active().expect("a model").clip_at(0).duration_secs();
    apply(&mut once, &library, Command::SetRange(Some(TimeRange { start_secs: 0.0, end_secs: 0.2 })));
    assert!(secs > 0.2);
    apply(&mut once, &library, Command::Advance(0.25));
    assert_eq!((once.character.playhead.fade, once.playback.playing), (None, false));
}
