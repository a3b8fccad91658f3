//! Clips keep their identity: edits stay on theirs whatever becomes of the motions, and names are only what people call them.

use std::collections::BTreeMap;

use gaitway_formats::{FileSet, load};
use gaitway_retarget::{ClipChanges, ClipLayer, JointMap};
use gaitway_scene::editor::{ClipFormat, Editor, Export};
use gaitway_scene::library::{ClipId, LayeredClip, Model, REST_POSE};
use gaitway_scene::state::{ClipChoice, ClipEdit, Command, from_link, to_link};

use super::{editor, motions, open_motion, title};
use crate::by_place::{ByPlace, motion_at};
use crate::random::Random;

const FILES: [&str; 4] = ["walk.glb", "run.glb", "jump.glb", "turn.glb"];

fn model(editor: &Editor) -> &Model {
    editor.library().active().expect("a model")
}

fn edit(editor: &mut Editor, clip: ClipId, edit: ClipEdit) {
    editor.apply(Command::EditClip { clip, edit });
}

/// The file and the number in it that a clip is from; that of a copy is its original's.
fn source(editor: &Editor, clip: &ClipId) -> (String, usize) {
    let clip = model(editor).clip(clip).expect("is in the list");
    match (clip.borrowed(), clip.original_id()) {
        (Some(borrowed), _) => {
            let motion = editor.library().motion(&borrowed.motion).expect("is loaded");
            (motion.source.clone(), borrowed.source_clip)
        }
        (None, ClipId::Own(index)) => ("own".to_owned(), *index),
        (None, original) => panic!("{original:?}"),
    }
}

/// Turns every clip by an angle of its own, and adds a copy and a layer with it.
fn edit_all(editor: &mut Editor) -> BTreeMap<(String, usize), f64> {
    let clips: Vec<ClipId> = model(editor).clips().iter().map(|clip| clip.id().clone()).collect();
    let mut angles = BTreeMap::new();
    let mut layers = Vec::new();
    for (at, clip) in clips.into_iter().enumerate() {
        let turn_degrees = 1.0 + at as f64;
        angles.insert(source(editor, &clip), turn_degrees);
        let turned = || Box::new(ClipChanges { turn_degrees, ..ClipChanges::NONE });
        edit(editor, clip.clone(), ClipEdit::Change(turned()));
        edit(editor, clip.clone(), ClipEdit::Copy(turned()));
        layers.push(LayeredClip { clip, layer: ClipLayer { start_secs: turn_degrees, ..ClipLayer::default() } });
    }
    editor.apply(Command::SetLayers(layers));
    angles
}

/// Each clip and each copy is turned by the angle of its source, each layer starts after as many seconds, and none is missing.
fn check(editor: &Editor, angles: &BTreeMap<(String, usize), f64>, after: &str) {
    let (library, edits) = (model(editor), &editor.state().character.edits);
    let mut turned: BTreeMap<(String, usize), Vec<f64>> = BTreeMap::new();
    for clip in library.clips() {
        let changes = edits.clips.changes_of(clip.id());
        assert_eq!(clip.clip().is_same(clip.unchanged()), changes.is_none(), "{after}: {:?}", clip.id());
        turned.entry(source(editor, clip.id())).or_default().push(changes.turn_degrees);
    }
    for (source, found) in turned {
        let expected = angles.get(&source).map_or(vec![0.0], |&angle| vec![angle; 2]);
        assert_eq!(found, expected, "{after}: {source:?}");
    }
    for LayeredClip { clip, layer } in edits.layers.iter().filter(|over| library.clip(&over.clip).is_some()) {
        assert_eq!(Some(&layer.start_secs), angles.get(&source(editor, clip)), "{after}: {clip:?}");
    }
}

