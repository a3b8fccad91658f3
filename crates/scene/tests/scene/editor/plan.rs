//! Export plans: many clips in one file or a file for each, and what is refused.

use std::sync::Arc;

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys, Pose, SampleCursor, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_formats::load;
use gaitway_retarget::{ClipChanges, merged_clip};
use gaitway_scene::editor::{
    ClipFormat, Contents, Editor, Export, ExportPlan, ExportedFile, OneFileFormat, Packaging, PlannedClip, Recipient,
};
use gaitway_scene::library::{ClipId, Model, ModelClip, Motion};
use gaitway_scene::state::{ClipChoice, ClipEdit, Command};
use glam::{Quat, Vec3};

use super::{any, editor};
use crate::build_gltf::one;
use crate::data::sampled;
use crate::random::Random;

pub fn model(editor: &Editor) -> &Model {
    editor.library().active().expect("a model")
}

/// A clip with odd key times, linear and stepped, for all joints whose parent is a joint.
pub fn clip(skeleton: &Skeleton, name: &str, seed: u64) -> Clip {
    let mut random = Random(seed);
    let mut builder = ClipBuilder::new(name, skeleton);
    for joint in skeleton.joints().filter(|&joint| skeleton.parent(joint).is_some()) {
        let rest = skeleton.rest().local(joint);
        let mut times_secs = vec![0.0];
        (0..4 + random.below(4)).for_each(|_| times_secs.push(times_secs[times_secs.len() - 1] + 0.05 + random.f32()));
        let interpolation = [Interpolation::Linear, Interpolation::Step][random.below(2)];
        let mut axis = || Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5;
        let keys = times_secs.iter().map(|_| (rest.rotation * Quat::from_scaled_axis(axis())).normalize()).collect();
        builder.channel(joint, interpolation, &times_secs, Keys::Rotation(keys)).expect("a channel");
    }
    builder.build()
}

pub fn motion(source: &str, skeleton: &Skeleton, clips: Vec<Clip>) -> Motion {
    let parts = AssetParts { format: "glb", skeleton: skeleton.clone(), clips, ..AssetParts::default() };
    Motion::new(source.to_owned(), Arc::new(Asset::new(parts).expect("a motion")))
}

pub fn borrow(editor: &mut Editor, motions: Vec<Motion>) {
    let contents = Contents { motions: Some(motions), ..Contents::default() };
    editor.open(contents, None, &mut any).expect("fits");
    assert_eq!(editor.library().borrow_errors(), []);
}

/// The pilot with five clips from files of its own rig.
fn pilot_with_five() -> (Editor, Vec<Clip>) {
    let mut editor = editor("sample:pilot");
    let skeleton = model(&editor).asset.skeleton.clone();
    let clips: Vec<Clip> = (1..=5).map(|number| clip(&skeleton, &format!("Clip of file {number}"), number)).collect();
    let motions = clips.iter().enumerate();
    let motions = motions.map(|(number, clip)| motion(&format!("{number}.glb"), &skeleton, vec![clip.clone()]));
    let motions = motions.collect();
    borrow(&mut editor, motions);
    (editor, clips)
}

pub fn all_clips(editor: &Editor) -> ExportPlan {
    ExportPlan::all_clips(model(editor))
}

fn read(bytes: Vec<u8>) -> Asset {
    load(&one("written.glb", bytes)).unwrap_or_else(|error| panic!("{error}"))
}

/// The only file of a plan.
pub fn export(editor: &Editor, plan: &ExportPlan) -> ExportedFile {
    let [file] = editor.export_plan(plan).expect("is written").try_into().expect("one file");
    file
}

pub fn together(editor: &Editor, plan: &ExportPlan) -> Asset {
    read(export(editor, plan).bytes)
}

fn names(asset: &Asset) -> Vec<&str> {
    asset.clips.iter().map(Clip::name).collect()
}

/// Key times and keys, bit for bit.
fn keys(clip: &Clip) -> Vec<String> {
    let keys = clip.channels().iter().map(|channel| {
        let times_secs = &clip.timelines()[channel.timeline as usize];
        format!("{:?} {:?} {times_secs:?} {:?}", channel.joint, channel.interpolation, channel.keys)
    });
    keys.collect()
}

#[test]
fn clips_of_one_rig_are_merged_with_exactly_their_keys() {
    let (editor, clips) = pilot_with_five();
    let file = export(&editor, &all_clips(&editor));
    assert_eq!(editor.export(&Export::AllClips), Ok(file.clone()), "what the export menu writes");
    let written = read(file.bytes);
    let own: Vec<&str> = names(&model(&editor).asset);
    assert_eq!(names(&written), [own, clips.iter().map(Clip::name).collect()].concat());
    let before = model(&editor).asset.clips.iter().chain(&clips);
    for (written, before) in written.clips.iter().zip(before) {
        assert_eq!(keys(written), keys(before), "{}", before.name());
    }
}

