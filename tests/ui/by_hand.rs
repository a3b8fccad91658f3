//! Posing joints manually, comparing skinning methods, saving images and videos.

use egui::{PointerButton, Pos2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{RecordingFormat, RecordingProgress, Saved, Sheet, Tab, UiAction, VideoSettings, text};
use gaitway_character::mesh::DeformedVertices;
use gaitway_retarget::Verdict;
use gaitway_scene::frame::{pick_joint, pick_vertex};
use gaitway_scene::state::{ClipChoice, Command, Inspect, Show};

use crate::bench::{Bench, NARROW, WIDE, drag, motion_bench, painted, press, press_key, sample_bench};
use crate::motion::reach;

/// The left shin of the walker, as the file numbers it.
const SHIN: usize = 15;

fn turning(size: [f32; 2]) -> Harness<'static, Bench> {
    let mut harness = sample_bench(size);
    harness.state_mut().change(|state| {
        state.selection.joint = Some(SHIN);
    });
    harness.state_mut().change(|state| {
        state.character.playhead.clip = ClipChoice::RestPose;
    });
    harness.state_mut().panels.joint_card.is_posing = true;
    harness.run();
    harness
}

#[test]
fn the_viewport_says_that_joints_are_posed_and_ends_it() {
    for size in [WIDE, NARROW] {
        let mut harness = turning(size);
        harness.state_mut().panels.layout.tab = Tab::Info;
        harness.run();
        assert!(harness.query_by_label(text::POSE_MANUALLY).is_none());
        assert!(harness.query_by_label(text::POSING).is_some());
        press(&mut harness, text::DONE_POSING);
        assert!(harness.query_by_label(text::POSING).is_none());
        assert!(!harness.state().panels.joint_card.is_posing);
    }
}

fn place_of_joint(bench: &Bench) -> Pos2 {
    let asset = &bench.library().active().expect("a model").asset;
    let joint = asset.skeleton.joint_of_source(SHIN).expect("a joint");
    let world = bench.frame.characters[0].world_from_joint[joint.get()].translation;
    let view = &bench.frame.view;
    let at = view.projection_from_view * view.view_from_world * world.extend(1.0);
    let (x, y) = (0.5 + 0.5 * at.x / at.w, 0.5 - 0.5 * at.y / at.w);
    bench.viewport.min + vec2(x * bench.viewport.width(), y * bench.viewport.height())
}

#[test]
fn a_click_on_the_surface_selects_the_joint_that_moves_it_most() {
    let mut harness = sample_bench(WIDE);
    let (place, joint) = {
        let bench = harness.state();
        let (frame, model) = (&bench.frame, bench.library().active().expect("a model"));
        let mut scratch = DeformedVertices::default();
        let mut far_from_bones = (0..10_000).filter_map(|cell| {
            let part = 0.01 * vec2((cell % 100) as f32, (cell / 100) as f32);
            let point = glam::vec2(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y);
            let choice = pick_vertex(model, frame, &frame.characters[0], point, &mut scratch)?;
            pick_joint(frame, point, 0.06)
                .is_none()
                .then_some((bench.viewport.min + part * bench.viewport.size(), choice))
        });
        let (place, choice) = far_from_bones.next().expect("the chest is wide");
        let instance = &model.asset.instances[choice.instance];
        let influences = &model.asset.meshes[instance.mesh].primitives[choice.primitive].influences;
        let at = choice.vertex * influences.stride..(choice.vertex + 1) * influences.stride;
        let strongest = at.max_by(|&a, &b| influences.weights[a].total_cmp(&influences.weights[b])).expect("a weight");
        let skin = &model.asset.skins[instance.skin.expect("a skin")];
        let joint = skin.joints()[influences.joints[strongest] as usize];
        (place, model.asset.skeleton.source_index(joint))
    };
    assert_eq!(drag(&mut harness, place, place, PointerButton::Primary), [Command::SelectJoint(Some(joint))]);
    let mut hidden = sample_bench(WIDE);
    hidden.state_mut().change(|state| {
        state.selection.joint = Some(SHIN);
        state.display.show.mesh = false;
    });
    hidden.run();
    let commands = drag(&mut hidden, place, place, PointerButton::Primary);
    assert_eq!(commands, [Command::SelectJoint(None)], "a hidden surface isn't hit");
}

#[test]
fn a_click_beside_an_open_menu_only_closes_it() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, text::EXPORT);
    let place = place_of_joint(harness.state());
    for expected in [None, Some(SHIN)] {
        let is_open = egui::Popup::is_any_open(&harness.ctx);
        assert_eq!(is_open, expected.is_none());
        harness.event(egui::Event::PointerMoved(place));
        harness.run();
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, egui::Modifiers::NONE);
            harness.event(egui::Event::PointerButton { pos: place, button, pressed, modifiers });
            harness.run();
        }
        assert_eq!(harness.state().state().selection.joint, expected);
    }
}

