//! Copies of clips, to cut several out of one.

use gaitway::anim::{Clip, TimeRange};
use gaitway::editor::{ClipFormat, Editor, Export};
use gaitway::formats::{FileSet, load};
use gaitway::library::{BorrowedClip, Model};
use gaitway::retarget::{ClipChanges, ClipLayer, JointMap};
use gaitway::state::{
    ClipChoice, Command, Edits, active_clip, active_map, changes_of, clip_of_layer, from_link, to_link,
};

use super::{editor, open_motion, title};

fn model(editor: &Editor) -> &Model {
    editor.library().active().expect("a model")
}

fn clip(editor: &Editor) -> usize {
    active_clip(model(editor), editor.state()).expect("a clip plays")
}

fn secs(editor: &Editor, clip: usize) -> f32 {
    model(editor).clip(clip).expect("a clip").duration_secs()
}

/// Copies a part of a clip.
fn cut(editor: &mut Editor, clip: usize, start_secs: f64, end_secs: f64) {
    let changes = ClipChanges { trim: Some(TimeRange { start_secs, end_secs }), ..ClipChanges::NONE };
    editor.apply(Command::CopyClip { clip, changes: Box::new(changes) });
}

#[test]
fn a_saved_clip_says_that_it_is_not_cut_to_the_range() {
    let mut editor = editor("sample:walker");
    editor.apply(Command::SetRange(Some(TimeRange { start_secs: 0.2, end_secs: 0.6 })));
    let remark = editor.export(Export::Clip { clip: 0, format: ClipFormat::Bvh }).expect("has keys").remark;
    assert_eq!(remark.as_deref(), Some("The file has the whole clip; “Trim to range” cuts it."));
}

#[test]
fn several_clips_are_cut_out_of_one() {
    let mut editor = editor("sample:walker");
    let (titles, whole) = (model(&editor).clip_titles().to_vec(), secs(&editor, 0));
    cut(&mut editor, 0, 0.25, 0.5);
    assert_eq!((title(&editor), clip(&editor)), (Some("Walk part 1"), 3));
    // A copy of a copy is one of the original.
    cut(&mut editor, 3, 0.25, 1.0);
    assert_eq!((title(&editor), clip(&editor)), (Some("Walk part 2"), 4));
    assert_eq!([0, 3, 4].map(|clip| secs(&editor, clip)), [whole, 0.25, 0.75]);
    assert_eq!(model(&editor).clip_titles()[..3], titles);
    assert_eq!(model(&editor).listed_clips().collect::<Vec<_>>(), [0, 3, 4, 1, 2]);
    assert!(!model(&editor).is_derived(0) && model(&editor).is_derived(3), "the file has the original");

    // The file is written with the copy that plays, under its name.
    let mut files = FileSet::default();
    files.insert("walker.glb", editor.export(Export::Model { clip: 4 }).expect("is written").bytes);
    let written = load(&files).expect("a GLB");
    let last = written.clips.last().expect("a clip");
    assert_eq!((last.name(), last.duration_secs()), ("Walk part 2", 0.75));
}

#[test]
fn each_part_of_a_borrowed_clip_has_a_file_name_of_its_own() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let borrowed = clip(&editor);
    let name = |editor: &Editor, clip: usize| editor.export(Export::Model { clip }).expect("is written").name;
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
    let layers = ["Walk part 1", "Wave"].map(|clip| ClipLayer { clip: clip.to_owned(), ..ClipLayer::default() });
    editor.apply(Command::SetLayers(layers.to_vec()));
    editor.apply(Command::RemoveCopy(3));
    assert_eq!(editor.state().edits.layers, layers[1..]);
    assert_eq!(title(&editor), Some("Walk"));
    assert!(editor.undo());
    assert_eq!(editor.state().edits.layers, layers);
    assert_eq!((title(&editor), model(&editor).clip_count()), (Some("Walk part 1"), 4), "it plays again");
}

#[test]
fn copies_are_undone_and_redone() {
    let mut editor = editor("sample:walker");
    editor.apply(Command::Seek(0.3));
    cut(&mut editor, 0, 0.25, 0.5);
    assert!(editor.undo());
    assert_eq!((title(&editor), model(&editor).clip_count()), (Some("Walk"), 3));
    assert_eq!(editor.state().playhead.time_secs, 0.3, "where it was");
    assert!(editor.redo());
    assert_eq!((model(&editor).clip_titles()[3].as_str(), secs(&editor, 3)), ("Walk part 1", 0.25));
    editor.apply(Command::SetClip(ClipChoice::Named("Walk part 1".to_owned())));
    editor.apply(Command::RemoveCopy(3));
    assert_eq!((title(&editor), model(&editor).clip_count()), (Some("Walk"), 3));
    assert!(editor.state().edits.clips.is_empty(), "its changes are gone with it");
    // Nothing else can be removed.
    editor.apply(Command::RemoveCopy(0));
    assert_eq!(model(&editor).clip_count(), 3);
}

