//! Links that name files of somebody's computer, and copies of what couldn't be loaded.

use gaitway_session::{Effect, Event};

use crate::cases::{DANCE, FOX, MAN};
use crate::orders::{assert_address_shows_view, in_every_order};
use crate::program::Content;
use crate::world::{Act, World};

const WALK: Act = Act::Drop(&[("walk.bvh", Content::Motion)]);
const SERVER: &[(&str, Content)] = &[("walker", Content::Model("walker")), ("a.glb", Content::Model("a"))];

/// Lacks its motion, so that the model is shown without it.
const LACKS_MOTION: &str = "model=a.glb&motion=file:walk.bvh&fov=20";
const LACKS_ALL: &str = "model=file:Fox.glb&motion=file:walk.bvh&fov=20";

fn lines(lines: &[&str]) -> Option<Vec<String>> {
    Some(lines.iter().map(|&line| line.to_owned()).collect())
}

/// Whatever the order, the link is shown with the files that it has waited for.
#[track_caller]
fn check_complete(link: &str, acts: &[Act], model: &str) {
    for start in [World::at_rest(link, SERVER), World::new(link, SERVER)] {
        in_every_order(&start, acts, |world| {
            assert_eq!(world.view().link().text(), format!("model={model}&motion=walk.bvh&fov=20"), "{acts:?}");
            assert_eq!((&world.asks, world.session.facts().need), (&None, None), "{acts:?}");
            assert_eq!(world.entries.len(), 1, "it is the link's own entry: {:?}", world.addresses());
            assert_address_shows_view(world);
        });
    }
}

#[test]
fn the_files_of_a_link_arrive_in_any_order() {
    check_complete(LACKS_MOTION, &[WALK], "a.glb");
    check_complete(LACKS_ALL, &[FOX, WALK], "Fox.glb");
    check_complete(LACKS_ALL, &[WALK, FOX], "Fox.glb");
    let both = Act::Drop(&[("walk.bvh", Content::Motion), ("Fox.glb", Content::Model("fox"))]);
    check_complete(LACKS_ALL, &[both], "Fox.glb");
}

#[test]
fn copies_have_the_names_that_the_link_knows_them_by() {
    check_complete(LACKS_MOTION, &[Act::Drop(&[("walk (1).bvh", Content::Motion)])], "a.glb");
    check_complete(LACKS_ALL, &[Act::Drop(&[("walk copy.bvh", Content::Motion)]), FOX], "Fox.glb");
    check_complete(LACKS_ALL, &[WALK, Act::Drop(&[("Fox - Copy.glb", Content::Model("fox"))])], "Fox.glb");
}

#[test]
fn a_character_that_lends_its_motion_arrives_with_the_model() {
    let link = "model=file:Fox.glb&motion=file:Man.glb&fov=20";
    let both = Act::Drop(&[("Man.glb", Content::Model("man")), ("Fox.glb", Content::Model("fox"))]);
    in_every_order(&World::at_rest(link, SERVER), &[both], |world| {
        assert_eq!(world.view().link().text(), "model=Fox.glb&motion=Man.glb&fov=20");
    });
}

/// The link is no longer what was asked for last.
#[test]
fn a_link_that_is_complete_gives_way_to_what_was_opened_meanwhile() {
    for acts in [[WALK, Act::Script("walker")], [WALK, Act::Type("model=walker")]] {
        in_every_order(&World::at_rest(LACKS_MOTION, SERVER), &acts, |world| {
            assert_eq!(world.models(), ["walker"], "{acts:?}");
            assert_address_shows_view(world);
        });
    }
}

#[test]
fn the_page_asks_for_the_rest() {
    let mut world = World::at_rest(LACKS_ALL, SERVER);
    assert_eq!(world.asks, lines(&["Fox.glb (model)", "walk.bvh (motion)"]));
    world.then(WALK);
    assert_eq!(world.asks, lines(&["Fox.glb (model)"]));
    world.then(FOX);
    assert_eq!(world.asks, None);
}

#[test]
fn a_gltf_is_asked_for_with_its_files() {
    let world = World::at_rest("model=file:own.gltf", SERVER);
    assert_eq!(world.asks, lines(&["own.gltf (model), with its .bin and images"]));
}

#[test]
fn what_is_set_while_a_file_is_missing_survives_a_restart_and_a_reload() {
    let mut world = World::at_rest(LACKS_MOTION, SERVER);
    assert_eq!(world.view().link().text(), "model=a.glb&fov=20");
    world.then(Act::Set("fov=20&exposure=1"));
    assert_eq!(world.address(), "model=a.glb&motion=file:walk.bvh&fov=20&exposure=1");
    world.then(Act::Crash).then(Act::Launch);
    let shown = |world: &World| (world.view().link().text().to_owned(), world.asks.clone());
    let expected = ("model=a.glb&fov=20&exposure=1".to_owned(), lines(&["walk.bvh (motion)"]));
    assert_eq!(shown(&world), expected);
    let mut reloaded = World::reopened(world.entries[world.at].clone(), SERVER);
    reloaded.rest();
    assert_eq!(shown(&reloaded), expected);
    reloaded.then(WALK);
    assert_eq!(reloaded.view().link().text(), "model=a.glb&motion=walk.bvh&fov=20&exposure=1");
}

