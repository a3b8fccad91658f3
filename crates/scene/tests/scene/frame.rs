//! The contents of frames: models, overlays and picking.

use gaitway_character::anim::{Joint, Pose, Skeleton, Transform, model_from_joint};
use gaitway_character::asset::{Asset, AssetParts, Light, LightKind, MAX_LIGHTS, MeshInstance};
use gaitway_character::mesh::{Geometry, Mesh, SkinningMode};
use gaitway_scene::frame::{Bone, Frame, PickedJoint, evaluate, pick_joint};
use gaitway_scene::library::{ClipId, Library, Model};
use gaitway_scene::state::{
    Background, Channel, CharacterView, ClipChoice, Command, Display, Inspect, Playhead, Selection, Show, ViewerState,
    apply,
};
use glam::{Affine3A, Vec2, Vec3, Vec4Swizzles};

use crate::data::{library_of, moving_box, walker};

fn frame_of(library: &Library, state: &ViewerState) -> Frame {
    let mut frame = Frame::default();
    evaluate(library, state, 1.5, &mut frame);
    frame
}

fn showing(change: impl Fn(&mut Show)) -> ViewerState {
    let mut state = ViewerState::default();
    change(&mut state.display.show);
    state
}

/// A joint of the walker, by index in the file.
const HEAD: usize = 5;

#[test]
fn without_a_model_the_frame_is_empty() {
    let state = ViewerState {
        display: Display { background: Background::Color([1, 2, 3]), ..Display::default() },
        ..ViewerState::default()
    };
    let frame = frame_of(&Library::default(), &state);
    assert!(frame.characters.is_empty() && frame.bones.is_empty() && frame.bounds.is_empty());
    assert_eq!(frame.look.background, state.display.background);
    assert!(frame.view.projection_from_view.is_finite());
}

/// A metre-wide triangle with a weak sun and point lights of equal strength at increasing distances.
#[test]
fn of_many_lights_the_strongest_are_drawn() {
    let places: Vec<f32> = (0..12).map(|index| 12.0 - index as f32).collect();
    let nodes = places.iter().map(|&x| Joint {
        rest: Transform { translation: Vec3::new(x, 0.0, 0.0), ..Transform::IDENTITY },
        ..Joint::default()
    });
    let skeleton = Skeleton::new(nodes.chain([Joint::default()]).collect()).expect("no parents");
    let node = |index| skeleton.joint_of_source(index).expect("a node");
    let light = |index, kind, intensity| Light {
        joint: node(index),
        color: Vec3::ONE,
        intensity,
        range: None,
        kind,
        number: 0,
    };
    let mut lights: Vec<Light> = (0..places.len()).map(|index| light(index, LightKind::Point, 40.0)).collect();
    lights.push(light(12, LightKind::Directional, 2.0));
    let positions = vec![Vec3::splat(-0.5), Vec3::splat(0.5), Vec3::new(0.5, -0.5, 0.0)];
    let geometry = Geometry { file_vertices: 3, positions, indices: vec![0, 1, 2], ..Geometry::default() };
    let parts = AssetParts {
        meshes: vec![Mesh { primitives: vec![geometry], ..Mesh::default() }],
        instances: vec![MeshInstance::new(node(12), 0, None)],
        lights,
        skeleton,
        ..AssetParts::default()
    };
    let asset = Asset::new(parts).expect("indices in range");
    let frame = frame_of(&library_of(Model::new("lights".to_owned(), asset, Vec::new())), &ViewerState::default());
    assert_eq!(frame.lights.len(), MAX_LIGHTS);
    assert!(frame.lights.iter().any(|light| light.kind == LightKind::Directional), "the sun is everywhere");
    let farthest = frame.lights.iter().map(|light| light.position.x).fold(0.0, f32::max);
    assert_eq!(farthest, 7.0, "the nearest of the others");
}

