//! Opening files, and undoing all of it.

use std::cell::RefCell;
use std::io::Write;
use std::path::PathBuf;
use std::rc::Rc;

use gaitway::app::Message;
use gaitway::ui::{Tab, text};
use gaitway_scene::editor::{AboutLink, ClipFormat, Contents};
use gaitway_scene::library::ModelClip;
use gaitway_scene::samples;
use gaitway_scene::state::{ClipChoice, Command, active_clip, from_link, to_link};

use crate::desk::{desk, real};

#[test]
fn a_second_model_becomes_active_and_the_first_stays_listed() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.command(Command::SetClip(ClipChoice::called("run")));
    desk.open(&["sample:creature".into()]);
    assert_eq!(desk.active(), "sample:creature");
    assert_eq!(desk.models(), ["sample:pilot", "sample:creature"]);
    assert!(desk.shows("Opened Fox"), "a notice says so");
    desk.press("Pilot");
    assert_eq!(desk.active(), "sample:pilot");
    let clip = active_clip(desk.library().active().expect("a model"), desk.state()).map(ModelClip::title);
    assert_eq!(clip, Some("run"), "its view is restored");
}

#[test]
fn opening_can_be_undone() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let before = desk.state().clone();
    desk.open(&["sample:creature".into()]);
    desk.press(text::UNDO);
    assert_eq!((desk.active(), desk.state()), ("sample:pilot", &before));
    assert!(desk.shows("Back to Pilot. Redo returns to Fox."));
    desk.redo();
    assert_eq!(desk.active(), "sample:creature");
}

#[test]
fn opening_the_same_file_again_activates_the_loaded_model() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:creature".into()]);
    desk.open(&["sample:pilot".into()]);
    assert_eq!(desk.models(), ["sample:pilot", "sample:creature"]);
    assert_eq!(desk.active(), "sample:pilot");
    assert!(desk.shows("Reopened Pilot."));
}

#[test]
fn closing_activates_the_neighbour_and_can_be_undone() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:creature".into()]);
    desk.open(&["sample:dwarf".into()]);
    let opened = ["sample:pilot", "sample:creature", "sample:dwarf"];
    desk.press(&text::close_model("Dwarf"));
    assert_eq!((desk.active(), desk.models()), ("sample:creature", vec!["sample:pilot", "sample:creature"]));
    desk.undo();
    assert_eq!(desk.active(), "sample:dwarf");
    assert_eq!(desk.models(), opened);
    // Closing an inactive model only removes it from the list.
    desk.press(&text::close_model("Pilot"));
    assert_eq!((desk.active(), desk.models()), ("sample:dwarf", vec!["sample:creature", "sample:dwarf"]));
    desk.undo();
    assert_eq!(desk.models(), opened);
}

#[test]
fn a_motion_is_retargeted_and_follows_undo_and_redo() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:walk".into()]);
    assert_eq!(desk.active(), "sample:pilot", "a motion does not replace the model");
    assert_eq!(desk.retargeted_clips(), 1);
    assert!(desk.shows("Added 1 clip from Walk."));
    let clip = desk.state().character.playhead.clip.clone();
    assert_ne!(clip, ClipChoice::First, "the new clip plays");
    desk.undo();
    assert_eq!((desk.retargeted_clips(), desk.library().motions().len()), (0, 0));
    assert!(desk.shows("Removed motion Walk. Redo brings it back."));
    desk.redo();
    assert_eq!((desk.retargeted_clips(), &desk.state().character.playhead.clip), (1, &clip));
    assert!(desk.shows("Added motion Walk again."));
    assert!(desk.shows(text::SEARCH_JOINTS), "borrowing brought the tab forward");
    desk.press(Tab::Scene.label());
    desk.undo();
    desk.redo();
    assert!(!desk.shows(text::SEARCH_JOINTS), "the tab that was open stays");
}

#[test]
fn what_is_saved_is_told() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.press(text::EXPORT);
    desk.press(text::save_clip(ClipFormat::Glb));
    assert!(desk.shows("Saved Pilot-"), "{:?}", desk.problem());
}

