//! Copies of clips, to cut several out of one.

use gaitway_character::anim::TimeRange;
use gaitway_formats::{FileSet, load};
use gaitway_retarget::{ClipChanges, ClipLayer, JointMap};
use gaitway_scene::editor::{ClipFormat, Editor, Export};
use gaitway_scene::library::{ClipEdits, ClipId, LayeredClip, Model, ModelClip};
use gaitway_scene::state::{ClipChoice, ClipEdit, Command, Edits, active_clip, active_map, from_link, to_link};

use super::{editor, open_motion, title};
use crate::by_place::{ByPlace, motion_at};

fn model(editor: &Editor) -> &Model {
    editor.library().active().expect("a model")
}

/// The place of the clip that plays.
fn clip(editor: &Editor) -> usize {
    let active = active_clip(model(editor), editor.state()).expect("a clip plays");
    model(editor).clips().iter().position(|clip| clip.id() == active.id()).expect("is in the list")
}

fn secs(editor: &Editor, clip: usize) -> f64 {
    model(editor).clip_at(clip).duration_secs()
}

fn edit(editor: &mut Editor, clip: usize, edit: ClipEdit) {
    editor.apply(Command::EditClip { clip: model(editor).id_at(clip), edit });
}

/// A layer with a clip that is called so.
fn layer(name: &str) -> LayeredClip {
    LayeredClip { clip: ClipId::called(name), layer: ClipLayer::default() }
}

/// Copies a part of a clip.
fn cut(editor: &mut Editor, clip: usize, start_secs: f64, end_secs: f64) {
    let changes = ClipChanges { trim: Some(TimeRange { start_secs, end_secs }), ..ClipChanges::NONE };
    edit(editor, clip, ClipEdit::Copy(Box::new(changes)));
}

#[test]
fn a_saved_clip_says_that_it_is_not_cut_to_the_range() {
    let mut editor = editor("sample:walker");
    editor.apply(Command::SetRange(Some(TimeRange { start_secs: 0.2, end_secs: 0.6 })));
    let remark =
        editor.export(&Export::Clip { clip: ClipId::Own(0), format: ClipFormat::Bvh }).expect("has keys").remark;
    assert_eq!(remark.as_deref(), Some("The file has the whole clip; “Trim to range” cuts it."));
}

#[test]
fn several_clips_are_cut_out_of_one() {
    let mut editor = editor("sample:walker");
    let whole = secs(&editor, 0);
    let titles: Vec<String> = model(&editor).clips().titles().map(str::to_owned).collect();
    cut(&mut editor, 0, 0.25, 0.5);
    assert_eq!((title(&editor), clip(&editor)), (Some("Walk part 1"), 3));
    // A copy of a copy is one of the original.
    cut(&mut editor, 3, 0.25, 1.0);
    assert_eq!((title(&editor), clip(&editor)), (Some("Walk part 2"), 4));
    assert_eq!([0, 3, 4].map(|clip| secs(&editor, clip)), [whole, 0.25, 0.75]);
    assert_eq!(model(&editor).titles()[..3], titles);
    let listed: Vec<&str> = model(&editor).clips().listed().map(ModelClip::title).collect();
    assert_eq!(listed, ["Walk", "Walk part 1", "Walk part 2", &titles[1], &titles[2]]);
    let is_derived = [0, 3].map(|clip| model(&editor).clip_at(clip).is_derived());
    assert_eq!(is_derived, [false, true], "the file has the original");

    // The file is written with the copy that plays, under its name.
    let mut files = FileSet::default();
    files.insert(
        "walker.glb",
        editor.export(&Export::Model { clip: model(&editor).id_at(4) }).expect("is written").bytes,
    );
    let written = load(&files).expect("a GLB");
    let last = written.clips.last().expect("a clip");
    assert_eq!((last.name(), last.duration_secs()), ("Walk part 2", 0.75));
}

#[test]
fn each_part_of_a_borrowed_clip_has_a_file_name_of_its_own() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let borrowed = clip(&editor);
    let name = |editor: &Editor, clip: usize| {
        editor.export(&Export::Model { clip: model(editor).id_at(clip) }).expect("is written").name
    };
    let mut names = vec![name(&editor, borrowed)];
    for start_secs in [0.1, 0.2] {
        cut(&mut editor, borrowed, start_secs, 0.5);
        names.push(name(&editor, clip(&editor)));
    }
    assert_eq!(names, ["Pilot-Walk.glb", "Pilot-Walk part 1.glb", "Pilot-Walk part 2.glb"]);
}

