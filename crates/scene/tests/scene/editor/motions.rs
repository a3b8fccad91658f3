//! Motions and the clips they lend, refused ones included.

use std::sync::Arc;

use gaitway_character::anim::Clip;
use gaitway_character::asset::{Asset, AssetParts, Warning};
use gaitway_formats::{FileSet, load};
use gaitway_scene::editor::{ClipFormat, Contents, Editor, Event, Export};
use gaitway_scene::library::{ClipId, Library, Model, Motion};
use gaitway_scene::state::{ViewerState, active_clip, from_link, to_link};
use glam::Vec3;

use super::{active, any, contents, editor, id_of, motion, motions, notices, open, open_motion};
use crate::by_place::motion_at;
use crate::data::moving_box;
use crate::walk_bvh::BVH;

/// The model has clips of its own as well.
#[test]
fn a_link_that_names_no_clip_plays_its_motion_from_version_2_on() {
    let opened = |link: &str, motion_names: &[&str]| {
        let motions = motion_names.iter().map(|name| motion(name)).collect();
        let mut editor = Editor::default();
        let contents = Contents { motions: Some(motions), ..contents(&["sample:walker"]) };
        editor.open(contents, Some(from_link(link).0), &mut any).expect("fits");
        editor
    };
    let playing = |editor: &Editor| {
        let clip = active_clip(editor.library().active().expect("a model"), editor.state())?.id();
        let lender = clip.motion().and_then(|motion| editor.library().motion(motion));
        Some(lender.map_or_else(|| format!("{clip:?}"), |lender| lender.source.clone()))
    };
    let check = |link: &str, motions: &[&str], expected: Option<&str>| {
        let editor = opened(link, motions);
        assert_eq!(playing(&editor).as_deref(), expected, "{link}");
        // Written again, it means the same.
        let again = to_link(editor.state(), editor.library());
        assert!(again.starts_with("v=2&"), "{again}");
        assert_eq!(playing(&opened(&again, motions)).as_deref(), expected, "{link} → {again}");
        again
    };
    let named = "model=sample:walker&motion=walk.bvh";
    let two = "model=sample:walker&motion=walk.bvh&motion=dance.bvh";
    assert!(!check(&format!("v=2&{named}"), &["walk.bvh"], Some("walk.bvh")).contains("clip="));
    check(&format!("v=2&{two}"), &["walk.bvh", "dance.bvh"], Some("walk.bvh"));
    check(&format!("v=2&{two}"), &["dance.bvh"], Some("dance.bvh"));
    check(&format!("v=2&{named}&clip="), &["walk.bvh"], None);
    // Its file is not there yet.
    check(&format!("v=2&{named}"), &[], Some("Own(0)"));
    check("v=2&model=sample:walker", &[], Some("Own(0)"));
    check(&format!("v=1&{named}"), &["walk.bvh"], Some("Own(0)"));
    check(named, &["walk.bvh"], Some("Own(0)"));
    // Of the model's own archive.
    check("v=2&model=sample:walker", &["sample:walker"], Some("Own(0)"));
    // A motion that an earlier model has borrowed doesn't take the place of the next one's own clips.
    let mut editor = opened("v=2&model=sample:walker&motion=walk.bvh&clip=0", &["walk.bvh"]);
    open(&mut editor, "sample:pilot");
    assert_eq!((playing(&editor).as_deref(), editor.library().motions().len()), (Some("Own(0)"), 1));
    assert!(to_link(editor.state(), editor.library()).contains("&clip="));
}

#[test]
fn motions_without_a_joint_in_common_are_refused_until_the_user_maps_them() {
    let mut editor = editor("sample:creature");
    let before = editor.state().clone();
    let error = editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    assert!(error.contains("no joint in common with Fox"), "{error}");
    let refused = Event::MotionsRefused { lacks_skeleton: false };
    assert_eq!((editor.take_events().last(), editor.state()), (Some(&refused), &before));
    editor.map_refused_manually();
    assert_eq!(editor.take_events(), [Event::MapStarted], "an empty map is not a problem");
    assert_eq!(editor.library().motions().len(), 1);
    editor.undo();
    assert!(editor.library().motions().is_empty());
}

