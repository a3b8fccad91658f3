//! The law of the automatic camera: whatever plays is in the picture, at every time of every clip.

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::asset::SceneJoints;
use gaitway_retarget::{ClipChanges, Feet, RootOptions, RootPart};
use gaitway_scene::editor::{Contents, Editor};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::ClipId;
use gaitway_scene::state::{CameraChoice, ClipChoice, ClipEdit, Command, active_clip};
use glam::Vec4Swizzles;

use super::camera::runner_from;
use super::{any, contents, id_of};
use crate::data_folder::data_folder;
use crate::model_files::models_under;
use crate::random::Random;

/// Returns how far the body extends from the centre of the viewport at a time in the active clip; 1 is the edge.
fn reach(editor: &Editor, time_secs: f64) -> f32 {
    let mut state = editor.state().clone();
    state.character.playhead.time_secs = time_secs;
    let mut frame = Frame::default();
    evaluate(editor.library(), &state, 1.6, &mut frame);
    let (character, model) = (&frame.characters[0], editor.library().active().expect("a model"));
    let visible = SceneJoints::new(&model.asset, model.scene(state.character.sources.scene));
    let bounds = model.pose_bounds(&character.world_from_joint, &character.morph_weights, &visible);
    let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
    let reach = bounds.corners().map(|corner| {
        let clip = projection_from_world * corner.extend(1.0);
        if clip.w > 0.0 { (clip.xy() / clip.w).abs().max_element() } else { f32::INFINITY }
    });
    reach.into_iter().fold(0.0, f32::max)
}

/// Checks the law at some times within the range that plays.
fn check(editor: &Editor, what: &str) {
    let model = editor.library().active().expect("a model");
    let clip = active_clip(model, editor.state());
    let whole = TimeRange { start_secs: 0.0, end_secs: clip.map_or(0.0, |clip| clip.duration_secs()) };
    let range = editor.state().character.playhead.range.unwrap_or(whole);
    for part in [0.0, 0.13, 0.35, 0.5, 0.77, 1.0] {
        let time_secs = range.start_secs + part * range.length_secs();
        let reach = reach(editor, time_secs);
        let name = clip.map_or("the rest pose", |clip| clip.title());
        assert!(reach <= 1.0, "{what}: {name} of {} at {time_secs} s: {reach}", model.source);
    }
}

fn random_command(editor: &Editor, random: &mut Random) -> Command {
    let model = editor.library().active().expect("a model");
    let clips: Vec<ClipId> = model.clips().iter().map(|clip| clip.id().clone()).collect();
    let active = active_clip(model, editor.state());
    let duration_secs = active.map_or(0.0, |clip| clip.duration_secs());
    let mut range = || {
        let [a, b] = [(); 2].map(|()| duration_secs * random.f64());
        TimeRange { start_secs: a.min(b), end_secs: a.max(b) }
    };
    let (range, trim) = (range(), range());
    match random.below(9) {
        0 => Command::SetRange(Some(range)),
        1 => Command::SetRange(None),
        2 => Command::Seek(duration_secs * random.f64()),
        3 => Command::SetLoopMode([LoopMode::Once, LoopMode::Loop, LoopMode::PingPong][random.below(3)]),
        4 => {
            let part = [RootPart::Keep, RootPart::InPlace, RootPart::Freeze][random.below(3)];
            Command::SetRoot(Some(RootOptions { horizontal: part, ..RootOptions::default() }))
        }
        5 => Command::SetFeet([None, Some(Feet::Plant)][random.below(2)]),
        6 if let Some(clip) = active => {
            let offset = [20.0 * random.f64() - 10.0, 20.0 * random.f64() - 10.0];
            let changes = [
                ClipChanges { trim: Some(trim), ..ClipChanges::default() },
                ClipChanges { offset, ..ClipChanges::default() },
                ClipChanges { turn_degrees: 120.0, reverse: true, ..ClipChanges::default() },
            ];
            let changes = Box::new(changes[random.below(3)].clone());
            let edit = if random.below(2) == 0 { ClipEdit::Change(changes) } else { ClipEdit::Copy(changes) };
            Command::EditClip { clip: clip.id().clone(), edit }
        }
        7 => Command::SetClip(ClipChoice::RestPose),
        _ if clips.is_empty() => Command::SetClip(ClipChoice::First),
        _ => Command::SetClip(ClipChoice::Clip(clips[random.below(clips.len())].clone())),
    }
}

#[test]
fn whatever_is_done_what_plays_is_in_view() {
    for seed in 0..12 {
        let mut random = Random(seed);
        let mut editor = super::editor("sample:dwarf");
        editor.set_aspect(1.6);
        let far = Contents { is_by_hand: true, ..runner_from(30.0, 9.0) };
        editor.open(far, None, &mut any).expect("fits");
        let near = id_of(&editor, "sample:dwarf");
        if random.below(2) == 0 {
            editor.activate(near, &mut any).expect("fits");
        }
        let mut done = Vec::new();
        for _ in 0..30 {
            let step = match random.below(8) {
                0 => {
                    editor.undo();
                    "undo".to_owned()
                }
                1 => {
                    let file = ["sample:walk", "sample:mannequin_run"][random.below(2)];
                    let contents = Contents { is_by_hand: true, ..contents(&[file]) };
                    // Some fit no skeleton.
                    drop(editor.open(contents, None, &mut any));
                    format!("open {file}")
                }
                2 => {
                    let models = editor.library().models();
                    let id = models[random.below(models.len())].id;
                    editor.activate(id, &mut any).expect("fits");
                    "activate".to_owned()
                }
                _ => {
                    let command = random_command(&editor, &mut random);
                    let step = format!("{command:?}");
                    editor.apply(command);
                    editor.end_gesture();
                    step
                }
            };
            done.push(step);
            check(&editor, &format!("seed {seed}: {done:#?}"));
        }
    }
}

/// Model files with clips of their own; what is opened beside them is tried above.
#[test]
fn every_clip_of_real_files_is_in_view() {
    let Some(folder) = data_folder() else { return };
    let mut files = Vec::new();
    models_under(&folder, &["glb", "fbx", "bvh"], &mut files);
    let mut clips = 0;
    for file in files {
        let mut editor = Editor::default();
        editor.set_aspect(1.6);
        let Some(contents) = crate::opened::try_contents(&[file.to_str().expect("a plain path")]) else { continue };
        if editor.open(Contents { is_by_hand: true, ..contents }, None, &mut any).is_err() {
            continue;
        }
        let ids: Vec<ClipId> =
            editor.library().active().expect("a model").clips().iter().map(|clip| clip.id().clone()).collect();
        for id in ids {
            editor.apply(Command::SetClip(ClipChoice::Clip(id)));
            assert_eq!(editor.state().camera, CameraChoice::Auto);
            check(&editor, &file.display().to_string());
            clips += 1;
        }
    }
    assert!(clips > 200, "{clips}");
}