#[test]
fn a_copy_of_a_borrowed_clip_stays_when_its_map_changes_and_goes_with_its_motion() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let borrowed = clip(&editor);
    let before = model(&editor).clip_count();
    cut(&mut editor, borrowed, 0.25, 0.75);
    let copy = clip(&editor);
    assert_eq!((copy, secs(&editor, copy)), (before, 0.5));
    let of = |clip: usize| model(&editor).borrowed(clip).expect("is borrowed").source_clip;
    assert_eq!(of(copy), of(borrowed), "figures and tracks are the original's");
    let pose = |editor: &Editor| format!("{:?}", model(editor).clip(copy).map(Clip::channels));
    let shown = pose(&editor);
    let mut map = active_map(editor.library(), editor.state(), 0).expect("a map");
    map.joints.pop_last();
    editor.apply(Command::SetMap { motion: 0, map: Some(Box::new(map)) });
    assert_eq!(clip(&editor), copy, "still plays");
    assert_ne!(pose(&editor), shown, "and follows its original");
    editor.remove_motion(0);
    assert_eq!(clip(&editor), 0, "the model's own");
    assert!(editor.undo());
    assert_eq!((clip(&editor), secs(&editor, copy)), (copy, 0.5));
}

#[test]
fn a_link_has_copies_and_says_what_they_lack() {
    let mut editor = editor("sample:walker");
    cut(&mut editor, 0, 0.25, 0.5);
    let link = to_link(editor.state());
    assert!(link.ends_with("copy=Walk%20part%201:Walk&change=Walk%20part%201:trim:0.25:0.5"), "{link}");
    let (state, errors) = from_link(&link);
    assert_eq!((errors, &state), (Vec::new(), editor.state()));
    let mut again = self::editor("sample:walker");
    again.apply(Command::Replace(Box::new(state)));
    assert_eq!((title(&again), secs(&again, 3)), (Some("Walk part 1"), 0.25));

    let mut partial = |value| again.apply_partial(&serde_json::json!({ "copy": value }));
    partial(vec!["A:Wave", "B:0"]).expect("names and indices");
    let error = partial(vec!["A:Wave", "A:Walk"]).expect_err("one name for two");
    assert!(error.contains("each with its own name"), "{error}");
    partial(
        (0..=Edits::MAX_COPIES)
            .map(|at| format!("{at} x:Walk"))
            .collect::<Vec<_>>()
            .iter()
            .map(|text| &**text)
            .collect(),
    )
    .expect_err("too many");
    assert_eq!(model(&again).clip_titles()[3..], ["A", "B"]);
}

/// The index of a motion's clip among all, since all motions have clips of the same names.
fn clip_of(editor: &Editor, source: &str, source_clip: usize) -> Option<usize> {
    let motion = editor.library().motions().iter().position(|motion| motion.source == source)?;
    let is_wanted = |borrowed: &BorrowedClip| borrowed.motion == motion && borrowed.source_clip == source_clip;
    model(editor).borrowed_clips().find(|(_, borrowed)| is_wanted(borrowed)).map(|(clip, _)| clip)
}

fn is_mirrored(editor: &Editor, source: &str) -> Option<bool> {
    Some(changes_of(model(editor), editor.state(), clip_of(editor, source, 0)?).mirror)
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
    editor.apply(Command::ChangeClip { clip: run, changes: mirror() });
    editor.apply(Command::SetLayers(vec![ClipLayer { clip: run.to_string(), ..ClipLayer::default() }]));
    cut(&mut editor, run, 0.1, 0.3);
    let of_copy = |editor: &Editor| model(editor).original(model(editor).clip_count() - 1);
    let check = |editor: &Editor, names: &[&str]| {
        for name in names {
            assert_eq!(is_mirrored(editor, name), Some(*name == "run.glb"), "{name} of {names:?}");
        }
        let run = clip_of(editor, "run.glb", 0).expect("borrowed");
        assert_eq!(clip_of_layer(model(editor), &editor.state().edits.layers[0]), Some(run));
        assert_eq!(of_copy(editor), run);
    };
    check(&editor, &["walk.glb", "run.glb", "jump.glb"]);
    // A newer version of a motion comes last.
    open_motion(&mut editor, "walk.glb");
    check(&editor, &["walk.glb", "run.glb", "jump.glb"]);
    open_motion(&mut editor, "run.glb");
    check(&editor, &["walk.glb", "run.glb", "jump.glb"]);
    editor.remove_motion(0);
    check(&editor, &["walk.glb", "run.glb"]);
    // Without pairs, a motion has no clips. All of the same joints share their map.
    editor.apply(Command::SetMap { motion: 0, map: Some(Box::new(JointMap::with_proposed_options())) });
    assert_eq!(clip_of(&editor, "run.glb", 0), None);
    editor.apply(Command::SetMap { motion: 0, map: None });
    check(&editor, &["walk.glb", "run.glb"]);
    // Edits go with their motion, and come back with it.
    let run = editor.library().motions().iter().position(|motion| motion.source == "run.glb").expect("is there");
    editor.remove_motion(run);
    let Edits { clips, copies, layers, .. } = &editor.state().edits;
    assert_eq!((clips.len(), copies.len(), layers.len()), (0, 0, 0));
    assert!(editor.undo());
    check(&editor, &["walk.glb", "run.glb"]);
}
