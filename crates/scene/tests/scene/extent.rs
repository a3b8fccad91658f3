//! Bounds of clips contain every vertex, without much slack.

use gaitway_character::asset::SceneJoints;
use gaitway_character::mesh::{Bounds, SkinningMode};
use gaitway_scene::frame::{Frame, evaluate, pose_document};
use gaitway_scene::library::{ClipId, Library, Take};
use gaitway_scene::state::{CharacterView, ClipChoice, Display, Playhead, ViewerState};
use glam::Vec3;

use crate::data::{open, walker};

/// The exact bounds of what the reference implementation draws.
pub fn exact(library: &Library, state: &ViewerState) -> Bounds {
    let document = pose_document(library, state);
    let meshes = document["meshes"].as_array().expect("meshes");
    let numbers = meshes.iter().flat_map(|mesh| mesh["positions"].as_array().expect("positions"));
    let numbers: Vec<f32> = numbers.filter_map(|number| number.as_f64()).map(|number| number as f32).collect();
    Bounds::of(numbers.chunks_exact(3).map(Vec3::from_slice))
}

fn check(library: &Library, clip: usize) {
    let model = library.active().expect("a model");
    let duration_secs = f64::from(model.asset.clips[clip].duration_secs());
    let whole = Take::new(model, model.clip(&ClipId::Own(clip))).bounds(None, false, &[]);
    let mut union = Bounds::EMPTY;
    // The times that the bounds are computed from.
    for sample in 0..=24 {
        let time_secs = duration_secs * f64::from(sample) / 24.0;
        let state = ViewerState {
            character: CharacterView {
                playhead: Playhead { clip: ClipChoice::called(&clip.to_string()), time_secs, ..Playhead::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        };
        let exact = exact(library, &state);
        let mut frame = Frame::default();
        evaluate(library, &state, 1.0, &mut frame);
        let character = &frame.characters[0];
        let scene = SceneJoints::new(&model.asset, model.asset.default_scene);
        let close = model.pose_bounds(&character.world_from_joint, &character.morph_weights, &scene);
        let slack = 0.02 * exact.diagonal();
        assert!(
            (close.min - slack).cmple(exact.min).all() && (close.max + slack).cmpge(exact.max).all(),
            "{clip} {sample}"
        );
        union = union.union(exact);
    }
    let slack = 0.02 * union.diagonal();
    assert!((whole.min - slack).cmple(union.min).all() && (whole.max + slack).cmpge(union.max).all());
    assert!(whole.diagonal() < 1.35 * union.diagonal(), "{whole:?} around {union:?}");
}

#[test]
fn bounds_of_the_walker() {
    (0..3).for_each(|clip| check(&walker(), clip));
}

#[test]
fn bounds_of_real_characters() {
    for path in ["khronos/Fox/glTF-Binary/Fox.glb", "threejs/Soldier.glb", "threejs/Flamingo.glb", "cosc422/dwarf.glb"]
    {
        if let Some(library) = open(path) {
            check(&library, 0);
        }
    }
}

#[test]
fn rest_bounds_are_exact() {
    let state = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
            ..CharacterView::default()
        },
        display: Display { skinning: SkinningMode::Linear, ..Display::default() },
        ..ViewerState::default()
    };
    assert_eq!(walker().active().expect("a model").rest_bounds(), exact(&walker(), &state));
    if let Some(library) = open("khronos/CesiumMan/glTF-Binary/CesiumMan.glb") {
        assert_eq!(library.active().expect("a model").rest_bounds(), exact(&library, &state));
    }
}
