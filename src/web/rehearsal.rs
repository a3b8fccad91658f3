//! Opens and draws a simple character while the first model downloads. A browser compiles each function when it is first called, and
//! a driver each shader when it is first drawn with: hundreds of milliseconds that would otherwise follow the last byte.

use gaitway_render::next_turn;
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::Library;
use gaitway_scene::samples::rehearsal_files;
use gaitway_scene::state::from_link;

use super::calls::with_app;
use super::page::Page;
use crate::app::RehearsalPart;
use crate::files::{ImageLimits, Item, Role, open_items};

/// Lets the browser do something else after each part.
///
/// # Errors
/// If the app has stopped.
pub(super) async fn rehearse(page: &Page) -> Result<(), String> {
    next_turn().await;
    let library = open_character().await;
    let Some(character) = library.active() else { return Ok(()) };
    let frame_of = |link| {
        let mut frame = Frame::default();
        evaluate(&library, &from_link(link).0, 1.0, &mut frame);
        frame
    };
    // The second picture shows the second material, too, which has shaders of its own.
    let [one_material, both_materials] = ["hidden=m1", ""].map(frame_of);
    let mut frame = &one_material;
    for part in RehearsalPart::ALL {
        next_turn().await;
        with_app(page, |app| app.rehearse(character, frame, part))?;
        if matches!(part, RehearsalPart::Picture) {
            frame = &both_materials;
        }
    }
    Ok(())
}

/// A test checks that the character can be opened.
async fn open_character() -> Library {
    let items = rehearsal_files().into_iter().map(|(name, bytes)| Item::File(name.to_owned(), bytes)).collect();
    let mut library = Library::default();
    let opened = open_items(&ImageLimits::default(), items, Role::Model, &|_, _, _| (), None).await;
    opened.into_iter().flat_map(|contents| contents.models).for_each(|character| _ = library.add(character.model));
    library
}
