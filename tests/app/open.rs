//! What becomes of opened files, and that all of it can be taken back.

use std::io::Write;
use std::path::PathBuf;

use gaitway::samples;
use gaitway::state::{ClipChoice, Command, to_link};
use gaitway::ui::{Tab, text};

use crate::desk::{desk, real};

#[test]
fn a_second_model_is_shown_and_the_first_waits() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.command(Command::SetClip(ClipChoice::Named("run".to_owned())));
    desk.open(&["sample:creature".into()]);
    assert_eq!(desk.shown(), "sample:creature");
    assert_eq!(desk.models(), ["sample:pilot", "sample:creature"]);
    assert!(desk.says("Opened Fox"), "it is said");
    desk.press("Pilot");
    assert_eq!(desk.shown(), "sample:pilot");
    assert_eq!(desk.state().playhead.clip, ClipChoice::Named("run".to_owned()), "as it was left");
}

#[test]
fn what_was_opened_can_be_taken_back() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let before = desk.state().clone();
    desk.open(&["sample:creature".into()]);
    desk.press(text::UNDO);
    assert_eq!((desk.shown(), desk.state()), ("sample:pilot", &before));
    assert!(desk.says("Back to Pilot. Ctrl+Y returns to Fox."));
    desk.redo();
    assert_eq!(desk.shown(), "sample:creature");
}

#[test]
fn the_same_file_again_is_the_model_that_is_there() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:creature".into()]);
    desk.open(&["sample:pilot".into()]);
    assert_eq!(desk.models(), ["sample:pilot", "sample:creature"]);
    assert_eq!(desk.shown(), "sample:pilot");
    assert!(desk.says("Reopened Pilot."));
}

#[test]
fn a_closed_model_gives_way_to_its_neighbour_and_comes_back() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:creature".into()]);
    desk.open(&["sample:dwarf".into()]);
    desk.press(&text::close_model("Dwarf"));
    assert_eq!((desk.shown(), desk.models()), ("sample:creature", vec!["sample:pilot", "sample:creature"]));
    desk.undo();
    assert_eq!(desk.shown(), "sample:dwarf");
    assert_eq!(desk.models().len(), 3);
    // One that is not shown only leaves the list.
    desk.press(&text::close_model("Pilot"));
    assert_eq!((desk.shown(), desk.models()), ("sample:dwarf", vec!["sample:creature", "sample:dwarf"]));
    desk.undo();
    assert_eq!(desk.models().len(), 3);
}

#[test]
fn a_motion_is_borrowed_from_and_goes_and_comes_with_undo() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:walk".into()]);
    assert_eq!(desk.shown(), "sample:pilot", "a motion does not replace the model");
    assert_eq!(desk.borrowed_clips(), 1);
    assert!(desk.says("Added 1 clip from Walk."));
    let clip = desk.state().playhead.clip.clone();
    assert_ne!(clip, ClipChoice::First, "it plays");
    desk.undo();
    assert_eq!((desk.borrowed_clips(), desk.library().motions().len()), (0, 0));
    assert!(desk.says("Removed motion Walk. Ctrl+Y brings it back."));
    desk.redo();
    assert_eq!((desk.borrowed_clips(), &desk.state().playhead.clip), (1, &clip));
    assert!(desk.says("Added motion Walk again."));
    assert!(!desk.says("Search joints of the model"), "the tab stays");
    desk.press(Tab::Motion.label());
    assert!(desk.says("Search joints of the model"));
    desk.undo();
    desk.redo();
    assert!(desk.says("Search joints of the model"), "back in the tab that was open");
}

#[test]
fn a_motion_goes_along_to_a_model_that_it_fits_and_quietly_leaves_another() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    desk.open(&["sample:walk".into()]);
    desk.open(&["sample:mannequin".into()]);
    assert_eq!((desk.shown(), desk.borrowed_clips()), ("sample:mannequin", 1));
    desk.open(&["sample:morphs".into()]);
    assert_eq!((desk.borrowed_clips(), desk.library().motions().len()), (0, 0));
    assert!(desk.says("it doesn't fit this model"), "and says so");
    assert_eq!(desk.problem(), None, "nobody asked for it: no error");
    desk.press("Mannequin");
    assert_eq!(desk.borrowed_clips(), 1);
}

