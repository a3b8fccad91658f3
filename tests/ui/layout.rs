//! Layout on wide, narrow and embedded screens, and what lies over the viewport.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Layout, Progress, Sheet, Tab, UiAction, text};
use gaitway_retarget::ClipLayer;
use gaitway_scene::library::{ClipId, LayeredClip};
use gaitway_scene::state::{Command, Embed};

use crate::bench::{
    Bench, NARROW, WIDE, bench, drag, model_with_clips, motion_bench, painted, press, press_key, sample_bench,
};

#[test]
fn panels_fold_away_and_come_back() {
    let mut harness = sample_bench(WIDE);
    let narrower = harness.state().viewport.width();
    press(&mut harness, text::HIDE_INSPECTOR);
    press(&mut harness, text::HIDE_CLIPS);
    assert!(harness.query_by_label(text::REST_POSE).is_none());
    assert!(harness.query_by_label(Tab::Scene.label()).is_none());
    assert_eq!(harness.state().viewport.width(), WIDE[0]);
    press(&mut harness, text::SHOW_CLIPS);
    press(&mut harness, text::SHOW_INSPECTOR);
    assert_eq!(harness.state().viewport.width(), narrower);
}

#[test]
fn a_narrow_screen_has_sheets_one_at_a_time() {
    let mut harness = sample_bench(NARROW);
    assert_eq!(harness.state().viewport.width(), NARROW[0]);
    assert!(harness.query_by_label(text::REST_POSE).is_none());
    press(&mut harness, text::CLIPS);
    assert!(harness.query_by_label(text::REST_POSE).is_some());
    press(&mut harness, text::INSPECTOR);
    assert_eq!(harness.state().panels.layout.sheet, Some(Sheet::Inspector));
    assert!(harness.query_by_label(text::REST_POSE).is_none());
    press(&mut harness, text::CLOSE_SHEET);
    assert_eq!(harness.state().panels.layout.sheet, None);
}

#[test]
fn the_close_button_of_a_sheet_covers_no_tab() {
    for size in [[320.0, 640.0], NARROW, ON_ITS_SIDE] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        harness.run_steps(3);
        let close = harness.get_by_label(text::CLOSE_SHEET).rect();
        for tab in [Tab::Scene, Tab::Display, Tab::Info, Tab::Camera, Tab::Motion] {
            let tab = harness.get_by_role_and_label(Role::Tab, tab.label()).rect();
            assert!(!tab.shrink(0.5).intersects(close), "{tab:?} and {close:?} on {size:?}");
        }
    }
}

#[test]
fn a_sheet_is_dragged_higher_and_away() {
    let mut harness = sample_bench(NARROW);
    press(&mut harness, text::CLIPS);
    let usual = harness.state().viewport;
    let grip = |harness: &Harness<'_, Bench>| harness.state().viewport.center_bottom() - egui::vec2(0.0, 4.0);
    let from = grip(&harness);
    drag(&mut harness, from, from + egui::vec2(0.0, -90.0), egui::PointerButton::Primary);
    assert_eq!(harness.state().viewport, usual.with_max_y(usual.bottom() - 90.0));
    // Not over the whole viewport.
    let from = grip(&harness);
    drag(&mut harness, from, from + egui::vec2(0.0, -500.0), egui::PointerButton::Primary);
    assert!(harness.state().viewport.height() >= 56.0 && harness.state().panels.layout.sheet == Some(Sheet::Clips));
    let fit = harness.get_by_label(text::FRAME_ALL).rect();
    assert!(harness.state().viewport.contains_rect(fit), "{fit:?}");
    let from = grip(&harness);
    let down = usual.bottom() + 60.0 - harness.state().viewport.bottom();
    drag(&mut harness, from, from + egui::vec2(0.0, down), egui::PointerButton::Primary);
    assert_eq!(harness.state().panels.layout.sheet, None);
    press(&mut harness, text::CLIPS);
    assert_eq!(harness.state().viewport, usual);
}

#[test]
fn mapping_manually_shows_the_joint_table() {
    for size in [WIDE, NARROW] {
        let mut harness = motion_bench(size, &["walk.bvh"]);
        harness.state_mut().panels.layout.inspector_open = false;
        harness.run();
        assert!(harness.query_by_label(Tab::Motion.label()).is_none());
        harness.state_mut().panels.on_map_started(false);
        harness.run();
        assert!(harness.query_by_label(Tab::Motion.label()).is_some(), "{size:?}");
    }
}

