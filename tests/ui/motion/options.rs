//! The retargeting options of the whole map.

use egui_kittest::kittest::Queryable;
use gaitway::files::{Role, read_paths};
use gaitway::ui::{Tab, text};
use gaitway_character::anim::{ClipBuilder, Interpolation, Keys, Transform};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_retarget::{ClipRef, Contacts, Feet, Keep, PathOrigin, RestChoice, RootOptions, RootPart, Unmapped};
use gaitway_scene::editor::Contents;
use gaitway_scene::library::{Library, Motion};
use gaitway_scene::samples;
use gaitway_scene::state::{Command, MapEdit};
use glam::{Quat, Vec3};

use super::{edit, map, motion_tab, press_row, reach, says};
use crate::bench::{WIDE, bench_of, drag, press, sample_bench};
use crate::skeletons;

#[test]
fn options_set_root_motion_foot_planting_and_rest_poses() {
    let mut harness = motion_tab();
    press(&mut harness, text::OPTIONS);
    let mut root = RootOptions { horizontal: RootPart::InPlace, origin: PathOrigin::Feet, ..RootOptions::default() };
    assert_eq!(
        press(&mut harness, &text::labelled(text::ROOT_HORIZONTAL, text::IN_PLACE)),
        [Command::SetRoot(Some(root))]
    );
    root.origin = PathOrigin::Rest;
    assert_eq!(reach(&mut harness, &text::labelled(text::ROOT_ORIGIN, text::REST)), [Command::SetRoot(Some(root))]);
    root.yaw = RootPart::Freeze;
    assert_eq!(reach(&mut harness, &text::labelled(text::ROOT_TURN, text::FREEZE)), [Command::SetRoot(Some(root))]);
    root.extract = true;
    assert_eq!(reach(&mut harness, text::EXTRACT_ROOT_MOTION), [Command::SetRoot(Some(root))]);
    let plant = Command::SetFeet(Some(Feet::Plant));
    assert_eq!(reach(&mut harness, text::PLANT_FEET), [plant]);
    let keep = Command::SetContacts(Some(Contacts::Keep));
    assert_eq!(reach(&mut harness, text::KEEP_CONTACTS), [keep]);
    reach(&mut harness, text::REST_OF_MODEL);
    press(&mut harness, text::rest_choice(RestChoice::Bind));
    let now = map(&harness, 0);
    let options = (now.rest.model, now.root, now.feet, now.contacts);
    assert_eq!(options, (RestChoice::Bind, root, Feet::Plant, Contacts::Keep));
}

#[test]
fn feet_that_were_planted_automatically_are_marked_as_such() {
    let mut harness = sample_bench(WIDE);
    let walk = read_paths(&["sample:walk".into()], Role::Any).expect("a sample");
    let dwarf = read_paths(&["sample:dwarf".into()], Role::Any).expect("a sample");
    for contents in [dwarf, walk] {
        let contents = Contents { is_by_hand: true, ..contents };
        harness.state_mut().editor.open(contents, None, &mut |_| Ok(())).expect("fits");
    }
    harness.run();
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, text::OPTIONS);
    assert!(harness.query_by_label(text::PLANTED_AUTOMATICALLY).is_some());
    for feet in [Feet::Off, Feet::Plant] {
        assert_eq!(press(&mut harness, text::PLANT_FEET), [Command::SetFeet(Some(feet))]);
        assert!(harness.query_by_label(text::PLANTED_AUTOMATICALLY).is_none());
    }
}