#[test]
fn a_model_without_a_skeleton_is_told_what_it_lacks() {
    let moving = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X]);
    let asset = moving.active().expect("a box").asset.clone();
    drop(moving);
    let parts = AssetParts { clips: Vec::new(), ..Arc::into_inner(asset).expect("of one model").into_parts() };
    let mut library = Library::default();
    library.add(Model::new("chair.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new()));
    let mut editor = Editor::new(library, ViewerState::default());
    let error = editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    assert!(error.contains("chair.glb has no skeleton that a motion could move; bind its mesh to one"), "{error}");
    assert_eq!(editor.take_events().last(), Some(&Event::MotionsRefused { lacks_skeleton: true }));
}

/// A walk of two frames whose file announces three, and one that has more than it announces.
#[test]
fn a_motion_that_was_cut_short_says_so() {
    let walk = |name: &str, announced: &str| {
        let mut files = FileSet::default();
        files.insert(name, BVH.replace("Frames: 2", announced).into_bytes());
        Motion::new(name.to_owned(), Arc::new(load(&files).expect("a motion")))
    };
    for (announced, told) in [
        ("Frames: 3", Some("walk.bvh: line 61: 3 frames are announced, 2 are there; those are used")),
        ("Frames: 1", None),
        ("Frames: 2", None),
    ] {
        let mut editor = editor("sample:walker");
        let contents = Contents { motions: Some(vec![walk("walk.bvh", announced)]), ..Contents::default() };
        editor.open(contents, None, &mut any).expect("fits");
        let problems = editor.take_events().into_iter().find_map(|event| match event {
            Event::Problem(problem) => Some(problem),
            _ => None,
        });
        assert_eq!(problems.as_deref(), told);
        let model = editor.library().active().expect("a model");
        assert_eq!(model.clips().borrowed().count(), 1, "it is borrowed all the same");
    }
}

/// The pilot without its clips as a motion of this name.
fn still(name: &str) -> Motion {
    let pilot = editor("sample:pilot");
    let asset = pilot.library().active().expect("a model").asset.clone();
    drop(pilot);
    let parts = AssetParts { clips: Vec::new(), ..Arc::into_inner(asset).expect("of one model").into_parts() };
    Motion::new(name.to_owned(), Arc::new(Asset::new(parts).expect("indices in range")))
}

#[test]
fn a_file_without_animation_is_not_offered_to_be_mapped() {
    let mut editor = editor("sample:pilot");
    let contents = Contents { motions: Some(vec![still("duck.glb")]), ..Contents::default() };
    let error = editor.open(contents, None, &mut any).expect_err("has nothing");
    assert_eq!(error, "duck.glb: it has no animation, so there is nothing to borrow");
    assert_eq!(editor.take_events(), []);
}

/// Every link to the view would ask for them.
#[test]
fn of_several_motions_those_without_animation_are_not_kept() {
    let moving = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X]);
    let cube = Motion::new("cube.glb".to_owned(), moving.active().expect("a box").asset.clone());
    for with in [Contents::default(), contents(&["sample:dwarf"])] {
        let mut editor = editor("sample:pilot");
        let motions = Some(vec![still("duck.glb"), motion("dance.glb"), cube.clone()]);
        editor.open(Contents { motions, ..with }, None, &mut any).expect("one fits");
        assert_eq!(self::motions(&editor), ["dance.glb", "cube.glb"], "the cube can be mapped by hand");
        assert_eq!(editor.state().character.sources.motion, ["dance.glb", "cube.glb"]);
        let events = editor.take_events();
        let notices = notices(&events);
        assert!(notices.iter().any(|notice| notice.contains("clips from dance.glb.")), "{notices:?}");
        let duck = Event::Problem("duck.glb: it has no animation, so there is nothing to borrow".to_owned());
        assert!(events.contains(&duck), "{events:?}");
    }
}

#[test]
fn an_exported_clip_of_mixamo_is_named_like_its_file() {
    let source = editor("sample:walker");
    let asset = source.library().active().expect("a model").asset.clone();
    drop(source);
    let mut parts = Arc::into_inner(asset).expect("of one model").into_parts();
    parts.clips.truncate(1);
    parts.clips = parts.clips.into_iter().map(|clip| clip.with_name("mixamo.com".to_owned())).collect();
    let motion = Motion::new("Samba.fbx".to_owned(), Arc::new(Asset::new(parts).expect("indices in range")));
    let mut editor = editor("sample:walker");
    let contents = Contents { motions: Some(vec![motion]), ..Contents::default() };
    editor.open(contents, None, &mut any).expect("fits");
    let clip = active_clip(editor.library().active().expect("a model"), editor.state()).expect("plays").id().clone();
    for what in [Export::Clip { clip: clip.clone(), format: ClipFormat::Glb }, Export::Model { clip }] {
        let mut files = FileSet::default();
        files.insert("exported.glb", editor.export(&what).expect("is written").bytes);
        let written = load(&files).expect("a GLB");
        assert_eq!(written.clips.last().map(Clip::name), Some("Samba"));
    }
}