/// The viewport is the area that a sheet leaves free: the character stays visible while a clip is chosen.
#[test]
fn a_sheet_does_not_hide_the_picture() {
    for size in [NARROW, [320.0, 480.0]] {
        let mut harness = sample_bench(size);
        let whole = harness.state().viewport;
        press(&mut harness, text::CLIPS);
        let above = harness.state().viewport;
        assert!(above.height() >= 56.0 && above.height() < whole.height(), "{above:?} of {whole:?}");
        let row = harness.get_by_label(text::REST_POSE).rect();
        assert!(above.bottom() <= row.top(), "{above:?} and {row:?}");
        press(&mut harness, text::CLOSE_SHEET);
        assert_eq!(harness.state().viewport, whole);
    }
}

/// There, a sheet beside anything else would be a strip.
#[test]
fn a_sheet_takes_a_tiny_screen() {
    for size in [[320.0, 240.0], [480.0, 320.0]] {
        let mut harness = sample_bench(size);
        let whole = harness.state().viewport;
        for key in [None, Some(egui::Key::Escape)] {
            press(&mut harness, text::INSPECTOR);
            press(&mut harness, Tab::Info.label());
            let tab = harness.get_by_label(Tab::Info.label()).rect();
            assert!(size[1] - tab.bottom() >= 90.0, "{tab:?} on {size:?}");
            for label in [text::PLAY, text::FRAME_ALL] {
                assert!(harness.query_by_label(label).is_none(), "{label} is behind it on {size:?}");
            }
            match key {
                Some(key) => drop(press_key(&mut harness, key)),
                None => drop(press(&mut harness, text::CLOSE_SHEET)),
            }
            assert_eq!(harness.state().viewport, whole);
            assert!(harness.query_by_label(text::PLAY).is_some());
        }
    }
}

/// What doesn't fit is left out.
#[test]
fn nothing_overlaps_on_a_tiny_screen() {
    let shown_on = |size: [f32; 2]| {
        let harness = sample_bench(size);
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let buttons: Vec<_> = harness
            .query_all_by_role(Role::Button)
            .map(|button| (button.accesskit_node().label(), button.rect()))
            .collect();
        for (at, (label, rect)) in buttons.iter().enumerate() {
            assert!(screen.expand(0.5).contains_rect(*rect), "{label:?} at {rect:?} on {size:?}");
            for (other, other_rect) in &buttons[at + 1..] {
                assert!(!rect.shrink(0.5).intersects(other_rect.shrink(0.5)), "{label:?} and {other:?} on {size:?}");
            }
        }
        [text::MENU, text::PLAY, text::FRAME_ALL].map(|label| harness.query_by_label(label).is_some())
    };
    assert_eq!(shown_on([320.0, 400.0]), [true; 3]);
    assert_eq!(shown_on([260.0, 300.0]), [true; 3]);
    assert_eq!(shown_on([200.0, 240.0])[..2], [true; 2]);
    assert_eq!(shown_on([200.0, 160.0])[..2], [false, true]);
    assert!(!shown_on([120.0, 100.0])[1]);
    shown_on([120.0, 170.0]);
}

/// A phone held sideways.
const ON_ITS_SIDE: [f32; 2] = [844.0, 390.0];

#[test]
fn a_phone_on_its_side_is_mostly_viewport() {
    for size in [ON_ITS_SIDE, [667.0, 375.0], [932.0, 430.0]] {
        let mut harness = motion_bench(size, &["walk.bvh"]);
        // There is no room for tracks.
        harness
            .state_mut()
            .editor
            .apply(Command::SetLayers(vec![LayeredClip { clip: ClipId::Own(0), layer: ClipLayer::default() }]));
        harness.run();
        let whole = harness.state().viewport;
        assert!(whole.area() >= 0.5 * size[0] * size[1], "{whole:?} of {size:?}");
        for label in [text::CLIPS, text::INSPECTOR] {
            press(&mut harness, label);
            let beside = harness.state().viewport;
            assert!(beside.height() == whole.height() && beside.width() >= 0.5 * size[0], "{beside:?} of {size:?}");
            let close = harness.get_by_label(text::CLOSE_SHEET).rect();
            assert!(close.left() >= beside.right() && close.top() >= whole.top(), "{close:?} beside {beside:?}");
        }
        harness.state_mut().change(|state| state.page.embed = Embed::Page);
        harness.run();
        assert!(harness.state().viewport.area() >= 0.5 * size[0] * size[1], "embedded, {size:?}");
    }
}

