//! What a page around this one must not learn: anything of the user's own files.

use gaitway_session::{Event, Shown};

use crate::cases::start;
use crate::orders::in_every_order;
use crate::program::Content;
use crate::world::{Act, Due, World};

const MINE: Act = Act::Drop(&[("Mine.glb", Content::Model("mine"))]);
const GIVEN: Act = Act::Frame(&[("Fox.glb", Content::Model("fox"))]);
const DANCE: Act = Act::Drop(&[("mine.bvh", Content::Motion)]);
const SERVER: &[(&str, Content)] = &[("walker", Content::Model("walker")), ("a.glb", Content::Model("a"))];

#[test]
fn what_shows_the_users_own_files_is_private() {
    let mut world = start();
    assert!(!world.is_private());
    assert!(world.then(MINE).is_private());
    assert!(!world.then(Act::Script("a.glb")).is_private(), "nothing private is left");
    assert!(world.then(DANCE).is_private());
    assert!(world.then(Act::Script("walker")).is_private(), "the motion is still there");
}

#[test]
fn what_the_page_around_this_one_gives_it_may_learn() {
    in_every_order(&start(), &[GIVEN], |world| {
        assert!(!world.is_private());
        assert_eq!(world.models(), ["Fox.glb"]);
        assert!(!world.entries[world.at].state.own);
    });
}

#[test]
fn files_are_private_as_soon_as_they_are_opened() {
    let mut world = start();
    let seen = world.session.facts().seen_private;
    world.act(MINE);
    assert!(world.is_private(), "before they are read");
    assert!(world.session.facts().seen_private > seen, "whatever becomes of them");
}

#[test]
fn what_is_said_about_files_that_could_not_be_opened_is_private() {
    let mut world = start();
    world.then(Act::Drop(&[("mine.glb", Content::Damaged)]));
    assert!(world.is_private());
    assert!(!world.then(Act::Script("a.glb")).is_private());
}

#[test]
fn an_entry_that_has_shown_private_files_stays_private_after_a_reload() {
    let mut world = start();
    world.then(MINE);
    assert!(world.entries[world.at].state.own);
    let mut reloaded = World::reopened(world.entries[world.at].clone(), SERVER);
    reloaded.rest();
    assert!(reloaded.is_private(), "the address names them");
    assert_eq!(reloaded.asks, Some(vec!["Mine.glb (model)".to_owned()]));
}

#[test]
fn going_back_to_private_files_is_private() {
    let mut start = start();
    start.then(MINE).then(Act::Script("a.glb"));
    in_every_order(&start, &[Act::Back], |world| {
        assert_eq!(world.models(), ["Mine.glb"]);
        assert!(world.is_private());
    });
}

/// The page around this one can't read them by adding a file to them.
#[test]
fn a_given_file_does_not_join_the_users_own() {
    let mut world = start();
    world.then(Act::Drop(&[("own.gltf", Content::Gltf(&["body.bin"])), ("body.bin", Content::Part)]));
    assert!(world.is_private());
    world.then(Act::Frame(&[("body.bin", Content::Part)]));
    assert_eq!(world.models(), ["own.gltf"]);
    assert!(world.is_private());
}

#[test]
fn a_given_file_does_not_complete_what_the_user_is_asked_for_as_the_users_own() {
    let mut world = World::at_rest("model=file:Fox.glb", SERVER);
    world.then(GIVEN);
    assert_eq!(world.models(), ["Fox.glb"]);
    assert!(!world.is_private());
}

#[test]
fn a_restart_keeps_files_private() {
    let mut world = start();
    world.then(MINE).then(Act::Crash).then(Act::Launch);
    assert_eq!(world.models(), ["Mine.glb"]);
    assert!(world.is_private());
}

#[test]
fn a_program_that_traps_is_as_private_as_what_it_has_shown() {
    assert!(!start().then(Act::Crash).is_private());
    assert!(start().then(MINE).then(Act::Crash).is_private());
}

#[test]
fn a_program_that_starts_is_as_private_as_what_it_will_show() {
    let mut world = start();
    world.then(MINE).then(Act::Crash).act(Act::Launch);
    world.first(|due| *due == Due::Loaded);
    // Its stage is still empty.
    world.session.handle(Event::Settled, Some(Shown::default()));
    assert!(world.is_private());
}

#[test]
fn a_program_that_is_too_busy_to_be_asked_may_show_anything() {
    let mut world = start();
    world.session.handle(Event::Settled, None);
    assert!(world.is_private());
    world.tell(Event::Settled);
    assert!(!world.is_private());
}