#[test]
fn equal_states_give_equal_frames() {
    let library = walker();
    let state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, ..showing(|show| show.skeleton = true).character.playhead },
            ..showing(|show| show.skeleton = true).character
        },
        ..showing(|show| show.skeleton = true)
    };
    let fresh = frame_of(&library, &state);
    let mut used = frame_of(
        &library,
        &ViewerState {
            character: CharacterView {
                playhead: Playhead { time_secs: 0.9, ..Playhead::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        },
    );
    evaluate(&library, &state, 1.5, &mut used);
    assert_eq!(used.characters[0].palette, fresh.characters[0].palette);
    assert_eq!(used.bones, fresh.bones);
    assert_eq!(used.view.view_from_world, fresh.view.view_from_world);
}

#[test]
fn the_frame_carries_the_pose_and_clip_it_was_made_from() {
    let mut library = walker();
    let clip = ClipChoice::called("Wave");
    let mut state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 1.3, clip, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    state.character.edits.pose.insert(HEAD, [30.0, 0.0, 0.0]);
    let mut frame = frame_of(&library, &state);
    let skeleton = library.active().expect("the walker").asset.skeleton.clone();
    let mut world_from_joint = Vec::new();
    model_from_joint(&skeleton, frame.pose(), Affine3A::IDENTITY, &mut world_from_joint);
    assert_eq!(world_from_joint, frame.characters[0].world_from_joint);
    assert_eq!(frame.pose().morph_weights, frame.characters[0].morph_weights);
    assert_eq!((frame.clip.clone(), frame.look.time_secs), (Some(ClipId::Own(2)), 1.3));
    state.character.playhead.clip = ClipChoice::RestPose;
    evaluate(&library, &state, 1.5, &mut frame);
    assert_eq!((frame.clip.clone(), frame.look.time_secs), (None, 0.0));
    library = Library::default();
    evaluate(&library, &state, 1.5, &mut frame);
    assert_eq!((frame.clip.clone(), frame.pose()), (None, &Pose::default()));
}

#[test]
fn each_instance_has_its_own_palette() {
    for skinning in [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion] {
        let frame = frame_of(
            &walker(),
            &ViewerState { display: Display { skinning, ..Display::default() }, ..ViewerState::default() },
        );
        let character = &frame.characters[0];
        let ranges: Vec<_> = character.draws.iter().map(|draw| draw.palette.clone()).collect();
        assert_eq!((ranges, character.palette.len()), (vec![0..22, 22..44], 44));
        assert_eq!(character.draws[1].morph_weights, 0..1);
    }
    assert_eq!(
        frame_of(&moving_box(0.5, &[0.0], &[Vec3::ZERO]), &ViewerState::default()).characters[0].palette.len(),
        1
    );
}

#[test]
fn manual_morph_weights_override_the_clip() {
    let mut state = ViewerState::default();
    state.character.edits.morph.insert(0, 0.75);
    // Neither a panic nor an effect: the link may be from another model.
    state.character.edits.morph.insert(99, 1.0);
    assert_eq!(frame_of(&walker(), &state).characters[0].morph_weights, [0.75]);
}

#[test]
fn the_heat_map_shows_the_selected_joint() {
    let selection = Selection { joint: Some(HEAD), ..Selection::default() };
    let state =
        ViewerState { selection, inspect: Inspect { weights: true, ..Inspect::default() }, ..ViewerState::default() };
    assert_eq!(frame_of(&walker(), &state).characters[0].draws[0].heat_joint, Some(HEAD as u32));
    let library = moving_box(0.5, &[0.0], &[Vec3::ZERO]);
    let of_box = |joint| {
        frame_of(&library, &ViewerState { selection: Selection { joint, ..state.selection }, ..state.clone() })
            .characters[0]
            .draws[0]
            .heat_joint
    };
    assert_eq!((of_box(Some(0)), of_box(Some(5)), of_box(None)), (Some(0), None, None));
    assert_eq!(
        frame_of(
            &walker(),
            &ViewerState {
                selection: Selection { joint: Some(HEAD), ..Selection::default() },
                ..ViewerState::default()
            }
        )
        .characters[0]
            .draws[0]
            .heat_joint,
        None
    );
}

#[test]
fn bones_join_the_skins_joints_and_end_in_stubs() {
    let frame = frame_of(&walker(), &showing(|show| show.skeleton = true));
    // 22 joints: 21 of them have a parent; the ends are head, hands and toes. The meshes' nodes aren't joints. Bones
    // from Root to Hips and so on; all have a length.
    assert_eq!(frame.bones.len(), 21 + 5);
    assert!(frame.bones.iter().all(|bone| bone.joint < 22 && bone.head != bone.tail && bone.radius > 0.0));
    assert!(frame.bones.iter().all(|bone| bone.visible));
    let hidden = frame_of(&walker(), &ViewerState::default());
    assert!(!hidden.bones.is_empty() && hidden.bones.iter().all(|bone| !bone.visible), "for picking");
}

#[test]
fn picking_finds_the_nearest_bone() {
    let frame = frame_of(&walker(), &showing(|show| show.skeleton = true));
    let shin = frame.bones.iter().find(|bone| bone.joint == 15).copied().expect("the left shin");
    let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
    let middle = projection_from_world * shin.head.midpoint(shin.tail).extend(1.0);
    let point = middle.xy() / middle.w;
    assert_eq!(pick_joint(&frame, point, 0.02), Some(PickedJoint::Model(15)));
    assert_eq!(pick_joint(&frame, Vec2::new(0.95, 0.95), 0.02), None);
}

/// Half of the places on a ball are on the parent's bone, too, which ends there.
#[test]
fn picking_a_joints_ball_finds_that_joint() {
    let frame = frame_of(&walker(), &showing(|show| show.skeleton = true));
    let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
    let head = |bone: &Bone| {
        let at = projection_from_world * bone.head.extend(1.0);
        at.xy() / at.w
    };
    let mut alone = 0;
    for bone in &frame.bones {
        let others = frame.bones.iter().filter(|other| other.joint != bone.joint);
        if others.map(head).any(|other| other.distance(head(bone)) < 0.05) {
            continue;
        }
        alone += 1;
        for offset in [Vec2::ZERO, Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
            let picked = pick_joint(&frame, head(bone) + 0.004 * offset, 0.03);
            assert_eq!(picked, Some(PickedJoint::Model(bone.joint as usize)), "{offset}");
        }
    }
    assert!(alone > 10, "{alone}");
}

#[test]
fn weights_take_the_place_of_a_channel_until_one_is_chosen() {
    let (library, mut state) = (walker(), ViewerState::default());
    apply(&mut state, &library, Command::SetChannel(Channel::BaseColor));
    apply(&mut state, &library, Command::SelectJoint(Some(HEAD)));
    assert_eq!(frame_of(&library, &state).look.channel, Channel::BaseColor);
    apply(&mut state, &library, Command::SetInspect(Inspect { weights: true, ..Inspect::default() }));
    assert_eq!((frame_of(&library, &state).look.channel, state.shows_weights()), (Channel::Shaded, true));
    apply(&mut state, &library, Command::SelectJoint(None));
    assert_eq!(frame_of(&library, &state).look.channel, Channel::BaseColor, "there are no weights to show");
    apply(&mut state, &library, Command::SelectJoint(Some(HEAD)));
    apply(&mut state, &library, Command::SetChannel(Channel::Normal));
    assert_eq!((frame_of(&library, &state).look.channel, state.shows_weights()), (Channel::Normal, false));
}

#[test]
fn overlays_are_drawn_if_enabled() {
    assert!(frame_of(&walker(), &ViewerState::default()).lines.is_empty());
    assert_eq!(frame_of(&walker(), &showing(|show| show.bounds = true)).lines.len(), 12);
    let selection = Selection { joint: Some(HEAD), ..Selection::default() };
    let mut state = showing(|show| show.bounds = true);
    state.selection = selection;
    let mut frame = frame_of(&walker(), &state);
    assert_eq!(frame.lines.len(), 12 + 3);
    frame.remove_axes();
    assert_eq!(frame.lines.len(), 12, "the bounds stay");
    assert_eq!(frame_of(&walker(), &showing(|show| show.grid = false)).look.grid, None);
}

#[test]
fn any_aspect_ratio_gives_finite_matrices() {
    for aspect in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-9, 1e9] {
        let mut frame = Frame::default();
        evaluate(&walker(), &ViewerState::default(), aspect, &mut frame);
        assert!(frame.view.projection_from_view.is_finite() && frame.view.view_from_world.is_finite(), "{aspect}");
    }
}