#[test]
fn a_model_with_motions_keeps_the_loaded_ones() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let mut both = contents(&["sample:walker"]);
    both.motions = Some(vec![motion("other.glb")]);
    editor.open(both, None, &mut any).expect("fits");
    assert_eq!(motions(&editor), ["dance.glb", "other.glb"]);
    let model = editor.library().active().expect("a model");
    let playing = active_clip(model, editor.state()).expect("a clip plays").id().clone();
    assert_eq!(playing, ClipId::Borrowed(motion_at(editor.library(), 1), 0), "the first new clip");
    assert_eq!(notices(&editor.take_events()), ["Opened Walker. Added 3 clips from other.glb."]);
    // Motions that don't fit are named.
    let mut both = contents(&["sample:morphs"]);
    both.motions = Some(vec![motion("third.glb")]);
    editor.open(both, None, &mut any).expect("the model is fine");
    let events = editor.take_events();
    assert_eq!(motions(&editor), ["third.glb"], "stays to be mapped by hand");
    let [text] = notices(&events)[..] else { panic!("{events:?}") };
    assert!(text.ends_with("Removed motions dance.glb, other.glb: they don't fit this model."), "{text}");
    assert!(events.iter().any(|event| matches!(event, Event::Problem(text) if text.starts_with("third.glb: "))));
}

#[test]
fn a_new_model_that_plays_a_borrowed_motion_says_so() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "folder/dance.glb");
    let own = "Opened Walker. It plays the motion borrowed from dance.glb; its own clips are in the clip list.";
    assert_eq!(notices(&open(&mut editor, "sample:walker")), [own]);
    let bare = Contents {
        models: vec![Model::new("bare.glb".to_owned(), without_clips("sample:pilot"), Vec::new()).into()],
        ..Contents::default()
    };
    editor.open(bare, None, &mut any).expect("fits");
    assert_eq!(notices(&editor.take_events()), ["Opened bare.glb. It plays the motion borrowed from dance.glb."]);
    // So does one of several that is shown for the first time.
    let mut several = contents(&["sample:walker", "sample:mannequin"]);
    several.motions = None;
    editor.open(several, None, &mut any).expect("fits");
    editor.take_events();
    editor.activate(id_of(&editor, "sample:mannequin"), &mut any).expect("fits");
    let events = editor.take_events();
    let [text] = notices(&events)[..] else { panic!("{events:?}") };
    assert!(text.starts_with("Mannequin plays the motion borrowed from dance.glb"), "{text}");
}

/// Returns the asset of a sample without its clips.
fn without_clips(sample: &str) -> Asset {
    let opened = contents(&[sample]).models.remove(0);
    let asset = Arc::into_inner(opened.model.asset).expect("of one model");
    Asset::new(AssetParts { clips: Vec::new(), ..asset.into_parts() }).expect("indices in range")
}

#[test]
fn an_open_model_lends_its_clips() {
    let mut editor = editor("sample:pilot");
    open(&mut editor, "sample:mannequin");
    let pilot = id_of(&editor, "sample:pilot");
    editor.borrow_from(pilot, &mut any).expect("both are people");
    let events = editor.take_events();
    assert!(events.contains(&Event::MotionsAdded), "{events:?}");
    assert_eq!((active(&editor), motions(&editor)), ("sample:mannequin", vec!["sample:pilot"]));
    assert_eq!(editor.state().character.sources.motion, ["sample:pilot"]);
    assert_eq!(editor.library().active().expect("a model").clips().borrowed().count(), 6);
    while editor.can_undo() && !motions(&editor).is_empty() {
        editor.undo();
    }
    assert_eq!(active(&editor), "sample:mannequin");
}

/// Which rate or axis was assumed of an array, for example: a motion's warnings are in no tab.
#[test]
fn what_was_assumed_about_a_motion_is_said_when_it_is_borrowed() {
    let mut editor = editor("sample:walker");
    let walker = motion("walker.glb").asset;
    let (skeleton, clips) = (walker.skeleton.clone(), walker.clips.clone());
    let parts = AssetParts { format: "npz", skeleton, clips, ..AssetParts::default() };
    let mut asset = Asset::new(parts).expect("a motion");
    let problem = "The file has no frame rate".to_owned();
    asset.warnings.push(Warning::Other { code: "conversion", place: String::new(), problem });
    let walk = Motion::new("walk.npz".to_owned(), Arc::new(asset));
    let contents = Contents { motions: Some(vec![walk]), ..Contents::default() };
    editor.open(contents, None, &mut any).expect("fits");
    let expected = Event::Problem("walk.npz: The file has no frame rate".to_owned());
    let events = editor.take_events();
    assert!(events.contains(&expected), "{events:?}");
}