#[test]
fn the_help_fits_small_screens() {
    for size in [[320.0, 240.0], NARROW, ON_ITS_SIDE, WIDE] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.help.is_open = true;
        harness.run();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let (title, lines) = match size == WIDE {
            true => (text::HELP_TITLE, [text::STEP_KEYS, text::STEP_FRAMES, text::HELP_RING]),
            false => (text::GESTURES, [text::PINCH, text::HELP_HANDLE, text::HELP_RING]),
        };
        assert_eq!(harness.query_by_label(text::STEP_KEYS).is_some(), size == WIDE, "keys on {size:?}");
        for (role, label) in [(Role::Label, title), (Role::Button, text::CLOSE_HELP)] {
            let node = harness.get_by_role_and_label(role, label);
            assert!(screen.contains_rect(node.rect()), "{node:?} on {size:?}");
        }
        press_key(&mut harness, egui::Key::Escape);
        press_key(&mut harness, egui::Key::Questionmark);
        assert!(harness.query_by_label(text::STEP_KEYS).is_some(), "its key shows the keys on {size:?}");
        press_key(&mut harness, egui::Key::Escape);
        harness.state_mut().panels.help.is_open = true;
        harness.run();
        assert_eq!(harness.query_by_label(text::STEP_KEYS).is_some(), size == WIDE, "not the menu, on {size:?}");
        for label in lines {
            let rect = harness.get_by_label(label).rect();
            assert!(
                screen.x_range().contains(rect.left()) && screen.x_range().contains(rect.right()),
                "{label}: {rect:?}"
            );
        }
    }
}

/// The transport is never cut off, and no tab makes a side panel wider.
#[test]
fn everything_stays_on_the_screen() {
    for size in [NARROW, [360.0, 640.0], ON_ITS_SIDE, [667.0, 375.0], [700.0, 500.0], WIDE, [1920.0, 1080.0]] {
        let mut harness = bench(size, model_with_clips(30));
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let normal_speed = text::speed(1.0);
        let narrow = size[0] < 700.0 || size[1] < 450.0;
        let (next, speed) = match narrow {
            true => (text::without_key(text::NEXT_FRAME), normal_speed.as_str()),
            false => (text::NEXT_FRAME, text::SPEED_VALUE),
        };
        for label in [text::PLAY, next, text::TIME, speed] {
            let rect = harness.get_by_label(label).rect();
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
        if narrow {
            press(&mut harness, text::INSPECTOR);
        }
        for tab in [Tab::Display.label(), Tab::Info.label(), Tab::Camera.label(), Tab::Scene.label()] {
            press(&mut harness, tab);
            for node in [Tab::Scene.label(), Tab::Camera.label()] {
                let rect = harness.get_by_label(node).rect();
                assert!(screen.contains_rect(rect), "{node} at {rect:?} on {size:?} with {tab} open");
            }
        }
        assert!(harness.state().viewport.width() >= 180.0, "{size:?}");
    }
}

#[test]
fn the_times_end_before_the_buttons_on_their_right() {
    for size in [[320.0, 480.0], [360.0, 640.0], NARROW] {
        let mut harness = sample_bench(size);
        let button = harness.get_by_label(text::LOOP).rect();
        for (text, is_cut, rect) in painted(&harness) {
            let is_beside = rect.center().y > button.top() && rect.left() < button.left();
            assert!(!is_beside || (rect.right() <= button.left() && !is_cut), "{text} at {rect:?} on {size:?}");
        }
        harness.state_mut().change(|state| state.playback.speed = 0.25);
        harness.run();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        assert!(screen.contains_rect(harness.get_by_label(&text::speed(0.25)).rect()), "{size:?}");
    }
}

/// The buttons of a row stand side by side at one height.
#[test]
fn rows_of_buttons_are_level() {
    for size in [NARROW, WIDE] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        for (tab, labels) in [(Tab::Motion, [text::REMATCH, text::CLEAR_MAP]), (Tab::Camera, [text::FRONT, text::TOP])]
        {
            harness.state_mut().panels.layout.tab = tab;
            harness.run();
            let [first, last] = labels.map(|label| harness.get_by_label(label).rect());
            assert_eq!(first.y_range(), last.y_range(), "{labels:?} on {size:?}");
        }
    }
}

