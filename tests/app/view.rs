//! Camera rules that involve the viewport: what stays in view while settings change.

use gaitway::ui::{Tab, text};
use gaitway_scene::frame::travelled;
use gaitway_scene::state::{CameraChoice, Command, Edited, Inspect, OrbitCamera, Show};
use glam::Vec3;

use crate::by_place::motion_at;
use crate::desk::{Desk, desk};

fn orbit(desk: &Desk) -> OrbitCamera {
    let CameraChoice::Orbit(orbit) = desk.state().camera else { panic!("{:?}", desk.state().camera) };
    orbit
}

#[test]
fn comparing_keeps_the_centre_in_view_and_restores_the_camera() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.command(Command::Orbit { yaw_radians: 0.4, pitch_radians: 0.1 });
    let before = orbit(&desk);
    let inspect = desk.state().inspect;
    desk.command(Command::SetInspect(Inspect { split: true, ..inspect }));
    let compared = orbit(&desk);
    assert!(compared.distance > 1.2 * before.distance, "panes are narrower than high");
    assert_eq!(compared.target, before.target);
    desk.command(Command::SetInspect(inspect));
    assert!((orbit(&desk).distance / before.distance - 1.0).abs() < 1e-5);
}

#[test]
fn a_new_model_is_framed_and_a_previous_one_keeps_its_camera() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let show = Show { wireframe: true, ..desk.state().display.show };
    desk.command(Command::SetShow(show));
    let inspect = Inspect { split: true, ..desk.state().inspect };
    desk.command(Command::SetInspect(inspect));
    desk.open(&["sample:creature".into()]);
    assert_eq!(desk.state().display.show, show, "display settings are kept");
    assert_eq!(desk.state().inspect, Inspect::default());
    desk.press("Pilot");
    assert_eq!((desk.state().display.show, desk.state().inspect), (show, inspect));
}

#[test]
fn each_step_of_undo_and_redo_is_told_even_if_the_words_are_the_same() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    for exposure in [1.0, 2.0] {
        desk.command(Command::SetExposure(exposure));
        assert_eq!(desk.notice(), None, "a later edit makes it new");
        desk.undo();
        assert_eq!(desk.notice(), Some(&*text::stepped(true, Some(Edited::Display), 0)));
        desk.redo();
        assert_eq!(desk.notice(), Some(&*text::stepped(false, Some(Edited::Display), 1)));
        desk.undo();
    }
}

#[test]
fn a_new_source_of_a_joint_is_told() {
    let Some(mut desk) = desk("sample:mannequin") else { return };
    desk.open(&["sample:mannequin_run".into()]);
    let skeleton = &desk.library().active().expect("a model").asset.skeleton;
    let number = |name: &str| skeleton.source_index(skeleton.find(name).expect("a joint of the mannequin"));
    let [neck, head] = ["mixamorig:Neck", "mixamorig:Head"].map(number);
    for (source, told) in
        [(Some(head), "mixamorig:Neck follows mixamorig:Head."), (None, "mixamorig:Neck has no source.")]
    {
        desk.command(Command::SetSource { motion: motion_at(desk.library(), 0), target: neck, source });
        assert_eq!(desk.notice(), Some(told));
    }
}

/// The pointer rests on a vertex while a link opens another model, which has other joints and meshes.
#[test]
fn a_vertex_is_forgotten_with_its_model() {
    let Some(mut desk) = desk("sample:ssd") else { return };
    desk.press(text::VERTEX_PROBE);
    desk.point_at(egui::pos2(640.0, 330.0));
    assert!(desk.shows("Vertex "), "the pointer is on the model");
    for model in ["sample:pilot", "sample:morphs", "sample:creature", "sample:ssd"] {
        desk.open(&[model.into()]);
        assert_eq!(desk.active(), model);
    }
}

#[test]
fn following_starts_and_stops_without_a_jump() {
    let Some(mut desk) = desk("sample:mannequin") else { return };
    desk.open(&["sample:mannequin_run".into()]);
    desk.command(Command::Orbit { yaw_radians: 0.4, pitch_radians: 0.1 });
    desk.command(Command::Seek(0.5));
    let travel = travelled(desk.library(), desk.state());
    assert!(travel.length() > 0.5, "it runs: {travel}");
    let before = orbit(&desk).target;
    desk.command(Command::SetFollow(true));
    assert!((orbit(&desk).target + travel).distance(before) < 1e-4, "the travel is added while following");
    desk.command(Command::Seek(0.0));
    desk.command(Command::SetFollow(false));
    assert!(orbit(&desk).target.distance(before - travel) < 1e-4);
    assert_eq!(travelled(desk.library(), desk.state()), Vec3::ZERO, "no travel yet");
}

/// Without multisampling, samples accumulate frame by frame; with it, the first frame has them all.
#[test]
fn a_paused_picture_is_refined_and_then_left_alone() {
    let Some(mut desk) = desk("sample:walker") else { return };
    desk.settle();
    let settled = desk.screenshot();
    // A screenshot doesn't wait for refinement.
    desk.command(Command::SetExposure(1.0));
    assert!(desk.screenshot() != settled);
    desk.command(Command::SetExposure(0.0));
    assert!(desk.screenshot() == settled, "the same view gives the same picture");
    desk.settle();
    assert!(desk.screenshot() == settled, "the picture doesn't change any more");
}

#[test]
fn the_info_tab_measures_what_is_drawn_and_comes_to_rest() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.press(Tab::Info.label());
    desk.settle();
    for (row, nothing) in [
        (text::DRAW_CALLS, "0"),
        (text::DRAWN_TRIANGLES, "0"),
        (text::GEOMETRY_MEMORY, "0 MB"),
        (text::IMAGE_MEMORY, "0 MB"),
    ] {
        assert!(desk.shows(&text::labelled(row, "")), "{row}");
        assert!(!desk.shows(&text::labelled(row, nothing)), "{row} should have been measured");
    }
}
