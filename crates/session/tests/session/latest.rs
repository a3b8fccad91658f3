//! What was asked for last is what is shown, whatever took how long.

use crate::cases::{DANCE, FOX, MAN};
use crate::orders::{assert_address_shows_view, in_every_order, in_some_orders};
use crate::program::Content;
use crate::world::{Act, World};

const SERVER: &[(&str, Content)] = &[
    ("walker", Content::Model("walker")),
    ("a.glb", Content::Model("a")),
    ("b.glb", Content::Model("b")),
    ("walk.bvh", Content::Motion),
];

/// After these acts, and whatever follows in whatever order, these models and motions are shown, and the address says so.
#[track_caller]
fn check_from(start: &World, acts: &[Act], models: &[&str], motions: &[&str]) {
    in_every_order(start, acts, |world| {
        assert_eq!(world.models(), models, "{acts:?}");
        assert_eq!(world.view().motions, motions, "{acts:?}");
        assert_eq!(world.report, None, "{acts:?}");
        assert_address_shows_view(world);
    });
}

#[track_caller]
fn check(acts: &[Act], models: &[&str], motions: &[&str]) {
    check_from(&World::at_rest("model=walker", SERVER), acts, models, motions);
}

#[test]
fn of_two_files_the_later_one_is_shown() {
    check(&[FOX, MAN], &["Man.glb"], &[]);
    check(&[FOX, Act::Url("a.glb")], &["a.glb"], &[]);
    check(&[Act::Url("a.glb"), FOX], &["Fox.glb"], &[]);
    check(&[Act::Script("a.glb"), Act::Script("b.glb")], &["b.glb"], &[]);
}

/// What the page around this one gives isn't looked for among the user's own files, so it begins sooner.
#[test]
fn a_gltf_whose_files_are_looked_for_gives_way_as_well() {
    let mut start = World::at_rest("model=walker", SERVER);
    start.then(Act::Drop(&[("skin.png", Content::Part)]));
    let gltf = Act::Drop(&[("own.gltf", Content::Gltf(&["skin.png"]))]);
    let given = Act::Frame(&[("Given.glb", Content::Model("given"))]);
    in_every_order(&start, &[gltf, given], |world| assert_eq!(world.models(), ["Given.glb"]));
}

#[test]
fn of_two_links_the_later_one_is_shown() {
    check(&[Act::Type("model=a.glb"), Act::Type("model=b.glb")], &["b.glb"], &[]);
    check(&[Act::Type("model=a.glb"), Act::Type("model=walker")], &["walker"], &[]);
    check(&[Act::Type("model=a.glb&motion=walk.bvh"), Act::Type("model=a.glb")], &["a.glb"], &[]);
}

#[test]
fn a_link_gives_way_to_what_is_opened_meanwhile_and_the_other_way_round() {
    check(&[Act::Type("model=a.glb"), FOX], &["Fox.glb"], &[]);
    check(&[FOX, Act::Type("model=a.glb")], &["a.glb"], &[]);
    check(&[Act::Url("b.glb"), Act::Type("model=walker")], &["walker"], &[]);
    check(&[FOX, Act::Type("model=walker&exposure=1")], &["walker"], &[]);
}

#[test]
fn going_back_is_the_latest_as_well() {
    let mut start = World::at_rest("model=walker", SERVER);
    start.then(Act::Type("model=a.glb"));
    in_every_order(&start, &[Act::Type("model=b.glb"), Act::Back], |world| {
        assert_eq!(world.models(), ["a.glb"]);
        assert_address_shows_view(world);
        assert_eq!(world.entries.len(), 3);
    });
    in_every_order(&start, &[Act::Back, Act::Forward], |world| {
        assert_eq!(world.models(), ["a.glb"]);
        assert_address_shows_view(world);
        assert_eq!(world.entries.len(), 2);
    });
}

#[test]
fn a_motion_waits_for_the_model_on_its_way() {
    check(&[Act::Url("a.glb"), DANCE], &["a.glb"], &["dance.bvh"]);
    check(&[FOX, DANCE], &["Fox.glb"], &["dance.bvh"]);
    check(&[Act::Type("model=a.glb"), DANCE], &["a.glb"], &["dance.bvh"]);
    let lent = Act::Lend(&[("Man.glb", Content::Model("man"))]);
    check(&[FOX, lent], &["Fox.glb"], &["Man.glb"]);
}

/// It was for what was shown before.
#[test]
fn a_motion_that_waits_is_not_for_the_entry_that_is_gone_to() {
    let start = World::at_rest("model=walker", SERVER);
    in_every_order(&start, &[Act::Url("a.glb"), DANCE, Act::Type("model=b.glb")], |world| {
        assert_eq!(world.models(), ["b.glb"]);
        assert_eq!(world.view().motions, [""; 0]);
        assert_address_shows_view(world);
    });
}

#[test]
fn what_is_asked_for_while_the_program_starts_is_shown_once_it_has() {
    let start = World::new("model=walker", SERVER);
    check_from(&start, &[FOX], &["Fox.glb"], &[]);
    check_from(&start, &[Act::Type("model=a.glb")], &["a.glb"], &[]);
    check_from(&start, &[FOX, Act::Type("model=a.glb")], &["a.glb"], &[]);
    check_from(&start, &[Act::Type("model=a.glb"), FOX], &["Fox.glb"], &[]);
    check_from(&start, &[Act::Type("model=a.glb"), Act::Type("model=b.glb")], &["b.glb"], &[]);
    check_from(&start, &[FOX, DANCE], &["Fox.glb"], &["dance.bvh"]);
}

/// Many acts in some of their orders: whatever is asked for last is shown.
#[test]
fn the_latest_wins_among_many() {
    const ASKED: [(Act, &str); 6] = [
        (FOX, "Fox.glb"),
        (MAN, "Man.glb"),
        (Act::Url("a.glb"), "a.glb"),
        (Act::Script("b.glb"), "b.glb"),
        (Act::Type("model=a.glb"), "a.glb"),
        (Act::Type("model=walker"), "walker"),
    ];
    for (last, shown) in ASKED {
        in_some_orders(
            &World::new("model=walker", SERVER),
            |random| {
                let count = 1 + random.below(5);
                let others = (0..count).map(|_| random.pick(&ASKED).0);
                others.chain([last]).collect()
            },
            300,
            |world| {
                assert_eq!(world.models(), [shown]);
                assert_address_shows_view(world);
            },
        );
    }
}