#[test]
fn a_copy_takes_the_layers_that_play_it_along() {
    let mut editor = editor("sample:walker");
    cut(&mut editor, 0, 0.25, 0.5);
    editor.apply(Command::SetLayers(["Walk part 1", "Wave"].map(layer).to_vec()));
    let layers = editor.state().character.edits.layers.clone();
    edit(&mut editor, 3, ClipEdit::RemoveCopy);
    assert_eq!(editor.state().character.edits.layers, layers[1..]);
    assert_eq!(title(&editor), Some("Walk"));
    assert!(editor.undo());
    assert_eq!(editor.state().character.edits.layers, layers);
    assert_eq!((title(&editor), model(&editor).clips().len()), (Some("Walk part 1"), 4), "it plays again");
}

#[test]
fn copies_are_undone_and_redone() {
    let mut editor = editor("sample:walker");
    editor.apply(Command::Seek(0.3));
    cut(&mut editor, 0, 0.25, 0.5);
    assert!(editor.undo());
    assert_eq!((title(&editor), model(&editor).clips().len()), (Some("Walk"), 3));
    assert_eq!(editor.state().character.playhead.time_secs, 0.3, "where it was");
    assert!(editor.redo());
    assert_eq!((model(&editor).titles()[3], secs(&editor, 3)), ("Walk part 1", 0.25));
    editor.apply(Command::SetClip(ClipChoice::called("Walk part 1")));
    edit(&mut editor, 3, ClipEdit::RemoveCopy);
    assert_eq!((title(&editor), model(&editor).clips().len()), (Some("Walk"), 3));
    assert_eq!(editor.state().character.edits.clips, ClipEdits::default(), "its changes are gone with it");
    // Nothing else can be removed.
    edit(&mut editor, 0, ClipEdit::RemoveCopy);
    assert_eq!(model(&editor).clips().len(), 3);
}

#[test]
fn a_copy_of_a_borrowed_clip_stays_when_its_map_changes_and_goes_with_its_motion() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let borrowed = clip(&editor);
    let before = model(&editor).clips().len();
    cut(&mut editor, borrowed, 0.25, 0.75);
    let copy = clip(&editor);
    assert_eq!((copy, secs(&editor, copy)), (before, 0.5));
    let of = |clip: usize| model(&editor).clip_at(clip).borrowed().expect("is borrowed").source_clip;
    assert_eq!(of(copy), of(borrowed), "figures and tracks are the original's");
    let pose = |editor: &Editor| format!("{:?}", model(editor).clip_at(copy).clip().channels());
    let shown = pose(&editor);
    let mut map = active_map(editor.library(), editor.state(), &motion_at(editor.library(), 0)).expect("a map");
    map.joints.pop_last();
    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: Some(Box::new(map)) });
    assert_eq!(clip(&editor), copy, "still plays");
    assert_ne!(pose(&editor), shown, "and follows its original");
    editor.remove_motion(&motion_at(editor.library(), 0));
    assert_eq!(clip(&editor), 0, "the model's own");
    assert!(editor.undo());
    assert_eq!((clip(&editor), secs(&editor, copy)), (copy, 0.5));
}

#[test]
fn a_link_has_copies_and_says_what_they_lack() {
    let mut editor = editor("sample:walker");
    cut(&mut editor, 0, 0.25, 0.5);
    let link = to_link(editor.state(), editor.library());
    assert!(link.ends_with("copy=Walk%20part%201:Walk&change=Walk%20part%201:trim:0.25:0.5"), "{link}");
    let (state, errors) = from_link(&link);
    assert_eq!((errors, to_link(&state, editor.library())), (Vec::new(), link));
    let mut again = self::editor("sample:walker");
    again.apply(Command::Replace(Box::new(state)));
    assert_eq!((title(&again), secs(&again, 3)), (Some("Walk part 1"), 0.25));

    let mut partial = |value| again.apply_partial(&serde_json::json!({ "copy": value }));
    partial(vec!["A:Wave", "B:0"]).expect("names and indices");
    let error = partial(vec!["A:Wave", "A:Walk"]).expect_err("one name for two");
    assert!(error.contains("each with its own name"), "{error}");
    partial(
        (0..=ClipEdits::MAX_COPIES)
            .map(|at| format!("{at} x:Walk"))
            .collect::<Vec<_>>()
            .iter()
            .map(|text| &**text)
            .collect(),
    )
    .expect_err("too many");
    assert_eq!(model(&again).titles()[3..], ["A", "B"]);
}

