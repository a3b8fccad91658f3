//! Entries of the browser's history: which there are, what their addresses say, and what going back to them shows.

use gaitway_session::{Effect, EntryState};

use crate::cases::{DANCE, FOX, MAN};
use crate::orders::{assert_address_shows_view, in_every_order, in_some_orders};
use crate::program::Content;
use crate::world::{Act, Due, World};

const OTHER_FOX: Act = Act::Drop(&[("Fox.glb", Content::Model("other fox"))]);
const SERVER: &[(&str, Content)] = &[
    ("walker", Content::Model("walker")),
    ("a.glb", Content::Model("a")),
    ("b.glb", Content::Model("b")),
    ("broken.glb", Content::Damaged),
];

#[test]
fn opening_adds_an_entry_and_setting_changes_it() {
    let mut world = World::at_rest("model=walker", SERVER);
    assert_eq!(world.addresses(), ["model=walker"], "the address stays as it was typed");
    world.then(Act::Set("exposure=1")).then(FOX).then(Act::Set("exposure=2")).then(Act::Url("a.glb"));
    let addresses = ["model=walker&exposure=1", "model=file:Fox.glb&exposure=2", "model=a.glb&exposure=2"];
    assert_eq!(world.addresses(), addresses);
}

#[test]
fn going_back_shows_what_an_entry_showed_with_its_local_files() {
    let mut world = World::at_rest("model=walker", SERVER);
    world.then(FOX).then(Act::Set("exposure=1")).then(MAN).then(OTHER_FOX);
    let before = world.entries.clone();
    world.then(Act::Back);
    assert_eq!(world.models(), ["Man.glb"]);
    world.then(Act::Back);
    assert_eq!(world.content(), Some(Content::Model("fox")), "not the one of the same name");
    assert_eq!(world.view().link().text(), "model=Fox.glb&exposure=1");
    world.then(Act::Back);
    assert_eq!(world.models(), ["walker"]);
    world.then(Act::Forward).then(Act::Forward).then(Act::Forward);
    assert_eq!(world.content(), Some(Content::Model("other fox")));
    assert_eq!(world.entries.len(), before.len(), "nothing is added");
    assert_eq!(world.asks, None);
}

#[test]
fn going_back_lends_a_local_motion_to_its_own_model() {
    let mut start = World::at_rest("model=a.glb", SERVER);
    start.then(DANCE).then(Act::Set("t=1")).then(Act::Type("model=b.glb"));
    in_every_order(&start, &[Act::Back], |world| {
        assert_eq!(world.view().link().text(), "model=a.glb&motion=dance.bvh&t=1");
        assert_eq!((&world.asks, &world.report), (&None, &None));
    });
}

/// An entry's address lags behind what has been set.
#[test]
fn going_back_before_the_address_was_written_loses_nothing() {
    let mut start = World::at_rest("model=walker", SERVER);
    start.then(FOX);
    in_every_order(&start, &[Act::Set("exposure=3"), Act::Type("model=a.glb")], |world| {
        let mut world = world.clone();
        world.then(Act::Back);
        assert_eq!(world.view().link().text(), "model=Fox.glb&exposure=3");
    });
}

#[test]
fn an_edited_address_shows_the_files_that_are_open() {
    let mut world = World::at_rest("model=walker", SERVER);
    world.then(FOX).then(Act::Type("model=file:Fox.glb&t=1"));
    assert_eq!((world.models(), &world.asks), (vec!["Fox.glb".to_owned()], &None));
    // Others have been opened since.
    world.then(MAN).then(Act::Type("model=file:Fox.glb&t=2"));
    assert_eq!((world.models(), &world.asks), (vec!["Fox.glb".to_owned()], &None));
    // Nobody has opened this one.
    world.then(Act::Type("model=file:Wolf.glb"));
    assert_eq!(world.asks, Some(vec!["Wolf.glb (model)".to_owned()]));
}

