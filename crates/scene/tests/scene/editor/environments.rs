//! Environments: lighting the scene and being kept.

use gaitway_character::asset::Panorama;
use gaitway_formats::FileSet;
use gaitway_scene::editor::{Contents, Editor, ModelFiles};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{Environment, Library};
use gaitway_scene::state::{CharacterView, Command, EnvironmentChoice, Lighting, ViewerState};
use glam::Vec3;

use super::{any, contents, editor, motion, notices, open};

/// Grey from all directions.
fn environment(origin: &str) -> Contents {
    let panorama = Panorama::new(2, 1, vec![Vec3::splat(0.5); 2]).expect("the right size");
    let environment =
        Environment { origin: origin.to_owned(), panorama: panorama.into(), file: Default::default(), is_own: false };
    Contents { environment: Some(environment), ..Contents::default() }
}

#[test]
fn an_environment_lights_the_scene_until_it_is_undone() {
    let mut editor = editor("sample:walker");
    editor.open(environment("beach.hdr"), None, &mut any).expect("fits");
    assert_eq!(notices(&editor.take_events()), ["Lit by beach.hdr."]);
    assert_eq!(editor.state().lighting.environment, EnvironmentChoice::File("beach.hdr".to_owned()));
    let mut frame = Frame::default();
    evaluate(editor.library(), editor.state(), 1.0, &mut frame);
    assert!(frame.panorama.is_some() && !editor.is_private());
    // Another model is lit by it, too.
    open(&mut editor, "sample:pilot");
    assert_eq!(editor.state().lighting.environment, EnvironmentChoice::File("beach.hdr".to_owned()));
    editor.undo();
    editor.undo();
    assert_eq!(editor.state().lighting, Lighting::default());
    // A view names what lights it, so opening the file for it changes nothing.
    let view = ViewerState {
        character: CharacterView { sources: editor.state().character.sources.clone(), ..CharacterView::default() },
        ..ViewerState::default()
    };
    let contents = Contents { motions: Some(Vec::new()), ..environment("sky.hdr").into_private() };
    editor.open(contents, Some(view), &mut any).expect("is loaded");
    assert_eq!(editor.state().lighting, Lighting::default());
    assert!(!editor.is_private(), "it is loaded, but not shown");
    editor.apply(Command::SetLight(EnvironmentChoice::File("sky.hdr".to_owned())));
    assert!(editor.is_private());
}

#[test]
fn an_environment_and_the_model_it_is_opened_with_are_one_step() {
    let mut editor = editor("sample:walker");
    let model = contents(&["sample:pilot"]);
    editor.open(Contents { environment: environment("beach.hdr").environment, ..model }, None, &mut any).expect("fits");
    assert_eq!(editor.state().lighting.environment, EnvironmentChoice::File("beach.hdr".to_owned()));
    assert!(editor.undo());
    assert_eq!(editor.state().character.sources.model, ["sample:walker"]);
    assert_eq!(editor.state().lighting, Lighting::default());
    assert!(editor.redo());
    assert_eq!(editor.state().lighting.environment, EnvironmentChoice::File("beach.hdr".to_owned()));
}

/// The first model is no step, since nothing was shown before.
#[test]
fn an_environment_on_an_empty_stage_is_undone_by_itself() {
    let mut editor = Editor::new(Library::default(), ViewerState::default());
    let model = contents(&["sample:pilot"]);
    editor.open(Contents { environment: environment("beach.hdr").environment, ..model }, None, &mut any).expect("fits");
    assert!(editor.undo());
    assert_eq!(editor.state().character.sources.model, ["sample:pilot"]);
    assert_eq!(editor.state().lighting, Lighting::default());
}

#[test]
fn a_few_environments_are_kept() {
    let mut editor = editor("sample:walker");
    for index in 0..6 {
        editor.open(environment(&format!("{index}.hdr")), None, &mut any).expect("fits");
    }
    let kept: Vec<&str> = editor.library().environments().iter().map(|kept| kept.origin.as_str()).collect();
    assert_eq!(kept, ["2.hdr", "3.hdr", "4.hdr", "5.hdr"]);
}

#[test]
fn a_scene_takes_the_image_that_lights_it_along() {
    let mut editor = editor("sample:walker");
    editor.open(environment("https://example.org/beach.hdr"), None, &mut any).expect("fits");
    let scene = editor.scene().expect("there is a model");
    assert!(scene.model.is_empty(), "the walker is generated");
    let names: Vec<&str> = scene.motion.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["light/environment.hdr"]);
    assert!(scene.link.contains("&light=light/environment.hdr"), "{}", scene.link);
    assert!(scene.link.contains("&embed=1"), "{}", scene.link);
}

#[test]
fn the_image_that_lights_a_scene_replaces_no_other_file() {
    let mut editor = editor("sample:walker");
    let mut walk = motion("light/environment.hdr");
    let mut set = FileSet::default();
    set.insert("light/environment.hdr", b"HIERARCHY".to_vec());
    walk.files = Some(ModelFiles { set, name: "light/environment.hdr".to_owned() });
    editor.open(Contents { motions: Some(vec![walk]), ..Contents::default() }, None, &mut any).expect("fits");
    editor.open(environment("beach.hdr"), None, &mut any).expect("fits");
    let scene = editor.scene().expect("there is a model");
    let names: Vec<&str> = scene.motion.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["light/environment.hdr", "2/light/environment.hdr"]);
    assert!(scene.link.contains("&light=2/light/environment.hdr"), "{}", scene.link);
}
