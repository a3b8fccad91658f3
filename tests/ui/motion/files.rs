//! Motions and their files: borrowing, saving, removing, and the choices if a motion doesn't fit.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Saved, Tab, UiAction, text};
use gaitway_scene::editor::{ClipFormat, Export};
use gaitway_scene::library::ClipId;
use gaitway_scene::state::{ClipChoice, Command};

use super::{motion_tab, reach};
use crate::bench::{Bench, WIDE, bench, model_with_clips, motion_bench, press, sample_bench};
use crate::by_place::motion_called;

#[test]
fn borrowed_clips_are_listed_under_the_name_of_their_file() {
    let mut harness = motion_bench(WIDE, &["folder/dance.bvh"]);
    assert!(harness.query_by_label(&text::from_motion("dance.bvh")).is_some());
    let [walk, idle, wave] = ["Walk (2)", "Idle (2)", "Wave (2)"];
    for (title, clip) in [(walk, 0), (idle, 1), (wave, 2)] {
        let clip = ClipId::Borrowed(motion_called("folder/dance.bvh"), clip);
        let expected = Command::SetClip(ClipChoice::Clip(clip));
        assert_eq!(press(&mut harness, title), [expected], "{title}");
    }
}

#[test]
fn without_clips_and_motions_there_is_no_motion_tab() {
    let harness = bench(WIDE, model_with_clips(0));
    assert!(harness.query_by_label(Tab::Motion.label()).is_none());
}

#[test]
fn without_a_motion_the_motion_tab_edits_the_clip() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Motion.label());
    assert!(harness.query_by_label(text::MIRROR).is_some());
    assert!(harness.query_by_label(text::JOINTS).is_none());
    press(&mut harness, text::BORROW_MOTION);
    assert_eq!(harness.state().actions, [UiAction::ChooseMotion]);
}

#[test]
fn files_are_requested_from_the_host() {
    let mut harness = motion_tab();
    press(&mut harness, text::FILES);
    press(&mut harness, text::SAVE_MAP);
    press(&mut harness, text::LOAD_MAP);
    press(&mut harness, "Walk (2)");
    press(&mut harness, text::SAVE_GLB);
    reach(&mut harness, text::OPEN_INSTEAD);
    reach(&mut harness, text::REMOVE_MOTION);
    let expected = [
        UiAction::Save(Saved::File(Export::Map { motion: motion_called("dance.bvh") })),
        UiAction::ChooseMotion,
        UiAction::Save(Saved::File(Export::Model { clip: ClipId::Borrowed(motion_called("dance.bvh"), 0) })),
        UiAction::ShowMotionAlone(motion_called("dance.bvh")),
        UiAction::RemoveMotion(motion_called("dance.bvh")),
    ];
    assert_eq!(harness.state().actions, expected);
}

/// As the export menu does: one of the model's own clips can be saved alone, but is in the model's file already.
#[test]
fn an_own_clip_can_be_saved_alone() {
    let mut harness = motion_tab();
    press(&mut harness, text::FILES);
    press(&mut harness, "Walk");
    check_disabled(&mut harness, text::SAVE_GLB, text::IS_IN_FILE);
    let format = ClipFormat::Bvh;
    reach(&mut harness, text::save_clip(format));
    assert_eq!(harness.state().actions, [UiAction::Save(Saved::File(Export::Clip { clip: ClipId::Own(0), format }))]);
    harness.state_mut().editor.apply(Command::SetClip(ClipChoice::RestPose));
    harness.run();
    for label in [text::SAVE_GLB, text::save_clip(format)] {
        check_disabled(&mut harness, label, text::NEEDS_CLIP);
    }
}

/// Checks that a button is disabled, and that its tooltip says why.
fn check_disabled(harness: &mut Harness<'_, Bench>, label: &str, why: &str) {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
    assert!(harness.get_by_label(label).accesskit_node().is_disabled(), "{label}");
    harness.get_by_label(label).hover();
    harness.run_steps(60);
    assert!(harness.query_by_label(why).is_some(), "{label}: {why}");
    // Tooltips of other controls appear after this one is gone.
    harness.hover_at(egui::Pos2::ZERO);
    harness.run_steps(60);
}

/// The tab shows the motion whose clip plays.
#[test]
fn choosing_a_motion_plays_its_first_clip() {
    let mut harness = motion_bench(WIDE, &["first.bvh", "second.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, text::MOTION_FILE);
    let commands = press(&mut harness, "second.bvh");
    assert_eq!(commands, [Command::SetClip(ClipChoice::Clip(ClipId::Borrowed(motion_called("second.bvh"), 0)))]);
    press(&mut harness, text::FILES);
    press(&mut harness, text::SAVE_MAP);
    assert_eq!(
        harness.state().actions,
        [UiAction::Save(Saved::File(Export::Map { motion: motion_called("second.bvh") }))]
    );
}

#[test]
fn a_motion_that_does_not_fit_can_be_shown_alone_or_mapped_manually() {
    let offers = [
        (text::SHOW_REFUSED_ALONE, UiAction::ShowRefusedAlone),
        (text::MAP_REFUSED_MANUALLY, UiAction::MapRefusedManually),
    ];
    for (label, action) in offers {
        let mut harness = sample_bench(WIDE);
        harness.state_mut().panels.messages.error = Some("snake.bvh: no joint in common".to_owned());
        harness.run();
        assert!(harness.query_by_label(label).is_none(), "only for motions");
        harness.state_mut().panels.messages.motion_refused = true;
        harness.run();
        press(&mut harness, label);
        assert_eq!(harness.state().actions, [action]);
        assert_eq!(harness.state().panels.messages.error, None);
    }
}

/// After a click, keys go on controlling the viewport.
#[test]
fn mapping_manually_by_key_leads_to_the_first_joint() {
    for by_key in [true, false] {
        let mut harness = motion_tab();
        press(&mut harness, text::FILES);
        harness.state_mut().panels.on_map_started(by_key);
        harness.run();
        harness.run();
        let focused =
            harness.query_all_by_role(egui::accesskit::Role::Button).find(|node| node.accesskit_node().is_focused());
        let name = focused.and_then(|node| node.accesskit_node().label());
        assert_eq!(name, by_key.then(|| text::edit_joint("Hips")));
    }
}

/// A model without a skeleton has no joints to map.
#[test]
fn a_motion_for_a_model_without_a_skeleton_can_only_be_shown_alone() {
    let mut harness = sample_bench(WIDE);
    let messages = &mut harness.state_mut().panels.messages;
    messages.error = Some("dance.bvh: Chair has no skeleton".to_owned());
    (messages.motion_refused, messages.model_lacks_skeleton) = (true, true);
    harness.run();
    assert!(harness.query_by_label(text::MAP_REFUSED_MANUALLY).is_none());
    press(&mut harness, text::SHOW_REFUSED_ALONE);
    assert_eq!(harness.state().actions, [UiAction::ShowRefusedAlone]);
}