/// Names of copies in old links may be of any length, and the other keys have them, too.
#[test]
fn a_copy_with_a_long_name_is_found() {
    let name = "part of a long recording ".repeat(5);
    let mut editor = editor("sample:walker");
    let partial = serde_json::json!({ "copy": [format!("{name}:Wave")], "clip": name, "mirror": [name] });
    editor.apply_partial(&partial).expect("names of any length");
    assert_eq!(title(&editor), Some(&*name));
    assert!(model(&editor).clip_at(3).changed().is_some(), "it is mirrored");
}

/// A motion's clip, since all motions have clips of the same names.
fn clip_of(editor: &Editor, source: &str, source_clip: usize) -> Option<ClipId> {
    let motion = editor.library().motions().iter().find(|motion| motion.source == source)?;
    let id = ClipId::Borrowed(motion.id().clone(), source_clip);
    model(editor).clip(&id).map(|_| id)
}

fn is_mirrored(editor: &Editor, source: &str) -> Option<bool> {
    Some(editor.state().character.edits.clips.changes_of(&clip_of(editor, source, 0)?).mirror)
}

/// Clips of several motions are often called alike, so that edits name them by index.
#[test]
fn edits_stay_with_their_clip_whatever_becomes_of_other_motions() {
    let mut editor = editor("sample:pilot");
    for motion in ["walk.glb", "run.glb", "jump.glb"] {
        open_motion(&mut editor, motion);
    }
    let mirror = || Box::new(ClipChanges { mirror: true, ..ClipChanges::NONE });
    let run = clip_of(&editor, "run.glb", 0).expect("borrowed");
    editor.apply(Command::EditClip { clip: run.clone(), edit: ClipEdit::Change(mirror()) });
    editor.apply(Command::SetLayers(vec![LayeredClip { clip: run.clone(), layer: ClipLayer::default() }]));
    let place = model(&editor).clips().iter().position(|clip| *clip.id() == run).expect("is listed");
    cut(&mut editor, place, 0.1, 0.3);
    let of_copy = |editor: &Editor| model(editor).clips().iter().last().expect("a copy").original_id().clone();
    let check = |editor: &Editor, names: &[&str]| {
        for name in names {
            assert_eq!(is_mirrored(editor, name), Some(*name == "run.glb"), "{name} of {names:?}");
        }
        let run = clip_of(editor, "run.glb", 0).expect("borrowed");
        assert_eq!(editor.state().character.edits.layers[0].clip, run);
        assert_eq!(of_copy(editor), run);
    };
    check(&editor, &["walk.glb", "run.glb", "jump.glb"]);
    // A newer version of a motion comes last.
    open_motion(&mut editor, "walk.glb");
    check(&editor, &["walk.glb", "run.glb", "jump.glb"]);
    open_motion(&mut editor, "run.glb");
    check(&editor, &["walk.glb", "run.glb", "jump.glb"]);
    editor.remove_motion(&motion_at(editor.library(), 0));
    check(&editor, &["walk.glb", "run.glb"]);
    // Without pairs, a motion has no clips. All of the same joints share their map.
    editor.apply(Command::SetMap {
        motion: motion_at(editor.library(), 0),
        map: Some(Box::new(JointMap::with_proposed_options())),
    });
    assert_eq!(clip_of(&editor, "run.glb", 0), None);
    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: None });
    check(&editor, &["walk.glb", "run.glb"]);
    // Edits go with their motion, and come back with it.
    let run = editor.library().motions().iter().position(|motion| motion.source == "run.glb").expect("is there");
    editor.remove_motion(&motion_at(editor.library(), run));
    let Edits { clips, layers, .. } = &editor.state().character.edits;
    assert_eq!((clips, layers.len()), (&ClipEdits::default(), 0));
    assert!(editor.undo());
    check(&editor, &["walk.glb", "run.glb"]);
}

#[test]
fn undoing_a_trim_returns_to_the_range_and_the_time() {
    let mut editor = editor("sample:walker");
    editor.apply(Command::SetPlaying(false));
    let range = TimeRange { start_secs: 0.4, end_secs: 0.8 };
    editor.apply(Command::SetRange(Some(range)));
    editor.apply(Command::Seek(0.5));
    let changes = ClipChanges { trim: Some(range), ..ClipChanges::NONE };
    edit(&mut editor, 0, ClipEdit::Change(Box::new(changes)));
    let playhead = |editor: &Editor| {
        let playhead = &editor.state().character.playhead;
        (playhead.range, playhead.time_secs)
    };
    assert_eq!(playhead(&editor), (None, 0.0));
    editor.undo();
    assert_eq!(playhead(&editor), (Some(range), 0.5));
}
