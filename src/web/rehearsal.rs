//! Opens and draws a tiny character while the first model downloads. A browser compiles each function when it is first called, and
//! a driver each shader when it is first drawn with: hundreds of milliseconds that would otherwise follow the last byte.

use super::calls::with_app;
use super::page::Page;
use crate::files::{Item, Role, open_items};
use crate::frame::{Frame, evaluate};
use crate::library::Library;
use crate::state::ViewerState;

/// A skinned triangle with the two commonest materials: a base colour map alone, and with a normal map.
const CHARACTER: &[u8] = include_bytes!("rehearsal.gltf");

/// # Errors
/// If the app has stopped. That the character can be opened is tested.
pub async fn rehearse(page: &Page) -> Result<(), String> {
    let items = vec![Item::File("rehearsal.gltf".to_owned(), CHARACTER.to_vec())];
    let Ok(contents) = open_items(items, Role::Model, &|_, _, _| ()).await else { return Ok(()) };
    let (mut library, mut frame) = (Library::default(), Frame::default());
    contents.models.into_iter().for_each(|character| _ = library.add(character.model));
    evaluate(&library, &ViewerState::default(), 1.0, &mut frame);
    library.active().map_or(Ok(()), |character| with_app(page, |app| app.rehearse(character, &frame)))
}