fn posed(asset: &Asset, clip: &Clip, time_secs: f64) -> Pose {
    let mut pose = asset.skeleton.rest().clone();
    clip.sample(&asset.skeleton, time_secs as f32, &mut SampleCursor::default(), &mut pose);
    pose
}

/// Checks that each clip of a file shows the pose that the editor shows, between keys as well.
fn check_poses(editor: &mut Editor, plan: &ExportPlan, written: &Asset) {
    editor.apply(Command::SetPlaying(false));
    for PlannedClip { clip, name, .. } in &plan.clips {
        let exported = written.clips.iter().find(|clip| clip.name() == name).unwrap_or_else(|| panic!("no {name}"));
        editor.apply(Command::SetClip(ClipChoice::Clip(clip.clone())));
        for step in 0..23 {
            let time_secs = f64::from(exported.duration_secs()) * f64::from(step) / 23.0;
            editor.apply(Command::Seek(time_secs));
            let shown = sampled(model(editor), editor.state()).pose;
            for (found, expected) in posed(written, exported, time_secs).locals().zip(shown.locals()) {
                let turn = (found.rotation * expected.rotation.conjugate()).xyz().length();
                assert!(turn < 1e-4, "{name} at {time_secs}: {found:?}, not {expected:?}");
                assert!(found.translation.abs_diff_eq(expected.translation, 1e-4), "{name}: {found:?} {expected:?}");
            }
        }
    }
}

/// Own clips, one of them changed and one renamed, clips of the same rig, and one that is retargeted from another body.
#[test]
fn every_clip_plays_as_it_is_shown() {
    let (mut editor, _) = pilot_with_five();
    let walker = super::motion("walker.glb");
    borrow(&mut editor, vec![walker]);
    let changes = ClipChanges { turn_degrees: 40.0, ..ClipChanges::NONE };
    editor.apply(Command::EditClip { clip: ClipId::Own(0), edit: ClipEdit::Change(Box::new(changes)) });
    editor.apply(Command::EditClip { clip: ClipId::Own(1), edit: ClipEdit::Rename("Renamed".to_owned()) });
    let plan = all_clips(&editor);
    let written = together(&editor, &plan);
    assert_eq!(written.clips.len(), model(&editor).clips().len(), "the changed clip replaces its original");
    check_poses(&mut editor, &plan, &written);
}

#[test]
fn only_the_chosen_clips_are_written_under_the_names_of_the_plan() {
    let (mut editor, clips) = pilot_with_five();
    let mut plan = all_clips(&editor);
    plan.clips.retain(|planned| planned.clip == ClipId::Own(1) || planned.name == clips[3].name());
    plan.clips.iter_mut().for_each(|planned| planned.name.insert_str(0, "My "));
    let written = together(&editor, &plan);
    assert_eq!(names(&written), plan.clips.iter().map(|planned| planned.name.as_str()).collect::<Vec<_>>());
    check_poses(&mut editor, &plan, &written);
    let whole = export(&editor, &all_clips(&editor)).bytes.len();
    let part = export(&editor, &plan).bytes.len();
    assert!(part < whole, "the others take their keys with them: {part} of {whole} bytes");
}

#[test]
fn each_clip_can_be_a_file_of_its_own() {
    let (mut editor, _) = pilot_with_five();
    for format in ClipFormat::ALL {
        let plan = ExportPlan { packaging: Packaging::FilePerClip(format), ..all_clips(&editor) };
        let files = editor.export_plan(&plan).expect("are written");
        let expected: Vec<String> =
            plan.clips.iter().map(|planned| format!("{}.{}", planned.name, format.extension())).collect();
        assert_eq!(files.iter().map(|file| file.name.clone()).collect::<Vec<_>>(), expected);
        if format == ClipFormat::Glb {
            for (file, planned) in files.into_iter().zip(&plan.clips) {
                let alone = ExportPlan { clips: vec![planned.clone()], ..plan.clone() };
                check_poses(&mut editor, &alone, &read(file.bytes));
            }
        }
    }
}

/// Checks that a plan is refused with this text.
#[track_caller]
pub fn check_refused(editor: &Editor, plan: &ExportPlan, says: &str) {
    let error = editor.export_plan(plan).expect_err("is refused");
    assert!(error.contains(says), "{error}");
}

