//! The page's session, for its scripts: the shell keeps the session as text, which outlives this instance, and has an instance
//! make the next one of each event. Only [`gaitway_session`] knows the form of both; these functions also run after the app has
//! stopped.

use gaitway_scene::library::Model;
use gaitway_session::{Effect, EntryState, Event, Facts, Link, Session, Shown};
use serde::Serialize;
use wasm_bindgen::prelude::*;

use super::calls::{malformed, with_app};
use super::page::page;

/// Returns the session of a page that was opened with this link, in an entry of the history with this number. `own`: the entry has
/// shown the user's own files.
#[wasm_bindgen]
pub fn session_of(link: String, number: Option<u32>, own: bool) -> Result<String, JsValue> {
    text_of(&Session::new(link.into(), EntryState { number, own }))
}

/// What follows from an event.
#[derive(Serialize)]
struct After {
    session: String,
    effects: Vec<Effect>,
    facts: Facts,
}

/// Returns what follows from an event, as `{session, effects, facts}`: the text of the session after it, what the page has to do, in
/// order, and what it may read until the next event.
#[wasm_bindgen]
pub fn session_after(session: &str, event: &str) -> Result<String, JsValue> {
    let mut session: Session = serde_json::from_str(session).map_err(|problem| malformed(problem.to_string()))?;
    let event: Event = serde_json::from_str(event).map_err(|problem| malformed(problem.to_string()))?;
    let effects = session.handle(event, shown());
    let (facts, session) = (session.facts(), text_of(&session)?);
    text_of(&After { session, effects, facts })
}

/// Returns what the app shows, if it can be asked.
fn shown() -> Option<Shown> {
    let shown = with_app(&*page().ok()?, |app| Shown {
        is_private: app.editor().is_private(),
        is_empty: app.library().active().is_none_or(Model::is_placeholder),
        models: app.state().character.sources.model.clone(),
    });
    shown.ok()
}

/// Returns the index of the link in `others` that shows the same files in the most similar view.
#[wasm_bindgen]
pub fn most_similar_link(link: &str, others: Vec<String>) -> Option<usize> {
    let others: Vec<Link> = others.into_iter().map(Link::from).collect();
    Link::from(link).most_similar(&others)
}

fn text_of(value: &impl Serialize) -> Result<String, JsValue> {
    serde_json::to_string(value).map_err(|problem| malformed(problem.to_string()))
}
