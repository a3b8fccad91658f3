//! The included samples, and the gallery's scenes.

use gaitway::files::{Role, open_paths, read_paths};
use gaitway_scene::library::Library;
use gaitway_scene::samples;
use gaitway_scene::state::{ClipChoice, Command, ViewerState, active_clip, apply, from_link, resolve_camera};
use serde_json::Value;

fn scenes() -> Vec<Value> {
    let text = include_str!("../../assets/samples/gallery.json");
    serde_json::from_str(text).expect("a list of scenes")
}

/// Returns the link of a scene's card, composed as in the page's build (xtask/site/samples.mjs).
fn link_of(scene: &Value) -> String {
    let text = |key: &str| scene[key].as_str();
    let motion = text("motion").map(|motion| format!("&motion={motion}")).unwrap_or_default();
    format!("v=2&model={}{motion}&{}", text("model").expect("a model"), text("view").expect("a view"))
}

/// Opens all files of a scene and applies its view, as the page does.
fn check(scene: &Value) {
    let link = &link_of(scene);
    let (wanted, errors) = from_link(link);
    assert!(errors.is_empty(), "{link}: {errors:?}");
    let paths = wanted.character.sources.model.iter().map(Into::into).collect::<Vec<_>>();
    let opened = open_paths(&paths).unwrap_or_else(|error| panic!("{link}: {error}"));
    assert_eq!(opened.model.source, wanted.character.sources.model[0], "{link}");
    assert!(opened.model.asset.warnings.iter().next().is_none(), "{link}: {:?}", opened.model.asset.warnings);
    let mut library = Library::default();
    library.add(opened.model);
    let motions = wanted.character.sources.motion.iter().flat_map(|motion| {
        let contents = read_paths(&[motion.into()], Role::Motion).unwrap_or_else(|error| panic!("{link}: {error}"));
        contents.motions.unwrap_or_default()
    });
    library.set_motions(motions.collect());
    library.borrow_each(vec![None; library.motions().len()]);
    assert!(library.borrow_errors().is_empty(), "{link}: {:?}", library.borrow_errors());
    let named_clip = match &wanted.character.playhead.clip {
        ClipChoice::Clip(clip) => clip.name().map(str::to_owned),
        _ => None,
    };
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::Replace(Box::new(wanted)));
    let model = library.active().expect("a model");
    let clip = active_clip(model, &state);
    assert!(named_clip.is_none_or(|name| clip.is_some_and(|clip| clip.name() == name)), "{link}: no such clip");
    let moves = clip.is_some_and(|clip| clip.duration_secs() > 0.0) || state.camera_options.turntable != 0.0;
    assert!(moves, "{link}: nothing moves");
    let camera = resolve_camera(&library, &state, 1.5);
    assert!(camera.distance.is_finite() && camera.distance > 0.0, "{link}: {camera:?}");
}

/// The gallery leaves out scenes whose samples are missing. The first is the start screen and must be available.
#[test]
fn every_scene_opens() {
    let known = samples::names();
    let there = |scene: &&Value| {
        let sources = ["model", "motion"].into_iter().filter_map(|key| scene[key].as_str());
        sources.filter_map(|source| source.strip_prefix("sample:")).all(|name| known.contains(&name))
    };
    let scenes = scenes();
    assert!(scenes.first().is_some_and(|first| there(&first)), "the first scene's samples should be there");
    scenes.iter().filter(there).for_each(check);
}

#[test]
fn the_windows_first_sample_exists() {
    open_paths(&[samples::FIRST.into()]).expect("the first sample");
}

#[test]
fn every_sample_opens() {
    for name in samples::names() {
        let source = format!("sample:{name}");
        let contents =
            read_paths(&[source.clone().into()], Role::Any).unwrap_or_else(|error| panic!("{source}: {error}"));
        let motions = contents.motions.iter().flatten().map(|motion| motion.source.clone());
        let found: Vec<String> =
            contents.models.iter().map(|opened| opened.model.source.clone()).chain(motions).collect();
        assert_eq!(found, [source]);
        assert_ne!(samples::title(name), name, "it should have a title for the screen");
    }
}