#[test]
fn the_backgrounds_names_stand_apart() {
    for size in [WIDE, [1000.0, 700.0], NARROW, [320.0, 900.0]] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        harness.state_mut().panels.layout.tab = Tab::Camera;
        harness.run();
        harness.get_by_label(text::ENVIRONMENT).scroll_to_me();
        harness.run();
        let names = [text::COLOR, text::ENVIRONMENT, text::BLURRED, text::NO_BACKGROUND];
        let texts: Vec<_> = painted(&harness).into_iter().filter(|(text, ..)| names.contains(&text.as_str())).collect();
        assert!(texts.len() >= names.len(), "{size:?}: {texts:?}");
        for (at, (text, _, rect)) in texts.iter().enumerate() {
            for (other, _, other_rect) in &texts[at + 1..] {
                assert!(!rect.expand2(egui::vec2(3.0, 0.0)).intersects(*other_rect), "{text} and {other} on {size:?}");
            }
        }
    }
}

#[test]
fn the_placeholder_of_a_search_field_is_in_its_middle() {
    let mut harness = sample_bench(NARROW);
    harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
    harness.state_mut().panels.layout.tab = Tab::Scene;
    harness.run();
    let field = harness.get_by_label(text::SEARCH_NODES).rect();
    let texts = painted(&harness);
    let (_, _, rect) = texts.iter().find(|(text, ..)| text == text::SEARCH_NODES).expect("a placeholder");
    assert!((rect.center().y - field.center().y).abs() < 3.0, "{rect:?} in {field:?}");
}

#[test]
fn posing_can_be_ended_on_any_screen() {
    for size in [[800.0, 600.0], NARROW, [320.0, 480.0], WIDE] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.joint_card.is_posing = true;
        harness.run();
        assert!(harness.query_by_label(text::DONE_POSING).is_none(), "without a joint there are no rings");
        harness.state_mut().editor.apply(Command::SelectJoint(Some(5)));
        harness.run();
        let viewport = harness.state().viewport;
        for (text, _, rect) in painted(&harness) {
            if [text::POSING, text::DONE_POSING].contains(&text.as_str()) {
                assert!(viewport.shrink(10.0).contains_rect(rect), "{text} at {rect:?} in {viewport:?}");
            }
        }
        press(&mut harness, text::DONE_POSING);
        assert!(!harness.state().panels.joint_card.is_posing);
    }
}

#[test]
fn embedded_there_is_only_picture_and_transport() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.page.embed = Embed::Page;
    });
    harness.run();
    assert_eq!(harness.state().viewport.width(), WIDE[0]);
    assert!(harness.query_by_label(text::PLAY).is_some());
    for label in [text::REST_POSE, Tab::Scene.label(), text::NAME, text::OPEN, text::OPEN_PAGE] {
        assert!(harness.query_by_label(label).is_none(), "{label}");
    }
    // Only a page can be left for another one.
    harness.state_mut().panels.host.has_gallery = true;
    harness.run();
    press(&mut harness, text::OPEN_PAGE);
    assert_eq!(harness.state().actions, [UiAction::OpenPage]);
    for (embed, has_transport) in [(Embed::Transport, true), (Embed::Viewport, false)] {
        harness.state_mut().change(|state| state.page.embed = embed);
        harness.run();
        assert_eq!(harness.query_by_label(text::PLAY).is_some(), has_transport, "{embed:?}");
        assert!(harness.query_by_label(text::OPEN_PAGE).is_none(), "{embed:?}");
    }
}

/// Sizes of the first screen, each with the height of the samples below the canvas and the viewport's minimum share.
const FIRST_SCREENS: [([f32; 2], f32, f32); 2] = [(WIDE, 120.0, 0.5), (NARROW, 150.0, 0.6)];

#[test]
fn the_first_screen_is_mostly_viewport() {
    for (size, samples, share) in FIRST_SCREENS {
        let mut harness = sample_bench([size[0], size[1] - samples]);
        harness.state_mut().panels.layout = Layout::default();
        harness.state_mut().panels.start(size[0]);
        harness.run();
        let found = harness.state().viewport.area() / (size[0] * size[1]);
        assert!(found >= share, "{found} of {size:?}");
    }
}

fn bench_with_error(error: &str) -> Harness<'static, Bench> {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.messages.error = Some(error.to_owned());
    harness.run();
    harness
}

#[test]
fn an_error_stays_until_dismissed() {
    let mut harness = bench_with_error("broken.glb: it is not a GLB file");
    assert!(harness.query_by_label("broken.glb: it is not a GLB file.").is_some());
    press(&mut harness, text::DISMISS_ERROR);
    assert_eq!(harness.state().panels.messages.error, None);
}