fn angles(commands: &[Command]) -> [f32; 3] {
    let Some(Command::SetPose { joint: SHIN, degrees: Some(degrees) }) = commands.last() else {
        panic!("{commands:?}")
    };
    *degrees
}

#[test]
fn sliders_turn_the_chosen_joint_and_it_can_be_given_back() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.selection.joint = Some(SHIN);
    });
    harness.run();
    assert!(harness.query_by_label(text::POSE_ANGLES[0]).is_none());
    assert!(harness.query_by_label_contains(text::RESET_JOINT).is_none());
    press(&mut harness, text::POSE_MANUALLY);
    harness.get_by_label(text::POSE_ANGLES[0]).set_value_accesskit(40.0);
    harness.run();
    assert!((harness.state().state().character.edits.pose[&SHIN][0] - 40.0).abs() < 0.1);
    assert_eq!(reach(&mut harness, text::RESET_JOINT), [Command::SetPose { joint: SHIN, degrees: None }]);
    harness.get_by_label(text::POSE_ANGLES[2]).set_value_accesskit(-20.0);
    harness.run();
    assert!(harness.query_by_label_contains(text::RESET_ALL).is_none(), "it is the only one");
    harness.state_mut().change(|state| state.selection.joint = Some(SHIN - 1));
    harness.run();
    assert_eq!(reach(&mut harness, &text::counted(text::RESET_ALL, 1)), [Command::ClearPose]);
    assert!(harness.state().state().character.edits.pose.is_empty());
}

#[test]
fn on_a_phone_the_sliders_scroll_into_sight() {
    let mut harness = sample_bench(NARROW);
    harness.state_mut().change(|state| {
        state.selection.joint = Some(SHIN);
    });
    harness.state_mut().panels.layout.tab = Tab::Scene;
    harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
    harness.run();
    reach(&mut harness, text::POSE_MANUALLY);
    harness.run();
    let timeline = harness.get_by_label(text::TIME).rect();
    for angle in text::POSE_ANGLES {
        let slider = harness.get_by_label(angle).rect();
        assert!(slider.bottom() < timeline.top(), "{angle}: {slider:?} above {timeline:?}");
    }
}

#[test]
fn the_disc_turns_freely_and_the_camera_stays() {
    for size in [WIDE, NARROW] {
        let mut harness = turning(size);
        let middle = place_of_joint(harness.state());
        let commands = drag(&mut harness, middle, middle + vec2(30.0, 12.0), PointerButton::Primary);
        assert!(commands.iter().all(|command| matches!(command, Command::SetPose { .. })), "{commands:?}");
        assert!(angles(&commands).iter().any(|angle| angle.abs() > 5.0));
    }
}

#[test]
fn a_drag_beside_the_rings_turns_the_camera() {
    let mut harness = turning(WIDE);
    let corner = harness.state().viewport.left_bottom() + vec2(30.0, -30.0);
    let commands = drag(&mut harness, corner, corner + vec2(60.0, -10.0), PointerButton::Primary);
    assert!(!commands.is_empty() && commands.iter().all(|command| matches!(command, Command::Orbit { .. })));
}

#[test]
fn time_stands_still_while_the_rings_are_aimed_at() {
    let mut harness = turning(WIDE);
    let (middle, corner) =
        (place_of_joint(harness.state()), harness.state().viewport.left_bottom() + vec2(30.0, -30.0));
    for (at, holds) in [(middle, true), (corner, false)] {
        harness.event(egui::Event::PointerMoved(at));
        harness.run();
        assert_eq!(harness.state().panels.holds_time, holds, "{at}");
    }
}

#[test]
fn a_ring_turns_about_its_own_axis_alone() {
    let mut harness = turning(WIDE);
    let middle = place_of_joint(harness.state());
    // Each ring crosses a circle around the joint. For a shin in the front view, the ring about X is edge-on, the one
    // about Z face-on.
    let mut turned = Vec::new();
    for step in 0..24 {
        let mut harness = turning(WIDE);
        let way = egui::Vec2::angled(step as f32 * std::f32::consts::TAU / 24.0);
        let from = middle + 71.0 * way;
        let commands = drag(&mut harness, from, from + 25.0 * way.rot90(), PointerButton::Primary);
        if let Some(Command::SetPose { degrees: Some(degrees), .. }) = commands.last() {
            turned.push(*degrees);
        }
    }
    let alone = |degrees: &&[f32; 3]| degrees.iter().filter(|angle| angle.abs() > 2.0).count() == 1;
    assert!(turned.iter().filter(alone).count() >= 6, "{turned:?}");
    harness.run();
}

