//! Choosing a material variant: commands, undo, other models, links and unknown names.

use std::sync::Arc;

use gaitway_character::asset::Asset;
use gaitway_scene::editor::{Contents, Editor, Event};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::state::{Command, History, ViewerState, apply, from_link};
use glam::Vec3;

use crate::data::{library_of, moving_box};
use crate::texts::link_of;

/// A box with two variants.
fn model(source: &str) -> Model {
    let library = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO; 2]);
    let asset = library.active().expect("a model").asset.clone();
    drop(library);
    let mut parts = Arc::try_unwrap(asset).expect("the only owner").into_parts();
    parts.variants = vec!["Day".to_owned(), "Night".to_owned()];
    Model::new(source.to_owned(), Asset::new(parts).expect("indices in range"), Vec::new())
}

fn chosen(name: &str) -> Command {
    Command::SetVariant(Some(name.to_owned()))
}

#[test]
fn the_frame_says_which_variant_is_drawn() {
    let library = library_of(model("box.glb"));
    let (mut state, mut frame) = (ViewerState::default(), Frame::default());
    for (command, variant) in [
        (chosen("Night"), Some(1)),
        (chosen("Dusk"), Some(1)),
        (Command::SetVariant(None), None),
        (chosen("Day"), Some(0)),
    ] {
        apply(&mut state, &library, command);
        evaluate(&library, &state, 1.0, &mut frame);
        assert_eq!(frame.characters[0].variant, variant, "{:?}", state.character.edits.variant);
    }
    // A view may name a variant that the model lacks.
    state.character.edits.variant = Some("Dusk".to_owned());
    evaluate(&library, &state, 1.0, &mut frame);
    assert_eq!(frame.characters[0].variant, None);
}

#[test]
fn a_variant_is_undone_and_stays_with_its_model() {
    let mut library = library_of(model("box.glb"));
    let (mut state, mut history, mut kept) = (ViewerState::default(), History::default(), Default::default());
    history.apply(&mut state, &library, chosen("Night"));
    let link = link_of(&state);
    assert_eq!(link, "v=2&variant=Night");
    assert_eq!(from_link(&link), (state.clone(), Vec::new()));
    assert!(history.undo(&mut state, &mut kept, &mut library));
    assert_eq!(state.character.edits.variant, None);
    assert!(history.redo(&mut state, &mut kept, &mut library));
    assert_eq!(state.character.edits.variant.as_deref(), Some("Night"));
    let other = state.for_model(ViewerState::of_model("other.glb".to_owned()));
    assert_eq!(other.character.edits.variant, None);
}

#[test]
fn an_unknown_variant_of_a_view_is_reported() {
    let notice = "variant: expected the name of a material variant, found “Dusk”; its variants are “Day”, “Night”; the \
                  file's own materials are used.";
    let mut view = ViewerState::of_model("box.glb".to_owned());
    view.character.edits.variant = Some("Dusk".to_owned());
    let mut editor = Editor::default();
    let contents = Contents { models: vec![model("box.glb").into()], ..Contents::default() };
    editor.open(contents, Some(view), &mut |_| Ok(())).expect("fits");
    let events = editor.take_events();
    assert!(events.iter().any(|event| matches!(event, Event::AboutView(text) if text == notice)), "{events:?}");
}

#[test]
fn a_library_without_models_has_no_variants() {
    let (mut state, library) = (ViewerState::default(), Library::default());
    apply(&mut state, &library, chosen("Night"));
    let mut frame = Frame::default();
    evaluate(&library, &state, 1.0, &mut frame);
    assert!(frame.characters.is_empty());
}