#[test]
fn what_cannot_be_used_of_a_view_is_told_until_dismissed() {
    let mut harness = sample_bench(WIDE);
    for is_by_key in [false, true] {
        harness.state_mut().panels.messages.about_view = Some("joint=999: expected a joint.".to_owned());
        harness.run();
        assert!(harness.query_by_label("joint=999: expected a joint.").is_some());
        match is_by_key {
            true => press_key(&mut harness, egui::Key::Escape),
            false => press(&mut harness, text::DISMISS_NOTICE),
        };
        assert_eq!(harness.state().panels.messages.about_view, None);
    }
}

#[test]
fn a_file_that_failed_to_open_is_named_once() {
    let mut harness = sample_bench(WIDE);
    let progress = Progress { name: "broken.glb".to_owned(), ..Progress::default() };
    harness.state_mut().panels.messages.fail_to_open("broken.glb: it is not a GLB file", Some(progress));
    harness.run();
    assert!(harness.query_by_label(&text::couldnt_open("broken.glb")).is_some());
    assert!(harness.query_by_label("It is not a GLB file.").is_some());
}

#[test]
fn messages_are_sentences_and_files_keep_their_names() {
    let harness = bench_with_error("this is a folder, not a file\nwalk.bvh: no joints");
    assert!(harness.query_by_label("This is a folder, not a file.\nwalk.bvh: no joints.").is_some());
}

#[test]
fn a_load_shows_how_far_it_is() {
    let mut harness = sample_bench(WIDE);
    let name = "large.glb".to_owned();
    for (total_bytes, amount) in [(0, "3.5 MB"), (7_000_000, "3.5 of 7.0 MB")] {
        let progress = Progress { name: name.clone(), received_bytes: 3_500_000, total_bytes };
        harness.state_mut().panels.messages.progress = Some(progress);
        // An unknown end is a moving bar, which never comes to rest.
        harness.run_steps(3);
        let opening = text::opening(&name);
        let bar = harness.get_by_role_and_label(Role::ProgressIndicator, &opening);
        assert!(bar.accesskit_node().numeric_value().is_some());
        assert!(harness.query_by_role_and_label(Role::Label, &opening).is_some());
        assert!(harness.query_by_label(amount).is_some());
    }
    press(&mut harness, text::CANCEL);
    assert_eq!(harness.state().actions, [UiAction::CancelOpening]);
}

#[test]
fn nothing_repaints_by_itself() {
    let mut harness = sample_bench(WIDE);
    harness.run();
    assert_eq!(harness.run(), 1, "one step for the run itself and none after it");
}

/// The rows of a phone are high, so its tree shows only a few.
#[test]
fn a_selected_joint_is_in_sight_in_the_tree() {
    for size in [WIDE, NARROW, [844.0, 390.0]] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        harness.run();
        harness.state_mut().editor.apply(Command::SelectJoint(Some(9)));
        harness.run();
        let skeleton = &harness.state().library().active().expect("a model").asset.skeleton;
        let name = skeleton.name(skeleton.joint_of_source(9).expect("a joint")).to_owned();
        let row = harness.get_by_role_and_label(egui::accesskit::Role::TreeItem, &name).rect();
        let is_name = |shape: &egui::Shape| matches!(shape, egui::Shape::Text(text) if text.galley.text() == name);
        let clipped = harness
            .output()
            .shapes
            .iter()
            .find(|clipped| is_name(&clipped.shape) && row.contains_rect(clipped.shape.visual_bounding_rect()));
        let sight = clipped.expect("the row's name is painted").clip_rect;
        assert!(sight.contains_rect(row.shrink(1.0)), "{size:?}: {row:?} in {sight:?}");
    }
}

#[test]
fn the_header_works_above_an_open_sheet_on_a_phone_on_its_side() {
    let mut harness = sample_bench(ON_ITS_SIDE);
    for sheet in [Sheet::Clips, Sheet::Inspector] {
        harness.state_mut().panels.layout.sheet = Some(sheet);
        harness.run();
        let left = harness.state().viewport.right();
        let above = harness.ctx.layer_id_at(egui::pos2(left - 40.0, 200.0)).map(|layer| layer.order);
        assert_eq!(above, Some(egui::Order::Background), "{sheet:?} covers the viewport");
        press(&mut harness, text::MENU);
        assert!(egui::Popup::is_any_open(&harness.ctx), "{sheet:?}");
        press_key(&mut harness, egui::Key::Escape);
    }
}