#[test]
fn a_motion_that_fits_nowhere_changes_nothing_and_can_be_mapped_by_hand() {
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
fn a_joint_map_without_a_motion_is_refused_and_with_one_is_a_step() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let map = std::env::temp_dir().join(format!("gaitway-app-map-{}.json", std::process::id()));
    std::fs::write(&map, r#"{"gaitway_map": 1, "joints": {"mixamorig:Hips": {"source": "hip"}}}"#).expect("written");
    let before = desk.state().clone();
    desk.open(std::slice::from_ref(&map));
    let problem = desk.problem().expect("is said").to_owned();
    assert!(problem.contains("no motion is loaded"), "{problem}");
    assert_eq!(desk.state(), &before);
    desk.open(&["sample:walk".into()]);
    let proposed = desk.state().retarget.map.clone();
    desk.open(std::slice::from_ref(&map));
    std::fs::remove_file(&map).expect("was there");
    assert_eq!(desk.problem(), None);
    assert_ne!(desk.state().retarget.map, proposed);
    assert!(desk.says("Applied the joint map to Walk."));
    desk.undo();
    assert_eq!(desk.state().retarget.map, proposed);
}

#[test]
fn a_file_that_cannot_be_read_loses_nothing() {
    let Some(mut desk) = desk("sample:pilot") else { return };
    let file = std::env::temp_dir().join(format!("gaitway-app-{}.glb", std::process::id()));
    std::fs::write(&file, b"glTF").expect("written");
    let before = desk.state().clone();
    desk.open(std::slice::from_ref(&file));
    std::fs::remove_file(&file).expect("was there");
    assert!(desk.problem().is_some_and(|problem| problem.contains(".glb")), "{:?}", desk.problem());
    assert_eq!((desk.shown(), desk.state()), ("sample:pilot", &before));
    desk.press(text::DISMISS_ERROR);
    assert_eq!(desk.problem(), None);
}

#[test]
fn of_an_archive_a_link_names_the_model_that_is_shown() {
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
    assert_eq!(desk.state().sources.model, std::slice::from_ref(&file), "the first one");
    desk.press("dwarf.glb");
    assert_eq!(desk.state().sources.model, [format!("{file}#!/in/dwarf.glb")]);
    assert!(to_link(desk.state()).contains("%23!/in/dwarf.glb"), "{}", to_link(desk.state()));
}

#[test]
fn real_files_are_put_where_they_belong() {
    let (Some(soldier), Some(walk), Some(obj)) =
        (real("threejs/Soldier.glb"), real("bvh/cmu_01_01.bvh"), real("mit6837/Model1.obj"))
    else {
        return;
    };
    let Some(mut desk) = desk("sample:pilot") else { return };
    // All at once: one is the model, the other its motion.
    desk.open(&[soldier, walk]);
    assert!(desk.shown().ends_with("Soldier.glb") && desk.borrowed_clips() == 1, "{}", desk.shown());
    assert!(desk.says("Opened Soldier.glb. Added 1 clip from cmu_01_01.bvh."));
    // Where nothing lies beside it, and then does.
    let folder = std::env::temp_dir().join(format!("gaitway-app-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("made");
    let copies = ["obj", "skel", "attach"].map(|ending| folder.join("Model1").with_extension(ending));
    let copied = |copy: &PathBuf| {
        std::fs::copy(obj.with_extension(copy.extension().expect("has one")), copy).expect("copied");
    };
    copied(&copies[0]);
    desk.open(&copies[..1]);
    assert!(desk.library().active().expect("a model").asset.skins.is_empty());
    assert!(desk.says("Open its .skel and .attach as well to add its joints."));
    copies[1..].iter().for_each(copied);
    desk.open(&copies);
    std::fs::remove_dir_all(&folder).expect("was there");
    assert!(!desk.library().active().expect("a model").asset.skins.is_empty());
    let objs = desk.models().iter().filter(|name| name.ends_with(".obj")).count();
    assert_eq!(objs, 1, "the whole one takes the place of the bare one");
}
