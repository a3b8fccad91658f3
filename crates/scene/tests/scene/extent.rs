//! Bounds of clips contain every vertex, without much slack.

use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, Keys, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts, Camera, CameraProjection, Light, LightKind, SceneJoints};
use gaitway_character::mesh::{Bounds, SkinningMode};
use gaitway_scene::frame::{Frame, evaluate, pose_document};
use gaitway_scene::library::{ClipId, Library, Model, Take};
use gaitway_scene::state::{CharacterView, ClipChoice, Display, Playhead, ViewerState};
use glam::Vec3;

use crate::data::{library_of, open, walker};

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

/// Cameras of MotionBuilder are 150 m away.
#[test]
fn cameras_lights_and_hidden_nodes_are_no_bones() {
    let joint = |name: &str, parent: Option<usize>, at: Vec3| Joint {
        name: name.to_owned(),
        parent,
        rest: Transform::from_translation(at),
        ..Joint::default()
    };
    let library = |joints: Vec<Joint>, extras: fn(&Skeleton, &mut AssetParts)| {
        let skeleton = Skeleton::new(joints).expect("a tree");
        let mut clip = ClipBuilder::new("Move", &skeleton);
        let animated =
            (0..skeleton.len()).filter(|index| index % 2 == 0).filter_map(|index| skeleton.joint_of_source(index));
        for joint in animated {
            let keys = Keys::Translation(vec![skeleton.rest().local(joint).translation]);
            clip.channel(joint, Interpolation::Linear, &[0.0], keys).expect("fine keys");
        }
        let clips = vec![clip.build()];
        let mut parts = AssetParts { format: "test", clips, ..AssetParts::default() };
        extras(&skeleton, &mut parts);
        let asset = Asset::new(AssetParts { skeleton, ..parts }).expect("indices in range");
        library_of(Model::new("bones".to_owned(), asset, Vec::new()))
    };
    let body = || vec![joint("hips", None, Vec3::Y), joint("spine", Some(0), Vec3::Y), joint("head", Some(1), Vec3::Y)];
    let far = Vec3::X * 150.0;
    let helpers = [
        joint("producer", None, far),
        joint("", Some(3), Vec3::ZERO),
        joint("lamp", None, -far),
        joint("hidden", None, far),
        joint("below", Some(6), far),
        joint("eye", Some(2), far),
        joint("", Some(8), Vec3::ZERO),
    ];
    let alone = library(body(), |_, _| ());
    let with_helpers = library([body(), helpers.to_vec()].concat(), |skeleton, parts| {
        let of = |index: usize| skeleton.joint_of_source(index).expect("in range");
        let projection = CameraProjection::Orthographic { y_mag: 1.0, near: 0.1, far: 1.0 };
        parts.cameras =
            [4, 9].map(|index| Camera { name: String::new(), joint: of(index), number: 0, projection }).into();
        let (color, kind) = (Vec3::ONE, LightKind::Point);
        parts.lights = vec![Light { joint: of(5), number: 0, color, intensity: 1.0, range: None, kind }];
        parts.hidden = vec![of(6)];
    });
    let [expected, found] = [&alone, &with_helpers].map(|library| {
        let mut frame = Frame::default();
        evaluate(library, &ViewerState::default(), 1.0, &mut frame);
        let model = library.active().expect("a model");
        (frame.bones.len(), frame.bounds, model.rig().joint_count(&model.asset), model.rest_bounds())
    });
    assert_eq!(found, expected);
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
