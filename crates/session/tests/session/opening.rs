//! Opening files and addresses: what is opened together, who is answered what, and what the user is told.

use gaitway_session::{Effect, EntryState, ErrorCode, Event, FileId, Item, NamedFile, RequestId, Session};

use crate::cases::{FOX, MAN, start};
use crate::orders::in_every_order;
use crate::program::Content;
use crate::world::{Act, Due, World};

fn code_of(world: &World, request: u32) -> Option<ErrorCode> {
    world.answers[&RequestId(request)][0].as_ref().err().and_then(|failure| failure.code)
}

fn notices(world: &World) -> Vec<&str> {
    let mut notices = Vec::new();
    for effect in &world.told {
        if let Effect::Notify { text } = effect {
            notices.push(text.as_str());
        }
    }
    notices
}

#[test]
fn the_files_of_a_gltf_arrive_in_any_order() {
    const GLTF: Act = Act::Drop(&[("own.gltf", Content::Gltf(&["body.bin", "skin.png"]))]);
    const BODY: Act = Act::Drop(&[("body.bin", Content::Part)]);
    const SKIN: Act = Act::Drop(&[("skin.png", Content::Part)]);
    for acts in [[GLTF, BODY, SKIN], [SKIN, GLTF, BODY], [BODY, SKIN, GLTF]] {
        in_every_order(&start(), &acts, |world| {
            assert_eq!(world.models(), ["own.gltf"], "{acts:?}");
        });
    }
}

#[test]
fn files_of_another_model_are_not_taken_for_those_of_a_gltf() {
    let mut world = start();
    world.then(Act::Drop(&[("skin.png", Content::Part)]));
    world.then(FOX);
    world.then(Act::Drop(&[("own.gltf", Content::Gltf(&["skin.png"]))]));
    assert_eq!(world.models(), ["Fox.glb"]);
    assert_eq!(code_of(&world, 3), Some(ErrorCode::NotFound));
}

#[test]
fn files_that_a_gltf_lacks_join_it_after_another_model_was_opened() {
    const GLTF: Act = Act::Drop(&[("own.gltf", Content::Gltf(&["body.bin", "skin.png"]))]);
    const REST: Act = Act::Drop(&[("body.bin", Content::Part), ("skin.png", Content::Part)]);
    let mut world = start();
    world.then(GLTF).then(FOX).then(REST);
    assert_eq!(world.models(), ["own.gltf"]);
    world.then(FOX).then(Act::Drop(&[("other.png", Content::Part)]));
    assert_eq!(world.models(), ["Fox.glb"], "it belongs to neither");
}

#[test]
fn a_skeleton_joins_its_obj() {
    let mut world = start();
    world.then(Act::Drop(&[("Man.obj", Content::Model("man"))]));
    world.then(FOX).then(Act::Drop(&[("Man.skel", Content::Part)]));
    assert_eq!(world.models(), ["Man.obj"]);
}

#[test]
fn each_is_answered_whether_or_not_it_was_overtaken() {
    in_every_order(&start(), &[Act::Script("a.glb"), FOX, MAN], |world| {
        assert_eq!(world.answers[&RequestId(3)][0].as_ref().err(), None);
        for request in [1, 2] {
            assert!(matches!(code_of(world, request), None | Some(ErrorCode::Cancelled)), "{request}");
        }
    });
}

#[test]
fn the_user_is_told_of_what_was_overtaken() {
    let mut world = start();
    world.act(FOX);
    world.act(MAN);
    world.rest();
    assert_eq!(notices(&world), ["Fox.glb: something else was opened in the meantime."]);
}

#[test]
fn a_small_file_that_is_read_sooner_does_not_give_way_to_a_large_one() {
    let mut world = start();
    world.act(FOX);
    world.act(MAN);
    let last = world.due.iter().rposition(|due| matches!(due, Due::Read(_))).expect("it is read");
    world.happen(last);
    world.rest();
    assert_eq!(world.models(), ["Man.glb"]);
}

#[test]
fn a_damaged_file_changes_nothing() {
    in_every_order(&start(), &[Act::Drop(&[("bad.glb", Content::Damaged)])], |world| {
        assert_eq!((world.models(), world.addresses()), (vec!["walker".to_owned()], vec!["model=walker"]));
        assert_eq!(code_of(world, 1), Some(ErrorCode::Malformed));
        assert!(world.told.contains(&Effect::SayProblem { message: "bad.glb: damaged".to_owned() }));
    });
}

/// The program never learns of it, so the page shows the error.
#[test]
fn a_file_that_cannot_be_read_is_refused_by_the_page() {
    let mut world = start();
    world.moved_files.push("Fox.glb");
    in_every_order(&world, &[FOX], |world| {
        assert_eq!(code_of(world, 1), Some(ErrorCode::NotFound));
        assert!(world.told.contains(&Effect::Refuse { message: "Fox.glb: the browser can't read it".to_owned() }));
    });
}

#[test]
fn light_and_map_are_no_models() {
    let mut world = start();
    world.then(Act::Drop(&[("beach.hdr", Content::Light)])).then(Act::Drop(&[("map.json", Content::Map)]));
    assert_eq!(world.models(), ["walker"]);
    assert_eq!(world.address(), "model=walker&light=file:beach.hdr");
}

#[test]
fn files_that_came_with_the_page_are_found_by_the_names_in_its_link() {
    let named = |id, name: &str| Item::File(NamedFile { id: FileId(id), name: name.to_owned() });
    let (fox, walk) = (named(1, "Fox.glb"), named(2, "walk.bvh"));
    // As it was saved, and as the address has it after a change.
    for link in ["model=Fox.glb&motion=walk.bvh&t=1", "model=file:Fox.glb&motion=file:walk.bvh&t=1"] {
        let mut session = Session::new(link.into(), EntryState::default());
        for items in [vec![fox.clone()], vec![walk.clone()]] {
            assert_eq!(session.handle(Event::Hold { items }, None), []);
        }
        session.handle(Event::Launch, None);
        let effects = session.handle(Event::Loaded, None);
        let link = "model=Fox.glb&motion=walk.bvh&t=1".into();
        let run = Effect::Run { link, model: vec![fox.clone()], motion: vec![walk.clone()], is_private: false };
        assert!(effects.contains(&run), "{effects:?}");
        assert!(!session.facts().is_private);
    }
}