#[test]
fn every_remaining_edit_is_on_its_clip_whatever_becomes_of_the_motions() {
    for seed in 0..12 {
        let mut random = Random(seed);
        let mut editor = editor("sample:pilot");
        FILES[..3].iter().for_each(|file| open_motion(&mut editor, file));
        let mut angles = edit_all(&mut editor);
        check(&editor, &angles, "editing");
        for _ in 0..12 {
            let count = editor.library().motions().len();
            let after = match random.below(5) {
                // Opened again, it comes last.
                0 => {
                    let file = FILES[random.below(FILES.len())];
                    open_motion(&mut editor, file);
                    format!("opening {file}")
                }
                1 if count > 0 => {
                    let removed = motion_at(editor.library(), random.below(count));
                    let file = editor.library().motion(&removed).expect("is loaded").source.clone();
                    editor.remove_motion(&removed);
                    if random.below(2) == 0 {
                        assert!(editor.undo());
                    } else {
                        angles.retain(|(source, _), _| *source != file);
                    }
                    format!("removing {file}")
                }
                // Motions of the same joints share their map.
                2 if count > 0 => {
                    let map = Some(Box::new(JointMap::with_proposed_options()));
                    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map });
                    check(&editor, &angles, "unmapping all");
                    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: None });
                    "mapping again".to_owned()
                }
                3 => {
                    let link = to_link(editor.state(), editor.library());
                    let (view, errors) = from_link(&link);
                    assert_eq!(errors, []);
                    editor.apply(Command::Replace(Box::new(view)));
                    assert_eq!(to_link(editor.state(), editor.library()), link);
                    "following its own link".to_owned()
                }
                _ => {
                    let clip = model(&editor).id_at(random.below(model(&editor).clips().len()));
                    editor.apply(Command::SetClip(ClipChoice::Clip(clip)));
                    "playing".to_owned()
                }
            };
            check(&editor, &angles, &format!("seed {seed}, {after}, {:?}", motions(&editor)));
        }
    }
}

#[test]
fn a_clip_is_renamed_on_the_page_in_the_link_and_in_files() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let borrowed = ClipId::Borrowed(motion_at(editor.library(), 0), 0);
    let own = ClipId::Own(0);
    let before = to_link(editor.state(), editor.library());
    for (clip, name) in [(&borrowed, "Stroll"), (&own, "March: 1")] {
        editor.apply(Command::SetClip(ClipChoice::Clip(clip.clone())));
        edit(&mut editor, clip.clone(), ClipEdit::Rename(format!(" {name}\n")));
        editor.end_gesture();
        assert_eq!(title(&editor), Some(name));
        for what in [Export::Clip { clip: clip.clone(), format: ClipFormat::Glb }, Export::Model { clip: clip.clone() }]
        {
            let mut files = FileSet::default();
            files.insert("written.glb", editor.export(&what).expect("is written").bytes);
            let written = load(&files).expect("a GLB");
            assert_eq!(written.clips.iter().filter(|clip| clip.name() == name).count(), 1, "{what:?}");
        }
    }
    let link = to_link(editor.state(), editor.library());
    assert!(link.contains("rename="), "{link}");

    // Another page that opens the link has the names as well.
    let mut other = self::editor("sample:pilot");
    open_motion(&mut other, "dance.glb");
    let (mut view, errors) = from_link(&link);
    assert_eq!(errors, []);
    view.character.sources = other.state().character.sources.clone();
    other.apply(Command::Replace(Box::new(view)));
    let names = [&own, &borrowed].map(|clip| model(&other).clip(clip).expect("is there").title());
    assert_eq!((title(&other), names), (Some("March: 1"), ["March: 1", "Stroll"]));
    assert_eq!(to_link(other.state(), other.library()), link);

    // Undone one by one.
    assert!(editor.undo() && editor.undo());
    assert_eq!(editor.state().character.edits.clips.names, BTreeMap::new());
    editor.apply(Command::SetClip(ClipChoice::Clip(borrowed)));
    assert_eq!(to_link(editor.state(), editor.library()), before);
}

#[test]
fn no_two_clips_get_the_same_name_and_an_empty_one_restores_the_files() {
    let mut editor = editor("sample:walker");
    let rename = |editor: &mut Editor, name: &str| {
        edit(editor, ClipId::Own(0), ClipEdit::Rename(name.to_owned()));
        title(editor).expect("plays").to_owned()
    };
    assert_eq!(rename(&mut editor, "Wave"), "Wave (2)", "another clip has the name");
    assert_eq!(rename(&mut editor, REST_POSE), "Rest pose (2)", "the list has one");
    assert_eq!(rename(&mut editor, "Stroll"), "Stroll");
    assert_eq!(rename(&mut editor, &"x".repeat(100)), "x".repeat(80));
    assert_eq!(rename(&mut editor, " \n"), "Walk");
    assert!(editor.state().character.edits.clips.names.is_empty());
    // Copies have no other name than their own.
    edit(&mut editor, ClipId::Own(0), ClipEdit::Copy(Box::default()));
    let copy = model(&editor).id_at(3);
    edit(&mut editor, copy.clone(), ClipEdit::Rename(String::new()));
    assert_eq!(title(&editor), Some("Walk part 1"));
    edit(&mut editor, copy, ClipEdit::Rename("Half".to_owned()));
    assert_eq!(title(&editor), Some("Half"));
    assert!(to_link(editor.state(), editor.library()).contains("copy=Half:Walk"));
}