#[test]
fn sharing_names_what_is_missing_here() {
    let mut world = World::at_rest(LACKS_MOTION, SERVER);
    world.tell(Event::Share { link: world.view().link() });
    let Some(Effect::Share { link, embedded, files }) = world.told.last() else { panic!("{:?}", world.told) };
    assert_eq!(link.text(), LACKS_MOTION);
    assert_eq!(embedded.text(), format!("{LACKS_MOTION}&embed=1"));
    assert_eq!(files, &["walk.bvh (motion), missing here"]);
    // It is not asked for again, but the link still has it.
    world.tell(Event::Later);
    world.tell(Event::Share { link: world.view().link() });
    let Some(Effect::Share { link, files, .. }) = world.told.last() else { panic!("{:?}", world.told) };
    assert_eq!((link.text(), &files[..]), (LACKS_MOTION, &["walk.bvh (motion), missing here".to_owned()][..]));
}

/// It may have been the wrong file.
#[test]
fn another_model_is_shown_instead_until_the_file_arrives() {
    let need = "This link needs Fox.glb. Open a file with that name to see the shared view.";
    in_every_order(&World::at_rest("model=file:Fox.glb&fov=20", SERVER), &[MAN], |world| {
        assert_eq!(world.models(), ["Man.glb"]);
        assert!(world.told.contains(&Effect::Notify { text: need.to_owned() }), "{:?}", world.told);
        assert_eq!(world.session.facts().need, None, "it is no longer asked for");
        let mut world = world.clone();
        world.then(FOX);
        assert_eq!(world.view().link().text(), "model=Fox.glb&fov=20");
    });
}

#[test]
fn another_motion_is_borrowed_instead_until_the_file_arrives() {
    in_every_order(&World::at_rest(LACKS_MOTION, SERVER), &[DANCE], |world| {
        assert_eq!(world.view().motions, ["dance.bvh"]);
        assert_eq!((&world.asks, world.session.facts().need), (&None, None), "it is no longer asked for");
        let mut world = world.clone();
        world.then(WALK);
        assert_eq!(world.view().link().text(), "model=a.glb&motion=walk.bvh&fov=20");
    });
}

#[test]
fn a_damaged_file_is_asked_for_again() {
    let mut world = World::at_rest(LACKS_MOTION, SERVER);
    world.then(Act::Drop(&[("walk.bvh", Content::Damaged)]));
    assert_eq!(world.asks, lines(&["walk.bvh (motion)"]));
    world.then(WALK);
    assert_eq!(world.view().motions, ["walk.bvh"]);
}

#[test]
fn a_copy_completes_the_view_of_a_model_that_could_not_be_loaded() {
    let mut world = World::at_rest("model=https://a.example/Fox.glb?v=1&fov=20", SERVER);
    assert_eq!(world.report, lines(&["https://a.example/Fox.glb?v=1: no such file"]));
    assert_eq!(world.asks, None, "the page doesn't ask for it");
    let title = |effect: &Effect| matches!(effect, Effect::Report { title, .. } if title.starts_with("The model in"));
    assert!(world.told.iter().any(title), "{:?}", world.told);
    world.then(FOX);
    assert_eq!(world.view().link().text(), "model=Fox.glb&fov=20");
}

#[test]
fn a_part_that_cannot_be_loaded_is_reported_as_a_part() {
    let world = World::at_rest("model=a.glb&motion=gone.bvh", SERVER);
    assert_eq!(world.models(), ["a.glb"]);
    let title = |effect: &Effect| matches!(effect, Effect::Report { title, .. } if title.starts_with("Part of"));
    assert!(world.told.iter().any(title), "{:?}", world.told);
    assert_eq!(world.address(), "model=a.glb&motion=gone.bvh", "reloading tries again");
}

/// A dialog's “Not now”.
#[test]
fn what_is_brought_later_is_told_unless_the_empty_stage_says_it() {
    let told = |link| {
        let mut world = World::at_rest(link, SERVER);
        world.tell(Event::Later);
        world.told.iter().any(|effect| matches!(effect, Effect::Notify { .. }))
    };
    assert!(told(LACKS_MOTION));
    assert!(!told(LACKS_ALL));
}

#[test]
fn images_that_could_not_be_loaded_are_completed_by_a_copy_or_loaded_again() {
    let mut world = World::at_rest("model=a.glb", SERVER);
    world.tell(Event::ImagesFailed { problem: "a.glb: it broke off".to_owned() });
    assert_eq!(world.report, lines(&["a.glb: it broke off"]));
    let mut other = world.clone();
    other.then(Act::TryAgain);
    assert_eq!(other.told.last(), Some(&Effect::LoadImages));
    world.then(Act::Drop(&[("a.glb", Content::Model("a copy"))]));
    assert_eq!(world.content(), Some(Content::Model("a copy")));
}
