//! The built-in character is valid and walks plausibly.

use gaitway_character::anim::JointIndex;
use gaitway_scene::frame::{Frame, evaluate, pose_document};
use gaitway_scene::library::Library;
use gaitway_scene::state::{CharacterView, ClipChoice, Playhead, ViewerState};
use glam::Vec3;

use crate::data::walker;

fn at(clip: &str, time_secs: f64) -> ViewerState {
    ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::called(clip), time_secs, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    }
}

fn joint_place(library: &Library, frame: &Frame, name: &str) -> Vec3 {
    let skeleton = &library.active().expect("a model").asset.skeleton;
    let JointIndex(joint) = skeleton.find(name).expect("a joint of the walker");
    frame.characters[0].world_from_joint[joint as usize].translation.into()
}

#[test]
fn the_walker_is_complete() {
    let library = walker();
    let asset = &library.active().expect("a model").asset;
    assert_eq!(asset.skins[0].joints().len(), 22);
    assert_eq!(asset.clips.iter().map(|clip| clip.name()).collect::<Vec<_>>(), ["Walk", "Idle", "Wave"]);
    assert_eq!(asset.meshes[1].target_names, ["Blink"]);
    for geometry in asset.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        assert_eq!(geometry.validate(Some(22)), Ok(()));
        for vertex in 0..geometry.positions.len() {
            let sum: f32 = geometry.influences.of_vertex(vertex).map(|(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-6);
        }
        assert!(geometry.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
    }
}

#[test]
fn faces_point_outwards() {
    // The signed volume of a closed surface is positive when its triangles wind counter-clockwise seen from outside.
    let library = walker();
    let asset = &library.active().expect("a model").asset;
    for geometry in [&asset.meshes[0].primitives[0], &asset.meshes[1].primitives[0]] {
        let volume: f32 = geometry
            .indices
            .chunks_exact(3)
            .map(|triangle| {
                let [a, b, c] = [0, 1, 2].map(|corner| geometry.positions[triangle[corner] as usize]);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        assert!(volume > 0.0, "{volume}");
    }
}

#[test]
fn a_foot_in_contact_moves_with_the_ground() {
    // From flat foot to heel-off the ankle neither rises nor changes its speed.
    let library = walker();
    let mut frame = Frame::default();
    let mut ankles = Vec::new();
    for part in [0.12, 0.18, 0.24, 0.30] {
        evaluate(&library, &at("Walk", part * 32.0 / 30.0), 1.0, &mut frame);
        ankles.push(joint_place(&library, &frame, "LeftFoot"));
    }
    let speed = (ankles[1] - ankles[0]).z;
    assert!(speed < -0.05);
    for pair in ankles.windows(2) {
        assert!((pair[1] - pair[0] - Vec3::new(0.0, 0.0, speed)).length() < 2e-3, "{ankles:?}");
    }
}

#[test]
fn soles_stay_on_the_ground() {
    let library = walker();
    for (clip, duration_secs) in [("Walk", 32.0 / 30.0), ("Idle", 4.0), ("Wave", 2.8)] {
        for sample in 0..16 {
            let document = pose_document(&library, &at(clip, duration_secs * f64::from(sample) / 16.0));
            let body = document["meshes"][0]["positions"].as_array().expect("positions");
            let lowest = body.iter().skip(1).step_by(3).filter_map(|y| y.as_f64()).fold(f64::INFINITY, f64::min);
            assert!((-0.012..0.012).contains(&lowest), "{clip} {sample}: {lowest}");
        }
    }
}

#[test]
fn clips_loop_without_a_seam() {
    let library = walker();
    for clip in &library.active().expect("a model").asset.clips {
        let name = clip.name().to_owned();
        let (mut first, mut last) = (Frame::default(), Frame::default());
        evaluate(&library, &at(&name, 0.0), 1.0, &mut first);
        evaluate(&library, &at(&name, f64::from(clip.duration_secs())), 1.0, &mut last);
        assert_eq!(first.characters[0].world_from_joint, last.characters[0].world_from_joint, "{name}");
    }
}