#[test]
fn a_link_that_cannot_be_loaded_keeps_the_view_and_its_address() {
    let start = World::at_rest("model=walker", SERVER);
    in_every_order(&start, &[Act::Type("model=broken.glb")], |world| {
        assert_eq!(world.models(), ["walker"]);
        assert_eq!(world.address(), "model=broken.glb", "reloading tries again");
        assert_eq!(world.report, Some(vec!["broken.glb: no such file".to_owned()]));
        let mut world = world.clone();
        world.then(Act::Set("exposure=1"));
        assert_eq!(world.address(), "model=walker&exposure=1", "until something is set");
    });
}

#[test]
fn what_could_not_be_loaded_is_tried_again() {
    let mut world = World::at_rest("model=walker", SERVER);
    world.then(Act::Type("model=broken.glb"));
    world.then(Act::TryAgain);
    assert!(world.report.is_some());
    world.server.insert("broken.glb", Content::Model("repaired"));
    in_every_order(&world, &[Act::TryAgain], |world| {
        assert_eq!((world.models(), &world.report), (vec!["broken.glb".to_owned()], &None));
        assert_address_shows_view(world);
    });
}

#[test]
fn a_link_whose_loading_the_user_cancels_stays_in_the_address() {
    let mut world = World::at_rest("model=walker", SERVER);
    world.act(Act::Type("model=a.glb"));
    world.then(Act::Cancel);
    assert_eq!((world.models(), world.address()), (vec!["walker".to_owned()], "model=a.glb"));
    assert!(world.told.contains(&Effect::Notify { text: "Opening was cancelled.".to_owned() }));
    world.then(FOX);
    assert_eq!(world.addresses(), ["model=walker", "model=a.glb", "model=file:Fox.glb"]);
}

/// A site may take long to answer for what was overtaken.
#[test]
fn what_is_opened_instead_of_a_link_gets_an_entry_at_once() {
    let mut world = World::at_rest("model=walker", SERVER);
    world.act(Act::Type("model=a.glb"));
    world.act(FOX);
    world.first(|due| matches!(due, Due::Read(_)));
    let slow = world.due.iter().position(|due| matches!(due, Due::Load { number: 1, .. })).expect("it loads");
    let slow = world.due.remove(slow);
    world.rest();
    assert_eq!(world.addresses(), ["model=walker", "model=a.glb", "model=file:Fox.glb"]);
    world.due.push(slow);
    world.rest();
    assert_eq!(world.addresses(), ["model=walker", "model=a.glb", "model=file:Fox.glb"]);
    assert_eq!((world.models(), &world.report), (vec!["Fox.glb".to_owned()], &None));
}

#[test]
fn an_entry_of_a_reloaded_page_keeps_its_number() {
    let mut world = World::at_rest("model=walker", SERVER);
    world.then(Act::Url("a.glb")).then(Act::Url("b.glb"));
    let entry = world.entries[world.at].clone();
    let mut world = World::reopened(entry.clone(), SERVER);
    world.rest();
    world.then(Act::Set("exposure=1")).then(Act::Url("a.glb"));
    assert_eq!(world.entries[0].state, EntryState { number: entry.state.number, own: false });
    assert!(world.entries[1].state.number > entry.state.number, "{:?}", world.entries);
}

#[test]
fn files_that_nothing_can_show_again_are_forgotten() {
    let mut world = World::at_rest("model=walker", SERVER);
    for _ in 0..60 {
        world.then(FOX).then(MAN);
    }
    // The sets that are held, and those of the entries.
    assert!(world.files.len() <= 32 + 16, "{} files", world.files.len());
    world.then(Act::Back);
    assert_eq!(world.models(), ["Fox.glb"]);
}

/// Walks through the history among openings and links, in some orders.
#[test]
fn the_address_always_says_what_is_shown() {
    const ACTS: [Act; 8] = [
        FOX,
        OTHER_FOX,
        DANCE,
        Act::Url("a.glb"),
        Act::Type("model=b.glb"),
        Act::Set("exposure=1"),
        Act::Back,
        Act::Forward,
    ];
    let acts = |random: &mut crate::orders::Random| (0..8).map(|_| random.pick(&ACTS)).collect();
    in_some_orders(&World::at_rest("model=walker", SERVER), acts, 3000, assert_address_shows_view);
}
