//! The header, its menus, and the box about the program.

use egui::ThemePreference;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Saved, Tab, UiAction, text};
use gaitway_scene::editor::{ClipFormat, Export};
use gaitway_scene::library::{ClipId, Library, Model};
use gaitway_scene::samples;
use gaitway_scene::state::{ClipChoice, Command, Show};

use crate::bench::{
    Bench, NARROW, WIDE, bench, bench_of, model_with_clips, motion_bench, press, press_key, sample_bench,
};
use crate::by_place::motion_called;

/// Presses an entry of a menu.
pub fn choose(harness: &mut Harness<'_, Bench>, menu: &str, entry: &str) {
    press(harness, menu);
    // The menu of a small screen scrolls.
    harness.get_by_label(entry).scroll_to_me();
    harness.run();
    press(harness, entry);
}

#[test]
fn the_controls_of_the_header_stand_in_one_row() {
    let wide = [text::NAME, text::OPEN, text::BORROW_MOTION, text::UNDO_STEP, text::EXPORT, text::SHARE, text::MENU];
    let undo = text::without_key(text::UNDO_STEP);
    let narrow = [text::CLIPS, text::NAME, text::OPEN, undo, text::SHARE, text::MENU, text::INSPECTOR];
    let wide_screens = [WIDE, [1920.0, 1080.0], [700.0, 500.0]].map(|size| (size, wide));
    let phones = [NARROW, [360.0, 640.0], [844.0, 390.0]].map(|size| (size, narrow));
    let screens = [wide_screens, phones].concat();
    for (size, labels) in screens {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.host.has_gallery = true;
        harness.run();
        let rects = labels.map(|label| harness.get_by_label(label).rect());
        for (pair, labels) in rects.windows(2).zip(labels.windows(2)) {
            assert!(pair[0].right() <= pair[1].left(), "{labels:?}: {pair:?} on {size:?}");
            assert!((pair[0].center().y - pair[1].center().y).abs() < 4.0, "{labels:?}: {pair:?} on {size:?}");
        }
        assert!(rects[6].right() <= size[0], "{:?} on {size:?}", rects[6]);
        assert!(rects[0].bottom() <= harness.state().viewport.top());
    }
}

#[test]
fn open_borrow_and_share_are_asked_of_the_host() {
    let mut harness = sample_bench(WIDE);
    for label in [text::OPEN, text::BORROW_MOTION, text::SHARE] {
        press(&mut harness, label);
    }
    assert_eq!(harness.state().actions, [UiAction::OpenFiles, UiAction::ChooseMotion, UiAction::ShareLink]);
}

#[test]
fn undo_and_redo_work_while_there_is_a_step() {
    let mut harness = sample_bench(WIDE);
    let is_disabled = |harness: &Harness<'_, Bench>, label| harness.get_by_label(label).accesskit_node().is_disabled();
    assert!(is_disabled(&harness, text::UNDO_STEP) && is_disabled(&harness, text::REDO_STEP));
    harness.state_mut().editor.apply(Command::SetShow(Show { skeleton: true, ..Show::default() }));
    harness.run();
    assert!(!is_disabled(&harness, text::UNDO_STEP));
    press(&mut harness, text::UNDO_STEP);
    assert!(!harness.state().state().display.show.skeleton);
    assert!(is_disabled(&harness, text::UNDO_STEP));
    press(&mut harness, text::REDO_STEP);
    assert!(harness.state().state().display.show.skeleton);
}

#[test]
fn export_offers_what_the_view_has() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, text::EXPORT);
    assert!(harness.query_by_label(text::SAVE_MAP).is_none(), "the clip is the model's own");
    press(&mut harness, text::save_clip(ClipFormat::Glb));
    harness.state_mut().editor.apply(Command::SetClip(ClipChoice::called("3")));
    harness.run();
    for entry in [text::SAVE_GLB, text::SAVE_MAP, text::save_clip(ClipFormat::Bvh), text::SAVE_ALL_CLIPS] {
        choose(&mut harness, text::EXPORT, entry);
    }
    let files = [
        Export::Clip { clip: ClipId::Own(0), format: ClipFormat::Glb },
        Export::Model { clip: ClipId::Borrowed(motion_called("dance.bvh"), 0) },
        Export::Map { motion: motion_called("dance.bvh") },
        Export::Clip { clip: ClipId::Borrowed(motion_called("dance.bvh"), 0), format: ClipFormat::Bvh },
        Export::AllClips,
    ];
    assert_eq!(harness.state().actions, files.map(|file| UiAction::Save(Saved::File(file))));
    harness.state_mut().actions.clear();
    choose(&mut harness, text::EXPORT, text::SAVE_IMAGE);
    choose(&mut harness, text::EXPORT, text::RECORD);
    let actions = &harness.state().actions;
    assert!(matches!(actions[..], [UiAction::Save(Saved::Picture { .. }), UiAction::Record(_)]), "{actions:?}");
    choose(&mut harness, text::EXPORT, text::PICTURE_SETTINGS);
    assert_eq!(harness.state().panels.layout.tab, Tab::Camera);
    harness.run();
    let settings = harness.get_by_label(text::RECORD_IMAGES).rect();
    assert!(settings.bottom() < WIDE[1], "the settings are in sight, {settings:?}");
}

