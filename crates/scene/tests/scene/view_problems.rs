//! What a view asks for that its model can't show, one key at a time.

use gaitway_scene::library::{ClipEdits, ClipId, Library};
use gaitway_scene::state::{from_link, view_problems};

use crate::data::walker;

/// Checks the problems of a link for the walker.
fn check(library: &Library, link: &str, expected: &[&str]) {
    let (view, errors) = from_link(link);
    assert_eq!(errors, [], "{link}");
    let problems = view_problems(&view, library.active());
    assert_eq!(problems.iter().map(ToString::to_string).collect::<Vec<_>>(), expected, "{link}");
    let keys: Vec<&str> = link.split('&').map(|pair| pair.split('=').next().unwrap_or_default()).collect();
    assert!(problems.iter().all(|problem| keys.contains(&problem.key())), "{link}: {problems:?}");
}

#[test]
fn numbers_out_of_range_are_told_with_what_is_used() {
    let library = walker();
    for (link, expected) in [
        ("speed=9", "speed=9: expected a factor from 0.1 to 4; 4 is used"),
        ("speed=-0.25", "speed=-0.25: expected a factor from 0.1 to 4; 0.1 is used"),
        ("fov=3", "fov=3: expected degrees from 5 to 120; 5 is used"),
        ("exposure=20", "exposure=20: expected stops from -10 to 10; 10 is used"),
        ("turntable=720", "turntable=720: expected degrees per second from -360 to 360; 360 is used"),
        ("t=-1", "t=-1: expected seconds from 0 on; 0 is used"),
        (
            "key=99,0,45",
            "key=99,0,45: expected STRENGTH,YAW,PITCH: 0 to 10, and the angles in degrees; 10,0,45 is used",
        ),
    ] {
        check(&library, link, &[expected]);
    }
    let speed = "change=Walk:speed:50: expected a clip and its changes: \
                 Walk:trim:0.5:1.5,reverse,speed:2,loop:0.2,offset:1:0,turn:90; the speed is from 0.1 to 10; \
                 Walk:speed:10 is used";
    check(&library, "change=Walk:speed:50&change=Idle:speed:2", &[speed]);
    // The same angle, written otherwise.
    check(&library, "environment=400&pose=4:270:0:0&camera=270,10,4,0,1,0", &[]);
    check(&library, "speed=4&fov=5&exposure=-10&t=0.5&range=0.1,0.2&play=0&hidden=2&joint=3&pin=9:at:0,1,0", &[]);
}

#[test]
fn what_the_model_lacks_is_told() {
    let library = walker();
    let model = library.active();
    for (link, used) in [
        ("joint=999", "it is left out"),
        ("pose=3:1:2:3,77:1:2:3,78:0:0:1", "3:1:2:3 is used"),
        ("names=77:Tail", "it is left out"),
        ("layers=Wave:mask:3:77", "Wave:mask:3 is used"),
        ("hidden=2,77,m99", "2 is used"),
        ("pin=9:joint:77,0,0,0", "it is left out"),
        ("pin=77:look:camera", "it is left out"),
        // Not the end of two bones.
        ("pin=1:at:0,1,0", "it is left out"),
        ("morph=0:1,3:1", "0:1 is used"),
        ("camera=gltf:1", "auto is used"),
        ("vertex=5:0:1", "it is left out"),
        ("vertex=0:0:9999999", "it is left out"),
        ("scene=9", "it is left out"),
    ] {
        let (view, errors) = from_link(link);
        assert_eq!(errors, [], "{link}");
        let problems: Vec<String> = view_problems(&view, model).iter().map(ToString::to_string).collect();
        assert_eq!(problems.len(), 1, "{link}: {problems:?}");
        assert!(problems[0].starts_with(&format!("{link}: expected ")), "{problems:?}");
        assert!(problems[0].ends_with(&format!("; this model can't show it, so {used}")), "{problems:?}");
    }
}

#[test]
fn names_that_the_model_lacks_are_told_with_those_it_has() {
    let library = walker();
    let clip = "expected the name or index of a clip, found “Fly”; its clips are “Walk”, “Idle”, “Wave”";
    check(&library, "clip=Fly", &[&format!("clip: {clip}; the rest pose is used")]);
    check(&library, "mirror=Fly", &[&format!("mirror: {clip}; it is left out")]);
    check(&library, "change=Fly:reverse", &[&format!("change: {clip}; it is left out")]);
    let layer = format!("layers: {clip}; the layer is left out");
    check(&library, "layers=Fly&layers=Wave&layers=Fly:weight:0.5", &[&layer, &layer]);
    let expression =
        "expression: expected the name of an expression, found “grin”; there are no expressions; it is left out";
    check(&library, "expression=grin:1", &[expression]);
}

#[test]
fn clips_are_listed_as_links_call_them_whatever_they_are_renamed_to() {
    let mut library = walker();
    let renamed = [(ClipId::Own(0), "Stroll".to_owned())].into();
    library.edit_clips(&ClipEdits { names: renamed, ..ClipEdits::default() });
    let clip = "expected the name or index of a clip, found “Stroll!”; its clips are “Walk”, “Idle”, “Wave”";
    for key in ["rename", "change", "copy"] {
        let value = match key {
            "rename" => "Stroll!:March",
            "change" => "Stroll!:reverse",
            _ => "March:Stroll!",
        };
        check(&library, &format!("{key}={value}"), &[&format!("{key}: {clip}; it is left out")]);
    }
}

#[test]
fn a_trim_after_the_end_is_told() {
    let library = walker();
    let (view, _) = from_link("change=Walk:trim:50:60");
    let told = view_problems(&view, library.active()).iter().map(ToString::to_string).collect::<String>();
    assert!(told.starts_with("change=Walk:trim:50:60: expected a start within the clip; it ends at "), "{told}");
    check(&library, "change=Walk:trim:0.1:60", &[]);
}

/// Names and indices wait for the model.
#[test]
fn without_a_model_only_ranges_are_checked() {
    let (view, _) = from_link("joint=999&clip=Fly&fov=1");
    let keys = |model| view_problems(&view, model).iter().map(|problem| problem.key().to_owned()).collect::<Vec<_>>();
    assert_eq!(keys(None), ["fov"]);
    assert_eq!(keys(Some(&gaitway_scene::library::Model::placeholder("file:fox.glb"))), ["fov"]);
}