/// Before the first edit of the map, the last step is the motion itself, and with it the tab.
#[test]
fn the_motion_tabs_arrows_take_back_its_own_edits_only() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:walk".into()]);
    desk.press(Tab::Motion.label());
    let proposed = desk.state().character.retarget.map.clone();
    desk.press(text::UNDO_KEY);
    assert_eq!(desk.library().motions().len(), 1, "the motion stays");
    desk.press(text::CLEAR_MAP);
    assert_ne!(desk.state().character.retarget.map, proposed);
    desk.press(text::UNDO_KEY);
    desk.press(text::UNDO_KEY);
    assert_eq!((desk.library().motions().len(), &desk.state().character.retarget.map), (1, &proposed));
    desk.press(text::REDO_KEY);
    assert_ne!(desk.state().character.retarget.map, proposed);
    // Ctrl+Z undoes every step, not only map edits.
    desk.undo();
    desk.undo();
    assert_eq!(desk.library().motions().len(), 0);
}

#[test]
fn a_motion_stays_with_a_model_it_fits_and_is_dropped_without_an_error_otherwise() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:walk".into()]);
    desk.open(&["sample:mannequin".into()]);
    assert_eq!((desk.active(), desk.retargeted_clips()), ("sample:mannequin", 1));
    desk.open(&["sample:morphs".into()]);
    assert_eq!((desk.retargeted_clips(), desk.library().motions().len()), (0, 0));
    assert!(desk.shows("it doesn't fit this model"), "a notice says so");
    assert_eq!(desk.problem(), None, "the user didn't request it: no error");
    desk.press("Mannequin");
    assert_eq!(desk.retargeted_clips(), 1);
}

#[test]
fn an_incompatible_motion_changes_nothing_and_can_be_mapped_manually() {
    let Some(mut desk) = desk("sample:morphs") else { return };
    let before = desk.state().clone();
    desk.open(&["sample:walk".into()]);
    let problem = desk.problem().expect("is said");
    assert!(problem.contains("no joint in common with Goblin"), "{problem}");
    assert_eq!((desk.state(), desk.library().motions().len()), (&before, 0));
    desk.press(text::MAP_REFUSED_MANUALLY);
    assert_eq!((desk.problem(), desk.library().motions().len()), (None, 1));
    desk.undo();
    assert_eq!(desk.library().motions().len(), 0);
}

#[test]
fn a_joint_map_needs_a_motion_and_is_an_undo_step() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let map = std::env::temp_dir().join(format!("gaitway-app-map-{}.json", std::process::id()));
    std::fs::write(&map, r#"{"gaitway_map": 1, "joints": {"mixamorig:Hips": {"source": "hip"}}}"#).expect("written");
    let before = desk.state().clone();
    desk.open(std::slice::from_ref(&map));
    let problem = desk.problem().expect("is said");
    assert!(problem.contains("no motion is loaded"), "{problem}");
    assert_eq!(desk.state(), &before);
    desk.open(&["sample:walk".into()]);
    let proposed = desk.state().character.retarget.map.clone();
    desk.open(std::slice::from_ref(&map));
    std::fs::remove_file(&map).expect("was there");
    assert_eq!(desk.problem(), None);
    assert_ne!(desk.state().character.retarget.map, proposed);
    assert!(desk.shows("Applied the joint map and its options to Walk."));
    desk.undo();
    assert_eq!(desk.state().character.retarget.map, proposed);
}

#[test]
fn an_unreadable_file_changes_nothing() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let file = std::env::temp_dir().join(format!("gaitway-app-{}.glb", std::process::id()));
    std::fs::write(&file, b"glTF").expect("written");
    let before = desk.state().clone();
    desk.open(std::slice::from_ref(&file));
    std::fs::remove_file(&file).expect("was there");
    assert!(desk.problem().is_some_and(|problem| problem.contains(".glb")), "{:?}", desk.problem());
    assert_eq!((desk.active(), desk.state()), ("sample:pilot", &before));
    desk.press(text::DISMISS_ERROR);
    assert_eq!(desk.problem(), None);
}