#[test]
fn bad_plans_are_refused_in_words() {
    let (editor, _) = pilot_with_five();
    let plan = all_clips(&editor);
    let with = |change: &dyn Fn(&mut ExportPlan)| {
        let mut plan = plan.clone();
        change(&mut plan);
        plan
    };
    check_refused(&editor, &with(&|plan| plan.clips.clear()), "no clip is chosen");
    let first = plan.clips[0].name.clone();
    let collides = format!("would both be called “{first}”; rename one of them");
    check_refused(&editor, &with(&|plan| plan.clips[4].name.clone_from(&first)), &collides);
    check_refused(&editor, &with(&|plan| plan.clips[2].name = "  ".to_owned()), "has no name");
    check_refused(&editor, &with(&|plan| plan.clips.push(plan.clips[0].clone())), "is chosen twice");
    check_refused(&editor, &with(&|plan| plan.clips[0].clip = ClipId::Own(99)), "no such clip");
    for recipient in [Recipient::Unity, Recipient::Unreal] {
        check_refused(&editor, &with(&|plan| plan.recipient = recipient), "imports FBX; choose an .fbx");
    }
    check_refused(&editor, &with(&|plan| plan.recipient = Recipient::Vrm), "VRM avatar yet");
    for recipient in [Recipient::Godot, Recipient::Blender, Recipient::Web, Recipient::AsIs] {
        assert!(editor.export_plan(&with(&|plan| plan.recipient = recipient)).is_ok());
    }
    for recipient in [Recipient::Unity, Recipient::Unreal, Recipient::Blender, Recipient::AsIs] {
        let fbx = with(&|plan| {
            plan.recipient = recipient;
            plan.packaging = Packaging::OneFile(OneFileFormat::Fbx);
        });
        let files = editor.export_plan(&fbx).expect("a file");
        assert!(files[0].name.ends_with(".fbx") && files[0].bytes.starts_with(b"Kaydara FBX Binary"), "{recipient:?}");
    }
    // As names of files, these are one.
    let files = with(&|plan| {
        plan.packaging = Packaging::FilePerClip(ClipFormat::Bvh);
        plan.clips[0].name = "run/fast".to_owned();
        plan.clips[1].name = "RUN-fast".to_owned();
    });
    check_refused(&editor, &files, "would both be called “RUN-fast”");
    let one_file = ExportPlan { packaging: Packaging::OneFile(OneFileFormat::Glb), ..files };
    assert!(names(&together(&editor, &one_file)).contains(&"RUN-fast"));
}

#[test]
fn a_body_is_needed_for_vrm_animations() {
    let snake = crate::skeletons::chain(["a", "b", "c"], Vec3::Y);
    let asset = crate::skeletons::asset(snake);
    let skeleton = asset.skeleton.clone();
    let mut stage = Editor::default();
    let parts =
        AssetParts { skeleton: skeleton.clone(), clips: vec![clip(&skeleton, "Crawl", 1)], ..AssetParts::default() };
    let model = Model::new("snake.glb".to_owned(), Asset::new(parts).expect("a model"), Vec::new());
    let contents = Contents { models: vec![model.into()], ..Contents::default() };
    stage.open(contents, None, &mut any).expect("fits");
    let plan = ExportPlan { packaging: Packaging::FilePerClip(ClipFormat::Vrma), ..all_clips(&stage) };
    check_refused(&stage, &plan, "a .vrma holds a human body");
}

#[test]
fn what_a_format_cannot_hold_is_said_by_name() {
    let mut editor = editor("sample:pilot");
    let skeleton = model(&editor).asset.skeleton.clone();
    let joint = skeleton.joints().last().expect("a joint");
    let grown = |name: &str| {
        let mut builder = ClipBuilder::new(name, &skeleton);
        let keys = Keys::Scale(vec![Vec3::ONE, Vec3::splat(2.0)]);
        builder.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).expect("a channel");
        builder.build()
    };
    borrow(&mut editor, vec![motion("grow.glb", &skeleton, vec![grown("Grow"), grown("Swell")])]);
    let plan = all_clips(&editor);
    let said = |packaging| editor.plan_losses(&ExportPlan { packaging, ..plan.clone() });
    assert_eq!(said(Packaging::OneFile(OneFileFormat::Glb)), Vec::<String>::new());
    let of_bvh = said(Packaging::FilePerClip(ClipFormat::Bvh));
    let is_said = |text: &String| text.starts_with("scale of “") && text.ends_with("“Grow”, “Swell”");
    assert!(of_bvh.iter().any(is_said), "{of_bvh:?}");
}

/// Equal names are not enough: the rests have to agree.
#[test]
fn another_rest_is_retargeted() {
    let editor = editor("sample:pilot");
    let skeleton = &model(&editor).asset.skeleton;
    let clip = clip(skeleton, "Clip", 3);
    assert!(merged_clip(skeleton, skeleton, &clip, &clip).is_some());
    let joint = clip.channels()[2].joint;
    let with = |change: &dyn Fn(&mut Transform)| {
        let mut rest = skeleton.rest().clone();
        let mut local = rest.local(joint);
        change(&mut local);
        rest.set_local(joint, local);
        skeleton.with_rest(&rest)
    };
    let others = [
        with(&|local| local.rotation *= Quat::from_rotation_x(0.01)),
        with(&|local| local.translation *= 1.1),
        with(&|local| local.scale *= 1.01),
        skeleton.with_names([(skeleton.source_index(joint), "other")].into_iter()),
    ];
    for other in others {
        assert!(merged_clip(skeleton, &other, &clip, &clip).is_none());
    }
    // A clip that is shown otherwise than its file has it, as with other options, stays what it is.
    let other = self::clip(skeleton, "Clip", 4);
    assert!(merged_clip(skeleton, skeleton, &clip, &other).is_none());
    assert_eq!(model(&editor).clips().iter().filter(|clip| ModelClip::is_derived(clip)).count(), 0);
}
