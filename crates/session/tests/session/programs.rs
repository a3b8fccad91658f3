//! Programs that end at any time, and those that take their place.

use gaitway_session::{ErrorCode, Event, Failure, RequestId};

use crate::cases::{FOX, MAN, start};
use crate::orders::{assert_address_shows_view, in_every_order, in_some_orders};
use crate::program::Content;
use crate::world::{Act, Due, World};

const SERVER: &[(&str, Content)] = &[("walker", Content::Model("walker")), ("a.glb", Content::Model("a"))];

#[test]
fn a_restart_shows_the_view_again_with_its_local_files() {
    let mut world = start();
    world.then(FOX).then(Act::Set("exposure=1"));
    let before = world.entries.clone();
    world.then(Act::Crash).then(Act::Launch);
    assert_eq!(world.view().link().text(), "model=Fox.glb&exposure=1");
    assert_eq!(world.entries, before);
}

#[test]
fn everybody_is_answered_when_the_program_ends() {
    in_every_order(&start(), &[FOX, Act::Crash, Act::Launch], |world| {
        if let Err(failure) = &world.answers[&RequestId(1)][0] {
            assert_eq!(failure.code, Some(ErrorCode::LostDevice));
        }
        assert_address_shows_view(world);
    });
    in_every_order(&start(), &[Act::Crash, FOX, Act::Launch], |world| {
        let failure = world.answers[&RequestId(1)][0].as_ref().expect_err("nothing runs");
        assert_eq!(failure.message, "Gaitway has stopped: an error");
        assert_eq!(world.models(), ["walker"]);
    });
    in_every_order(&start(), &[Act::Crash, Act::Launch, FOX], |world| {
        assert_eq!(world.models(), ["Fox.glb"], "it has waited");
    });
}

/// Without a program, nothing says what the page shows next.
#[test]
fn going_back_from_a_program_that_has_stopped_shows_the_files_that_the_page_holds() {
    let mut start = start();
    start.then(FOX).then(MAN);
    in_every_order(&start, &[Act::Crash, Act::Back, Act::Launch], |world| {
        assert_eq!((world.models(), &world.asks), (vec!["Fox.glb".to_owned()], &None));
        assert_eq!(world.addresses(), ["model=walker", "model=file:Fox.glb", "model=file:Man.glb"]);
        assert_eq!(world.at, 1);
        // What has been gone to once isn't gone to again.
        let mut world = world.clone();
        world.then(MAN).then(Act::Crash).then(Act::Launch);
        assert_eq!(world.models(), ["Man.glb"]);
    });
}

/// It says what it shows before its first picture is drawn.
#[test]
fn what_is_gone_to_while_the_program_starts_is_shown() {
    in_every_order(&World::new("model=walker", SERVER), &[Act::Type("model=a.glb")], |world| {
        assert_eq!(world.models(), ["a.glb"]);
        assert_address_shows_view(world);
    });
    let mut start = start();
    start.then(FOX).then(MAN);
    in_every_order(&start, &[Act::Crash, Act::Launch, Act::Back], |world| {
        assert_eq!((world.models(), &world.asks), (vec!["Fox.glb".to_owned()], &None));
    });
}

#[test]
fn a_link_that_is_typed_while_the_program_starts_does_not_come_back_later() {
    let mut world = World::new("model=walker", SERVER);
    world.then(Act::Type("model=a.glb")).then(FOX).then(Act::Crash).then(Act::Launch);
    assert_eq!(world.models(), ["Fox.glb"]);
}

#[test]
fn a_second_back_end_gets_what_the_first_could_not_show() {
    let mut world = World::new("model=file:Fox.glb&fov=20", SERVER);
    world.first(|due| *due == Due::Loaded);
    // There is no device.
    world.due.clear();
    world.tell(Event::Loaded);
    world.rest();
    assert_eq!(world.asks, Some(vec!["Fox.glb (model)".to_owned()]));
    world.then(FOX);
    assert_eq!(world.view().link().text(), "model=Fox.glb&fov=20");
}

#[test]
fn nothing_is_opened_where_no_program_runs() {
    let mut world = World::new("model=walker", SERVER);
    world.act(FOX);
    assert_eq!(world.answers[&RequestId(1)], [], "it waits");
    world.due.clear();
    let failure = Failure { code: Some(ErrorCode::Unsupported), message: "Graphics: none.".to_owned() };
    world.tell(Event::CannotRun { failure: failure.clone() });
    assert_eq!(world.answers[&RequestId(1)], [Err(failure)]);
}

/// “Try again” restarts the program where a link has local files.
#[test]
fn trying_a_link_with_local_files_again_restarts_the_program() {
    let mut world = start();
    world.then(FOX).then(Act::Type("model=file:Fox.glb&motion=gone.bvh"));
    assert!(world.report.is_some());
    world.server.insert("gone.bvh", Content::Motion);
    world.act(Act::Script("a.glb"));
    world.then(Act::TryAgain);
    let failure = world.answers[&RequestId(2)][0].as_ref().expect_err("its program has ended");
    assert_eq!(failure.message, "Gaitway has stopped: it was restarted");
    assert_eq!(world.view().link().text(), "model=Fox.glb&motion=gone.bvh");
    assert_eq!(world.report, None);
}

/// Traps at any time, in some orders: whatever runs then shows what the address says, and nobody waits in vain.
#[test]
fn a_session_outlives_programs_that_trap_at_any_time() {
    const ACTS: [Act; 7] =
        [FOX, MAN, Act::Script("a.glb"), Act::Type("model=a.glb"), Act::Back, Act::Set("exposure=1"), Act::Forward];
    let acts = |random: &mut crate::orders::Random| {
        let mut acts = Vec::new();
        for _ in 0..3 {
            acts.extend((0..3).map(|_| random.pick(&ACTS)));
            acts.extend([Act::Crash, random.pick(&ACTS), Act::Launch]);
        }
        acts
    };
    in_some_orders(&start(), acts, 3000, assert_address_shows_view);
}