#[test]
fn the_link_names_the_active_model_of_an_archive() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let archive = std::env::temp_dir().join(format!("gaitway-app-{}.zip", std::process::id()));
    let mut writer = zip::ZipWriter::new(std::fs::File::create(&archive).expect("created"));
    for name in ["creature", "dwarf"] {
        for (file, bytes) in samples::files(name) {
            writer.start_file(format!("in/{file}"), zip::write::SimpleFileOptions::default()).expect("begun");
            writer.write_all(bytes).expect("written");
        }
    }
    writer.finish().expect("finished");
    desk.open(std::slice::from_ref(&archive));
    std::fs::remove_file(&archive).expect("was there");
    let file = archive.file_name().and_then(|name| name.to_str()).expect("has a name").to_owned();
    assert_eq!(desk.state().character.sources.model, std::slice::from_ref(&file), "the first one");
    desk.press("dwarf.glb");
    assert_eq!(desk.state().character.sources.model, [format!("{file}#!/in/dwarf.glb")]);
    assert!(
        to_link(desk.state(), desk.library()).contains("%23!/in/dwarf.glb"),
        "{}",
        to_link(desk.state(), desk.library())
    );
}

#[test]
fn real_files_get_the_right_roles() {
    let (Some(soldier), Some(walk), Some(obj)) =
        (real("threejs/Soldier.glb"), real("bvh/cmu_01_01.bvh"), real("mit6837/Model1.obj"))
    else {
        return;
    };
    let Some(mut desk) = desk("sample:pilot") else { return };
    // Opened together, one becomes the model and the other its motion.
    desk.open(&[soldier, walk]);
    assert!(desk.active().ends_with("Soldier.glb") && desk.retargeted_clips() == 1, "{}", desk.active());
    assert!(desk.shows("Opened Soldier.glb. Added 1 clip from cmu_01_01.bvh."));
    // First without its companion files, then with them.
    let folder = std::env::temp_dir().join(format!("gaitway-app-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("made");
    let copies = ["obj", "skel", "attach"].map(|ending| folder.join("Model1").with_extension(ending));
    let copied = |copy: &PathBuf| {
        std::fs::copy(obj.with_extension(copy.extension().expect("has one")), copy).expect("copied");
    };
    copied(&copies[0]);
    desk.open(&copies[..1]);
    assert!(desk.library().active().expect("a model").asset.skins.is_empty());
    assert!(desk.shows("Open its .skel and .attach as well to add its joints."));
    copies[1..].iter().for_each(copied);
    desk.open(&copies);
    std::fs::remove_dir_all(&folder).expect("was there");
    assert!(!desk.library().active().expect("a model").asset.skins.is_empty());
    let objs = desk.models().iter().filter(|name| name.ends_with(".obj")).count();
    assert_eq!(objs, 1, "the complete model replaces the jointless one");
}

/// The shell lists what is wrong with a link beside what couldn't be opened of it; nothing is told twice.
#[test]
fn a_link_tells_all_that_is_wrong_with_it_once() {
    let Some(mut desk) = desk("sample:walker") else { return };
    let link = "v=1&model=sample:walker&speed=fast&clip=Fly&fov=200";
    let mut told = |missing: &[&str]| {
        let (view, link_errors) = from_link(link);
        let problems = missing.iter().map(|problem| (*problem).to_owned()).collect();
        let contents = Box::new(Contents {
            problems,
            about_link: AboutLink { errors: link_errors, is_partial: false },
            ..Contents::default()
        });
        let opened = Rc::new(RefCell::new(None));
        let slot = opened.clone();
        let reply =
            Some(Box::new(move |answer: Result<Vec<String>, String>| *slot.borrow_mut() = Some(answer)) as Box<_>);
        desk.send(Message::Opened { contents, state: Some(Box::new(view)), is_change: false, reply });
        let problems = opened.take().expect("is answered").expect("is loaded");
        (problems, desk.shows("“Fly”"))
    };
    assert_eq!(told(&[]), (Vec::new(), true));
    let (problems, is_shown) = told(&["walk.bvh: the server answered 404"]);
    assert!(!is_shown, "the shell shows it");
    let key = |problem: &String| problem.split([':', '=']).next().unwrap_or_default().to_owned();
    let keys: Vec<String> = problems.iter().map(key).collect();
    assert_eq!(keys, ["walk.bvh", "speed", "fov", "clip"]);
}
