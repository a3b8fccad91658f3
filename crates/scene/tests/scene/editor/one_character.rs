//! Files of one character that are opened together: one is the character, the others lend it their clips.

use std::collections::BTreeSet;

use gaitway_formats::{FileSet, OwnClips, load, write_edited_model};
use gaitway_scene::editor::{Contents, Editor, Event, ModelFiles, OpenedModel, Reading};
use gaitway_scene::library::Model;
use gaitway_scene::samples;

use super::{active, any, editor, motions, notices};

/// The creature's file with those of its clips that `keeps` names by index.
fn creature(name: &str, keeps: &[usize]) -> OpenedModel {
    written("creature", name, keeps)
}

fn written(sample: &str, name: &str, keeps: &[usize]) -> OpenedModel {
    let mut set = FileSet::default();
    samples::files(sample).for_each(|(file, bytes)| set.insert(file, bytes));
    let main = set.names().next().expect("a file").to_owned();
    let original = load(&set).expect("is valid");
    let left_out: BTreeSet<usize> = (0..original.clips.len()).filter(|index| !keeps.contains(index)).collect();
    assert_eq!(left_out.len() + keeps.len(), original.clips.len(), "{sample} has the clips {keeps:?}");
    let own = OwnClips { left_out, ..OwnClips::default() };
    let bytes = write_edited_model(&set, &main, &original.skeleton, &own, &[]).expect("is written");
    let mut set = FileSet::default();
    set.insert(name, bytes);
    let asset = load(&set).expect("is valid");
    let images = vec![None; asset.images.len()];
    OpenedModel {
        model: Model::new(name.to_owned(), asset, images),
        files: Some(ModelFiles { set, name: name.to_owned() }),
    }
}

fn drop_files(editor: &mut Editor, models: Vec<OpenedModel>) -> Vec<Event> {
    editor.open(Contents { models, is_by_hand: true, ..Contents::default() }, None, &mut any).expect("fits");
    editor.take_events()
}

fn listed(editor: &Editor) -> Vec<&str> {
    editor.library().models().iter().map(|model| model.source.as_str()).collect()
}

fn clip_count(editor: &Editor) -> usize {
    editor.library().active().expect("a model").clips().len()
}

#[test]
fn files_of_one_character_become_its_clips() {
    for files in [
        vec![creature("walk.glb", &[0]), creature("run.glb", &[1])],
        // The file without clips is the character, wherever it is in the list.
        vec![creature("run.glb", &[1]), creature("rest.glb", &[]), creature("walk.glb", &[0])],
    ] {
        let first = if files.len() == 3 { "rest.glb" } else { "walk.glb" };
        let mut editor = Editor::default();
        let events = drop_files(&mut editor, files);
        assert_eq!((active(&editor), listed(&editor)), (first, vec![first]));
        assert_eq!(clip_count(&editor), 2);
        assert!(events.contains(&Event::OtherReading(Reading::Models)), "{events:?}");
        assert!(notices(&events).iter().any(|notice| notice.contains("run.glb")), "{events:?}");
    }
}

#[test]
fn several_files_of_the_open_character_become_its_clips() {
    let mut editor = Editor::default();
    drop_files(&mut editor, vec![creature("rest.glb", &[])]);
    let events = drop_files(&mut editor, vec![creature("walk.glb", &[0]), creature("run.glb", &[1])]);
    assert_eq!((listed(&editor), motions(&editor)), (vec!["rest.glb"], vec!["walk.glb", "run.glb"]));
    assert!(events.contains(&Event::OtherReading(Reading::Models)), "{events:?}");
    // One step, which undo takes back.
    assert!(editor.undo());
    assert!(motions(&editor).is_empty());
}

#[test]
fn they_open_as_models_if_that_was_meant() {
    let mut editor = Editor::default();
    drop_files(&mut editor, vec![creature("walk.glb", &[0]), creature("run.glb", &[1])]);
    editor.read_otherwise();
    assert_eq!((active(&editor), listed(&editor)), ("walk.glb", vec!["walk.glb", "run.glb"]));
    assert_eq!((motions(&editor).len(), clip_count(&editor)), (0, 1));
    let events = editor.take_events();
    assert_eq!(notices(&events), ["run.glb is in the model list."]);
    // Only once.
    editor.read_otherwise();
    assert_eq!(listed(&editor).len(), 2);
    assert!(editor.undo());
    assert_eq!(motions(&editor), ["run.glb"]);
}

#[test]
fn other_models_stay_models() {
    // The same clip again: another version of the file.
    let mut editor = Editor::default();
    let events = drop_files(&mut editor, vec![creature("a.glb", &[0]), creature("b.glb", &[0])]);
    assert_eq!((listed(&editor).len(), motions(&editor).len()), (2, 0), "{events:?}");
    // Another character.
    let mut editor = Editor::default();
    drop_files(&mut editor, vec![creature("a.glb", &[0]), written("pilot", "b.glb", &[0])]);
    assert_eq!((listed(&editor).len(), motions(&editor).len()), (2, 0));
}

/// A link and a script say what is a model.
#[test]
fn only_what_users_open_is_taken_as_clips() {
    let mut editor = editor("sample:walker");
    let models = vec![creature("walk.glb", &[0]), creature("run.glb", &[1])];
    editor.open(Contents { models, ..Contents::default() }, None, &mut any).expect("fits");
    assert_eq!((active(&editor), listed(&editor).len(), motions(&editor).len()), ("walk.glb", 3, 0));
}