#[test]
fn modes_are_compared_by_a_switch() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Display.label());
    let split = Inspect { split: true, ..Inspect::default() };
    assert_eq!(press(&mut harness, text::COMPARE_SKINNING), [Command::SetInspect(split)]);
    assert_eq!(harness.state().frame.panes, [3, 1]);
    // A joint can be picked in any pane.
    harness.state_mut().change(|state| {
        state.display.show.skeleton = true;
    });
    harness.run();
    let (picture, place) = (harness.state().viewport, place_of_joint(harness.state()));
    let part = (place - picture.min) / picture.size();
    let in_last = pos2(picture.left() + (2.0 + part.x) / 3.0 * picture.width(), place.y);
    let commands = drag(&mut harness, in_last, in_last, PointerButton::Primary);
    assert_eq!(commands, [Command::SelectJoint(Some(SHIN))]);
}

#[test]
fn pictures_and_videos_are_asked_for() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Camera.label());
    let rate = text::labelled(text::FRAME_RATE, &text::frames_per_sec(60));
    let settings = [text::SQUARE, text::TRANSPARENT_BACKGROUND, text::SAVE_IMAGE, &rate];
    for label in settings.into_iter().chain([text::RECORD, text::RECORD_GIF, text::RECORD_IMAGES]) {
        harness.get_by_label(label).scroll_to_me();
        harness.run();
        press(&mut harness, label);
    }
    let picture = Saved::Picture { size: [1080, 1080], transparent: true };
    let format = RecordingFormat::Video;
    let video = VideoSettings { size: [1080, 1080], frames_per_sec: 60, transparent: true, format };
    let gif = VideoSettings { format: RecordingFormat::Gif, ..video };
    let images = VideoSettings { format: RecordingFormat::Images, ..video };
    let recordings = [video, gif, images].map(UiAction::Record);
    assert_eq!(harness.state().actions, [&[UiAction::Save(picture)], &recordings[..]].concat());
}

#[test]
fn a_recording_shows_its_progress_and_can_only_be_cancelled() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.host.recording = Some(RecordingProgress { frames_done: 12, frame_count: 60 });
    harness.run();
    assert!(harness.query_by_label(&text::frames_done(12, 60)).is_some());
    assert_eq!(press_key(&mut harness, egui::Key::Space), [], "no shortcuts");
    assert_eq!(press(&mut harness, text::PLAY), [], "the controls are covered");
    assert_eq!(harness.state().actions, []);
    press_key(&mut harness, egui::Key::Escape);
    press(&mut harness, text::CANCEL);
    assert_eq!(harness.state().actions, [UiAction::CancelRecording, UiAction::CancelRecording]);
}

#[test]
fn the_motion_tab_tells_the_fit_and_puts_the_source_on_the_stage() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, text::FIT);
    assert!(harness.query_by_label(text::NOTHING_TO_MEASURE).is_some());
    press(&mut harness, text::FILES);
    for label in [text::SAVE_GLB, text::SHOW_SOURCE] {
        assert!(harness.get_by_label(label).accesskit_node().is_disabled(), "{label}: the clip is the model's own");
    }
    press(&mut harness, text::FIT);
    press(&mut harness, "Walk (2)");
    assert_eq!(
        harness.query_all_by_label_contains(&text::labelled(text::MEAN, "0.0")).count(),
        3,
        "a copy fits: limbs, facing, rotations"
    );
    assert!(harness.query_by_label(&format!("{}, good", text::labelled(text::COVERAGE, "100 %"))).is_some());
    assert!(harness.query_by_label(&text::overall(Verdict::Good)).is_some());
    press(&mut harness, text::FILES);
    harness.get_by_label(text::SHOW_SOURCE).scroll_to_me();
    harness.run();
    assert_eq!(press(&mut harness, text::SHOW_SOURCE), [Command::SetShow(Show { source: true, ..Show::default() })]);
    assert_eq!(harness.state().frame.characters.len(), 2);
    assert_eq!(harness.query_all_by_label_contains(&text::foot_contacts("")).count(), 2, "a lane for each foot");
}

/// Names are beside the foot-contact tracks, legend and scale below them: nothing covers the first seconds.
#[test]
fn the_lanes_of_the_feet_are_not_covered() {
    for size in [WIDE, NARROW] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        let clip = ClipChoice::called("3");
        harness.state_mut().editor.apply(Command::SetClip(clip));
        harness.state_mut().editor.apply(Command::SetShow(Show { source: true, ..Show::default() }));
        harness.run();
        let lanes: Vec<egui::Rect> =
            harness.query_all_by_label_contains(&text::foot_contacts("")).map(|lane| lane.rect()).collect();
        assert_eq!(lanes.len(), 2);
        // The handle of the in point is centred 3 points left of the start.
        let start = harness.get_by_label(text::IN_POINT).rect().center().x + 3.0;
        let texts = painted(&harness);
        for (text, _, rect) in &texts {
            let is_over = lanes.iter().any(|lane| lane.with_min_x(start).intersects(rect.shrink(0.5)));
            assert!(!is_over, "{text} at {rect:?} over {lanes:?} on {size:?}");
        }
        let told = |wanted: &str| texts.iter().any(|(text, ..)| text == wanted);
        assert!(told("LeftToes") && told("RightToes"), "{texts:?}");
        assert!(told(text::FOOT_SLIDE), "the scale");
    }
}
