//! Facts about real files, from other programs and the files' own pages.

use gaitway_character::asset::Asset;
use gaitway_scene::frame::{Frame, evaluate, pose_document};
use gaitway_scene::library::{ClipId, Library, Take, inspect};
use gaitway_scene::state::{CharacterView, ClipChoice, Playhead, ViewerState, active_clip, front_yaw_radians};

use crate::by_place::ByPlace;
use crate::data::open;

struct Facts {
    path: &'static str,
    joints: usize,
    vertices: usize,
    clips: &'static [(&'static str, f64)],
}

fn check(facts: &Facts) {
    let Some(library) = open(facts.path) else { return };
    let document = inspect(library.active().expect("a model"), &[]);
    assert_eq!(document["joints"], facts.joints, "{}", facts.path);
    assert_eq!(document["vertices"], facts.vertices, "{}", facts.path);
    for (name, duration_secs) in facts.clips {
        let clips = document["clips"].as_array().expect("clips");
        let clip = clips.iter().find(|clip| clip["name"] == *name).unwrap_or_else(|| panic!("{name}: {clips:?}"));
        let found = clip["duration_secs"].as_f64().expect("a number");
        // The facts are rounded to milliseconds.
        assert!((found - duration_secs).abs() < 6e-4 + 1e-3 * duration_secs, "{} {name}: {found}", facts.path);
    }
}

fn asset(library: &Library) -> &Asset {
    &library.active().expect("a model").asset
}

#[test]
fn counts_and_durations() {
    let all = [
        Facts {
            path: "khronos/Fox/glTF-Binary/Fox.glb",
            joints: 24,
            vertices: 1728,
            clips: &[("Survey", 3.417), ("Walk", 0.708), ("Run", 1.158)],
        },
        Facts { path: "khronos/CesiumMan/glTF-Binary/CesiumMan.glb", joints: 19, vertices: 3273, clips: &[("", 2.0)] },
        Facts { path: "cosc422/dwarf.glb", joints: 40, vertices: 1479, clips: &[("AnimationSet0", 2.2)] },
        Facts {
            path: "cosc422/ArmyPilot.glb",
            joints: 63,
            vertices: 16091,
            clips: &[
                ("Run_Forwards", 2.267),
                ("Walk", 1.467),
                ("Idle", 8.4),
                ("Idle_Reload", 10.27),
                ("Idle_Aim", 0.067),
            ],
        },
        Facts {
            path: "threejs/Soldier.glb",
            joints: 49,
            vertices: 7434,
            clips: &[("Idle", 1.967), ("Run", 0.7), ("Walk", 1.033)],
        },
    ];
    all.iter().for_each(check);
}

#[test]
fn a_skinned_mesh_ignores_its_nodes_transform() {
    // ArmyPilot's mesh is attached to the joint Pelvis: moved by that node's own transform it would be far above its
    // skeleton.
    let Some(library) = open("cosc422/ArmyPilot.glb") else { return };
    let bounds = library.active().expect("a model").rest_bounds();
    let (mut frame, rest) = (
        Frame::default(),
        ViewerState {
            character: CharacterView {
                playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        },
    );
    evaluate(&library, &rest, 1.0, &mut frame);
    let slack = 0.02 * bounds.diagonal();
    let skeleton = &asset(&library).skeleton;
    // Joints inside a limb, hence inside the surface that they deform.
    for name in
        ["Pelvis", "LLegUpper", "LLegCalf", "LLegAnkle", "Spine1", "Spine2", "Neck1", "RArmForearm1", "RArmHand"]
    {
        let joint = skeleton.find(name).unwrap_or_else(|| panic!("{name}"));
        let place = glam::Vec3::from(frame.characters[0].world_from_joint[joint.get()].translation);
        let inside = place.cmpge(bounds.min - slack).all() && place.cmple(bounds.max + slack).all();
        assert!(inside, "{name}: {place} outside {bounds:?}");
    }
}

#[test]
fn the_frame_rate_is_detected_from_the_keys() {
    for (path, clip, expected) in
        [("cosc422/ArmyPilot.glb", "Walk", 30.0), ("khronos/Fox/glTF-Binary/Fox.glb", "Walk", 24.0)]
    {
        let Some(library) = open(path) else { return };
        let model = library.active().expect("a model");
        let state = ViewerState {
            character: CharacterView {
                playhead: Playhead { clip: ClipChoice::called(clip), ..Playhead::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        };
        let clip = active_clip(model, &state).expect("the clip");
        assert_eq!(clip.frames_per_sec(), expected, "{path}");
    }
}

#[test]
fn nodes_are_numbered_as_in_the_file() {
    let Some(library) = open("cosc422/ArmyPilot.glb") else { return };
    let document = pose_document(&library, &ViewerState::default());
    let name = |node: usize| document["nodes"][node]["name"].as_str().unwrap_or_default().to_owned();
    assert_eq!([0, 1, 2, 4].map(name), ["RootFrame", "RootFrame", "Pelvis", "LLegCalf"]);
}

#[test]
fn a_skeleton_without_a_mesh_is_drawn() {
    let Some(library) = open("cosc422/mannequin_run.glb") else { return };
    let mut frame = Frame::default();
    evaluate(&library, &ViewerState::default(), 1.0, &mut frame);
    assert!(frame.characters[0].draws.is_empty() && frame.bones.len() > 50);
    assert!(!frame.bounds.is_empty());
}

#[test]
fn following_keeps_a_runner_in_view() {
    // Root motion above the skin: the runner leaves the view unless the camera follows.
    let Some(library) = open("cosc422/mannequin_run.glb") else { return };
    let model = library.active().expect("a model");
    assert!(model.clip_at(0).root().is_some());
    let take = Take::new(model, model.clip(&ClipId::Own(0)));
    let [in_place, whole] = [true, false].map(|in_place| take.bounds(None, in_place, &[]).size());
    assert!(in_place.max_element() < 0.9 * whole.max_element(), "{in_place} {whole}");
}

/// Expected values are from the images on the files' pages, and from VRM 0's rule that avatars face −Z.
#[test]
fn bodies_are_framed_from_the_front() {
    let fronts = [
        ("threejs/Soldier.glb", 180.0),
        ("vrm/vrm0_cryptovoxels.vrm", 180.0),
        ("khronos/CesiumMan/glTF-Binary/CesiumMan.glb", 90.0),
        ("threejs/Xbot.glb", 0.0),
        ("kaykit/Knight.glb", 0.0),
        ("khronos/Fox/glTF-Binary/Fox.glb", 0.0),
    ];
    for (path, degrees) in fronts {
        let Some(library) = open(path) else { continue };
        assert_eq!(front_yaw_radians(&library, &ViewerState::default()).to_degrees(), degrees, "{path}");
    }
}