#[test]
fn joints_without_a_source_can_play_a_clip() {
    let mut harness = motion_tab();
    press(&mut harness, text::OPTIONS);
    reach(&mut harness, text::UNMAPPED_JOINTS);
    // The label is also in the list of clips; the last one is in the open drop-down list.
    harness.state_mut().commands.clear();
    harness.get_all_by_label("Wave").last().expect("in the list").click();
    harness.run();
    let wave = |frozen| Command::SetUnmapped(Some(Unmapped::Clip { clip: ClipRef::Index(2), frozen }));
    assert_eq!(harness.state().commands, [wave(false)]);
    assert_eq!(press(&mut harness, text::HOLD_FIRST_KEY), [wave(true)]);
    press(&mut harness, text::JOINTS);
    press_row(&mut harness, &text::follows("Head", ""));
    press(&mut harness, text::FOLLOW_NOTHING);
    assert!(harness.query_by_label_contains(&text::row("Head", text::NO_SOURCE, text::NO_SOURCE)).is_some());
    assert!(says(&harness, &text::holds_first_key("Wave")));
}

#[test]
fn options_set_translations_scales_and_the_crossfade() {
    let mut harness = motion_tab();
    press(&mut harness, text::OPTIONS);
    assert_eq!(
        reach(&mut harness, &text::labelled(text::TRANSLATIONS, text::DROP)),
        [edit(MapEdit::Translations(Keep::Drop))]
    );
    assert_eq!(reach(&mut harness, &text::labelled(text::SCALES, text::KEEP)), [edit(MapEdit::Scales(Keep::Keep))]);
    let field = text::value_of(text::CROSSFADE);
    harness.get_by_label(&field).scroll_to_me();
    harness.run();
    let from = harness.get_by_label(&field).rect().center();
    drag(&mut harness, from, from + egui::vec2(50.0, 0.0), egui::PointerButton::Primary);
    let now = map(&harness, 0);
    assert_eq!((now.translations, now.scales), (Keep::Drop, Keep::Keep));
    assert!(now.crossfade_secs > 0.1, "{}", now.crossfade_secs);
}

/// A body in mid-stride that only nods.
fn striding() -> Asset {
    let at = |x, y, z| Transform::from_translation(Vec3::new(x, y, z));
    let joints = [
        ("Hips", None, at(0.0, 1.0, 0.0)),
        ("Spine", Some(0), at(0.0, 0.2, 0.0)),
        ("Neck", Some(1), at(0.0, 0.3, 0.0)),
        ("Head", Some(2), at(0.0, 0.1, 0.0)),
        ("LeftUpLeg", Some(0), at(0.1, 0.0, 0.0)),
        ("LeftLeg", Some(4), at(0.0, -0.3, 0.3)),
        ("LeftFoot", Some(5), at(0.0, -0.3, 0.3)),
        ("RightUpLeg", Some(0), at(-0.1, 0.0, 0.0)),
        ("RightLeg", Some(7), at(0.0, -0.3, -0.3)),
        ("RightFoot", Some(8), at(0.0, -0.3, -0.3)),
    ];
    let joints = joints.map(|(name, parent, rest)| skeletons::joint(name, parent, rest));
    let parts = skeletons::asset(joints.to_vec()).into_parts();
    let mut clip = ClipBuilder::new("nod", &parts.skeleton);
    let keys = Keys::Rotation(vec![Quat::IDENTITY, Quat::from_rotation_x(0.3)]);
    let head = parts.skeleton.find("Head").expect("it is there");
    clip.channel(head, Interpolation::Linear, &[0.0, 1.0], keys).expect("a valid channel");
    let clips = vec![clip.build()];
    Asset::new(AssetParts { clips, ..parts }).expect("a valid asset")
}

#[test]
fn a_rest_pose_in_mid_stride_is_mentioned_until_one_is_chosen() {
    let mut library = Library::default();
    library.add(samples::load("walker").expect("the sample is there"));
    library.set_motions(vec![Motion::new("stride.glb".to_owned(), striding().into())]);
    let mut harness = bench_of(WIDE, library);
    press(&mut harness, Tab::Motion.label());
    assert!(harness.query_by_label(text::DOUBTFUL_REST).is_some());
    press(&mut harness, text::OPTIONS);
    reach(&mut harness, text::REST_OF_MOTION);
    press(&mut harness, text::rest_choice(RestChoice::Node));
    assert!(harness.query_by_label(text::DOUBTFUL_REST).is_none());
}