#[test]
fn an_entry_pressed_by_key_closes_its_menu_and_gives_the_focus_back() {
    let mut harness = sample_bench(WIDE);
    for (menu, entry) in [(text::EXPORT, text::SAVE_IMAGE), (text::EXPORT, text::PICTURE_SETTINGS)] {
        harness.get_by_label(menu).focus();
        press_key(&mut harness, egui::Key::Enter);
        harness.get_by_label(entry).focus();
        harness.run();
        press_key(&mut harness, egui::Key::Enter);
        harness.run();
        assert!(!egui::Popup::is_any_open(&harness.ctx), "{entry} closes the menu");
        assert!(harness.get_by_label(menu).accesskit_node().is_focused(), "{menu} has the focus again");
    }
}

#[test]
fn there_is_nothing_to_borrow_for_without_a_skeleton() {
    let is_disabled =
        |harness: &Harness<'_, Bench>| harness.get_by_label(text::BORROW_MOTION).accesskit_node().is_disabled();
    assert!(!is_disabled(&sample_bench(WIDE)));
    assert!(is_disabled(&bench(WIDE, Model::placeholder("file:fox.glb"))), "an empty stage");
}

#[test]
fn the_menu_leads_to_everything_else() {
    for size in [WIDE, NARROW, [844.0, 390.0]] {
        let mut harness = sample_bench(size);
        let host = &mut harness.state_mut().panels.host;
        (host.has_gallery, host.has_fullscreen) = (true, true);
        harness.run();
        choose(&mut harness, text::MENU, text::FULL_SCREEN);
        choose(&mut harness, text::MENU, &text::labelled(text::THEME, "Dark"));
        let expected = [UiAction::ToggleFullscreen, UiAction::SetTheme(ThemePreference::Dark)];
        assert_eq!(harness.state().actions, expected, "{size:?}");
        harness.key_press(egui::Key::Escape);
        harness.run();
        choose(&mut harness, text::MENU, text::ABOUT);
        assert!(harness.query_by_label(text::VERSION).is_some());
        press(&mut harness, text::CLOSE_ABOUT);
        assert!(harness.query_by_label(text::VERSION).is_none());
    }
    let mut phone = sample_bench(NARROW);
    phone.state_mut().panels.host.has_gallery = true;
    phone.run();
    choose(&mut phone, text::MENU, text::SAMPLES);
    assert_eq!(std::mem::take(&mut phone.state_mut().actions), [UiAction::ShowGallery]);
    phone.key_press(egui::Key::Escape);
    phone.run();
    choose(&mut phone, text::MENU, text::SAVE_IMAGE);
    assert_eq!(phone.state().actions.len(), 1);
}

#[test]
fn the_page_describes_itself_as_the_program_does() {
    let (page, manifest) = (include_str!("../../web/index.html"), include_str!("../../web/manifest.webmanifest"));
    let description = env!("CARGO_PKG_DESCRIPTION");
    let heading = text::TAGLINE.trim_end_matches('.');
    for expected in [
        format!("<p>{}</p>", text::TAGLINE),
        format!("<h2 id=\"gallery-title\">{heading}</h2>"),
        format!("<meta name=\"description\" content=\"{description} "),
        format!("<meta property=\"og:description\" content=\"{description}\">"),
    ] {
        assert!(page.contains(&expected), "{expected}");
    }
    assert!(manifest.contains(&format!("\"description\": \"{description}\"")), "{description}");
}

#[test]
fn keys_of_an_open_menu_do_nothing_else() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, text::MENU);
    assert_eq!(press_key(&mut harness, egui::Key::ArrowDown), []);
    // The first one gives the focus back to the menu's button, which loses it with the second.
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert_ne!(press_key(&mut harness, egui::Key::ArrowDown), [], "the camera has them again");
    press(&mut harness, text::MENU);
    press_key(&mut harness, egui::Key::Escape);
    assert_ne!(press_key(&mut harness, egui::Key::ArrowDown), [], "and at once, if the menu never had the focus");
}

#[test]
fn an_open_model_lends_its_motion() {
    let mut library = Library::default();
    library.add(samples::load(samples::WALKER).expect("is generated"));
    let walker = library.active().expect("just added").asset.clone();
    library.add(Model::new("dancer.glb".to_owned(), walker, Vec::new()));
    library.add(Model::new("still.glb".to_owned(), model_with_clips(0).asset, Vec::new()));
    let first = library.models()[0].id;
    library.show(first);
    let mut harness = bench_of(WIDE, library);
    assert!(harness.query_by_label(&text::borrow_from("still.glb")).is_none(), "it has no clips");
    let dancer = harness.state().library().models()[1].id;
    let [borrow, close] = [text::borrow_from("dancer.glb"), text::close_model("dancer.glb")]
        .map(|label| harness.get_by_label(&label).rect());
    assert!(borrow.width() < 60.0 && borrow.right() < close.left(), "{borrow} {close}");
    press(&mut harness, &text::borrow_from("dancer.glb"));
    assert_eq!(harness.state().actions, [UiAction::BorrowFrom(dancer)]);
    let editor = &mut harness.state_mut().editor;
    editor.borrow_from(dancer, &mut |_| Ok(())).expect("it has the same joints");
    let (library, state) = (editor.library(), editor.state());
    assert_eq!(library.active().expect("a model").clips().borrowed().count(), 3);
    assert_eq!(state.character.sources.motion, ["dancer.glb"]);
    assert!(harness.state_mut().editor.undo());
    assert_eq!(harness.state().library().motions().len(), 0);
}
