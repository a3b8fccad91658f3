//! Names of clips in a saved copy of a model's file.

use std::path::{Path, PathBuf};

use gaitway_formats::{FileSet, load};
use gaitway_retarget::ClipChanges;
use gaitway_scene::editor::{Editor, Export};
use gaitway_scene::library::{ClipId, Model};
use gaitway_scene::state::{ClipChoice, ClipEdit, Command};

use super::{editor, open_motion};
use crate::data_folder::data_folder;

fn model(editor: &Editor) -> &Model {
    editor.library().active().expect("a model")
}

fn edit(editor: &mut Editor, clip: &ClipId, edit: ClipEdit) {
    editor.apply(Command::EditClip { clip: clip.clone(), edit });
}

fn rename(editor: &mut Editor, clip: &ClipId, name: &str) {
    edit(editor, clip, ClipEdit::Rename(name.to_owned()));
}

fn turn(editor: &mut Editor, clip: &ClipId) {
    edit(editor, clip, ClipEdit::Change(Box::new(ClipChanges { turn_degrees: 10.0, ..ClipChanges::NONE })));
}

/// The names of the clips in the file that “Save GLB” writes while a clip plays.
fn saved(editor: &mut Editor, clip: &ClipId) -> Vec<String> {
    editor.apply(Command::SetClip(ClipChoice::Clip(clip.clone())));
    let file = editor.export(&Export::Model { clip: clip.clone() }).expect("is written");
    let mut files = FileSet::default();
    files.insert("saved.glb", file.bytes);
    load(&files).expect("a GLB").clips.iter().map(|clip| clip.name().to_owned()).collect()
}

/// The files of a folder and those below it that may be models with clips of their own.
fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        let extension = path.extension().and_then(|extension| extension.to_str());
        if path.is_dir() {
            files_below(&path, found);
        } else if matches!(extension, Some("glb" | "gltf" | "vrm" | "fbx" | "bvh")) {
            found.push(path);
        }
    }
}

/// Models with clips of their own that have a file.
fn models() -> Vec<String> {
    let mut found = vec![PathBuf::from("sample:pilot")];
    if let Some(data) = data_folder() {
        ["khronos", "threejs", "kaykit"].into_iter().for_each(|folder| files_below(&data.join(folder), &mut found));
        found.push(data.join("cosc422/ArmyPilot.glb"));
    }
    found.into_iter().map(|path| path.to_str().expect("a plain path").to_owned()).collect()
}

/// The identities of a model's own clips; none if it can't be opened.
fn opened(file: &str) -> Option<(Editor, Vec<ClipId>)> {
    let contents = crate::opened::try_contents(&[file])?;
    let mut editor = Editor::default();
    editor.open(contents, None, &mut super::any).ok()?;
    let own: Vec<ClipId> = (0..model(&editor).asset.clips.len()).map(ClipId::Own).collect();
    (!own.is_empty()).then_some((editor, own))
}

#[test]
fn a_saved_model_has_each_renamed_clip_once() {
    let mut count = 0;
    for file in models() {
        let Some((mut editor, own)) = opened(&file) else { continue };
        count += 1;
        for (at, clip) in own.iter().enumerate() {
            rename(&mut editor, clip, &format!("Renamed {at}"));
        }
        let titles: Vec<String> = own.iter().map(|clip| title(&editor, clip)).collect();
        assert_eq!(titles, (0..own.len()).map(|at| format!("Renamed {at}")).collect::<Vec<_>>(), "{file}");
        for clip in [&own[0], &own[own.len() - 1]] {
            assert_eq!(saved(&mut editor, clip), titles, "{file}: {clip:?}");
        }
        // Beside a clip that is added, the others have their names as well.
        let copies = ClipEdit::Copy(Box::new(ClipChanges { turn_degrees: 10.0, ..ClipChanges::NONE }));
        edit(&mut editor, &own[0], copies);
        let copy = model(&editor).clips().iter().last().expect("a copy").id().clone();
        let with_copy: Vec<String> = titles.iter().cloned().chain([title(&editor, &copy)]).collect();
        assert_eq!(saved(&mut editor, &copy), with_copy, "{file}");
    }
    assert!(count > 1 || data_folder().is_none(), "{count} models");
}

fn title(editor: &Editor, clip: &ClipId) -> String {
    model(editor).clip(clip).expect("is listed").title().to_owned()
}

#[test]
fn a_clip_that_is_changed_is_added_beside_its_original_under_the_name_it_was_given() {
    let mut editor = editor("sample:pilot");
    let own = [0, 1].map(ClipId::Own);
    let names: Vec<String> = model(&editor).asset.clips.iter().map(|clip| clip.name().to_owned()).collect();
    let others = &names[2..];
    let check = |editor: &mut Editor, clip: &ClipId, expected: &[&str]| {
        let mut found = saved(editor, clip);
        assert_eq!(found.drain(2..names.len()).collect::<Vec<_>>(), others);
        assert_eq!(found, expected);
    };
    turn(&mut editor, &own[0]);
    check(&mut editor, &own[0], &[&names[0], &names[1], &format!("{} (changed)", names[0])]);
    rename(&mut editor, &own[0], "Turned");
    check(&mut editor, &own[0], &[&names[0], &names[1], "Turned"]);
    // The file has its original, whichever clip is added.
    rename(&mut editor, &own[1], "Second");
    check(&mut editor, &own[1], &[&names[0], "Second"]);
    // The name that is free again on the page is that of the original in the file.
    rename(&mut editor, &own[1], &names[0]);
    assert_eq!(title(&editor, &own[1]), names[0]);
    check(&mut editor, &own[0], &[&format!("{} (2)", names[0]), &names[0], "Turned"]);
    check(&mut editor, &own[1], &[&format!("{} (2)", names[0]), &names[0]]);
    // A name that another clip has in the file.
    rename(&mut editor, &own[0], "");
    rename(&mut editor, &own[1], &format!("{} (changed)", names[0]));
    check(
        &mut editor,
        &own[0],
        &[&names[0], &format!("{} (changed)", names[0]), &format!("{} (changed) (2)", names[0])],
    );
}

#[test]
fn a_renamed_clip_is_saved_beside_a_borrowed_one() {
    let mut editor = editor("sample:pilot");
    let names: Vec<String> = model(&editor).asset.clips.iter().map(|clip| clip.name().to_owned()).collect();
    open_motion(&mut editor, "dance.glb");
    rename(&mut editor, &ClipId::Own(0), "Stroll");
    let borrowed = model(&editor).clips().borrowed().next().expect("a clip").0.id().clone();
    rename(&mut editor, &borrowed, "Dance");
    let expected: Vec<&str> = ["Stroll"].into_iter().chain(names[1..].iter().map(|name| &**name)).collect();
    assert_eq!(saved(&mut editor, &borrowed), [&expected[..], &["Dance"]].concat());
}
