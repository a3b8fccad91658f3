//! The editor without a shell: opening, activating, closing and undoing, with their notices.

mod camera;
mod copies;
mod environments;
mod fewer_keys;
mod identity;
mod in_view;
mod maps;
mod motions;
mod new_version;
mod one_character;
mod open;
mod plan;
mod privacy;
mod reduced_motion;
mod root_bone;
mod saved_names;
mod undo;
mod validation;

use gaitway_scene::editor::{Contents, Editor, Event};
use gaitway_scene::library::{Model, Motion};
use gaitway_scene::samples;
use gaitway_scene::state::{CameraChoice, OrbitCamera, active_clip};

use crate::opened::contents;

fn any(_: &Model) -> Result<(), String> {
    Ok(())
}

pub fn editor(first: &str) -> Editor {
    let mut editor = Editor::default();
    open(&mut editor, first);
    editor
}

/// Returns the events.
fn open(editor: &mut Editor, file: &str) -> Vec<Event> {
    editor.open(contents(&[file]), None, &mut any).expect("fits");
    editor.take_events()
}

/// The walker's clips as a motion of this name.
fn motion(name: &str) -> Motion {
    Motion::new(name.to_owned(), samples::load("walker").expect("is generated").asset)
}

fn open_motion(editor: &mut Editor, name: &str) {
    let contents = Contents { motions: Some(vec![motion(name)]), ..Contents::default() };
    editor.open(contents, None, &mut any).expect("fits");
    editor.take_events();
}

fn motions(editor: &Editor) -> Vec<&str> {
    editor.library().motions().iter().map(|motion| motion.source.as_str()).collect()
}

fn id_of(editor: &Editor, source: &str) -> gaitway_scene::library::ModelId {
    editor.library().models().iter().find(|model| model.source == source).expect("is listed").id
}

fn title(editor: &Editor) -> Option<&str> {
    let model = editor.library().active()?;
    Some(active_clip(model, editor.state())?.title())
}

fn active(editor: &Editor) -> &str {
    &editor.library().active().expect("a model").source
}

fn notices(events: &[Event]) -> Vec<&str> {
    let mut texts = Vec::new();
    for event in events {
        if let Event::Notice { text, .. } | Event::AboutView(text) = event {
            texts.push(text.as_str());
        }
    }
    texts
}

fn orbit(editor: &Editor) -> OrbitCamera {
    let CameraChoice::Orbit(orbit) = editor.state().camera else { panic!("{:?}", editor.state().camera) };
    orbit
}
