//! What texts of links mean: as documented, in early versions, and with errors.

use gaitway_retarget::{Chains, ClipRef, Contacts, Feet, PathOrigin, RootOptions, RootPart, Unmapped};
use gaitway_scene::state::{
    Background, CameraChoice, CharacterView, ClipChoice, Display, EnvironmentChoice, LinkError, MotionMap, OrbitCamera,
    Playback, Playhead, RetargetEdits, Selection, Show, ViewerState, from_link,
};
use glam::Vec3;

use crate::link::some_maps;
use crate::texts::{link_of, object_of, with_keys};

fn check_read(link: &str, expected: ViewerState) {
    let (state, errors) = from_link(link);
    assert_eq!(errors, [], "{link}");
    assert_eq!(state, expected, "{link}");
}

fn check_bad(link: &str, key: &str) {
    let (state, errors) = from_link(link);
    assert!(matches!(&errors[..], [LinkError::BadValue { key: bad, .. }] if bad == key), "{link}: {errors:?}");
    assert_eq!(state, ViewerState::default(), "{link}");
}

#[test]
fn links_read_as_documented() {
    let default = ViewerState::default();
    let with_character = |change: &dyn Fn(&mut CharacterView)| {
        let mut state = default.clone();
        change(&mut state.character);
        state
    };
    check_read("", default.clone());
    check_read("#v=1&clip=", with_character(&|character| character.playhead.clip = ClipChoice::RestPose));
    check_read("clip=Run", with_character(&|character| character.playhead.clip = ClipChoice::called("Run")));
    let at_half = with_character(&|character| character.playhead.time_secs = 0.5);
    check_read("t=0.5&play=0", ViewerState { playback: Playback { playing: false, ..default.playback }, ..at_half });
    check_read("camera=gltf:1", ViewerState { camera: CameraChoice::File(1), ..default.clone() });
    let walker = with_character(&|character| character.sources.model = vec!["sample:walker".to_owned()]);
    check_read("model=sample%3Awalker", walker);
    check_read(
        "background=%23ff8000",
        ViewerState {
            display: Display { background: Background::Color([255, 128, 0]), ..default.display },
            ..default.clone()
        },
    );
    let skeleton = Show { skeleton: true, grid: false, ..Show::default() };
    check_read(
        "show=skeleton",
        ViewerState { display: Display { show: skeleton, ..default.display }, ..default.clone() },
    );
    let orbit = OrbitCamera {
        yaw_radians: std::f32::consts::FRAC_PI_2,
        pitch_radians: 0.0,
        distance: 4.0,
        target: Vec3::new(0.0, 1.0, 0.0),
    };
    check_read("camera=90,0,4,0,1,0", ViewerState { camera: CameraChoice::Orbit(orbit), ..default });
}

#[test]
fn an_unknown_version_is_reported_and_read_as_the_current_one() {
    check_bad("v=3", "v");
    check_bad("v=", "v");
    let motion_plays = |link: &str| from_link(link).0.character.playhead.clip == ClipChoice::FirstOfMotions;
    assert!(motion_plays("v=3&motion=walk.bvh"));
    assert!(!motion_plays("v=1&motion=walk.bvh"));
}

#[test]
fn an_object_without_a_version_is_of_the_current_one() {
    let clip = |partial| {
        let (state, errors) = with_keys(&ViewerState::default(), &partial);
        assert_eq!(errors, []);
        object_of(&state)["clip"].clone()
    };
    assert_eq!(clip(serde_json::json!({ "motion": ["walk.bvh"] })), serde_json::Value::Null);
    assert_eq!(clip(serde_json::json!({ "v": 2, "motion": ["walk.bvh"], "clip": null })), serde_json::Value::Null);
    assert_eq!(clip(serde_json::json!({ "v": 1, "motion": ["walk.bvh"] })), "0");
    assert_eq!(clip(serde_json::json!({ "v": null, "motion": ["walk.bvh"], "clip": "" })), "");
}

#[test]
fn invalid_names_and_vertices_are_reported() {
    check_bad("names=3", "names");
    check_bad("names=3:", "names");
    check_bad("names=3: ", "names");
    check_bad("names=x:Hand", "names");
    check_bad("names=3:two%0Alines", "names");
    check_bad("vertex=1:2", "vertex");
    check_bad("vertex=1:2:3:4", "vertex");
    check_bad("vertex=0:0:-1", "vertex");
}

/// Old links depend on the text form of a plain map.
#[test]
fn a_plain_map_is_short_and_readable() {
    let maps = some_maps();
    let state = ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map: maps[1..2].to_vec(), ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    assert_eq!(link_of(&state), "v=2&map=1.ffffffff.0-5,1-");
    check_read("map=1.ffffffff.1-,0-5", state.clone());
    // Any other text is the URL of a file.
    let of_file = |url: &str| ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map: vec![MotionMap::File(url.to_owned())], ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    check_read("map=2.json", of_file("2.json"));
    // So does one as Gaitway proposes it.
    let with = |root: RootOptions| {
        let mut other = state.clone();
        let [MotionMap::Numbers(numbered)] = &mut other.character.retarget.map[..] else { panic!("a map by numbers") };
        numbered.map.root = root;
        other
    };
    let proposed = RootOptions { origin: PathOrigin::Feet, ..RootOptions::default() };
    assert_eq!(link_of(&with(proposed)), "v=2&map=2.ffffffff.0-5,1-");
    let edited = with(RootOptions { yaw: RootPart::Freeze, ..proposed });
    check_read(&link_of(&edited), edited);
    let sharing = |root: RootOptions| {
        let mut other = with(root);
        let [MotionMap::Numbers(numbered)] = &mut other.character.retarget.map[..] else { panic!("a map by numbers") };
        numbered.map.chains = Chains::Share;
        other
    };
    assert_eq!(link_of(&sharing(proposed)), "v=2&map=3.ffffffff.0-5,1-");
    for root in [proposed, RootOptions::default(), RootOptions { yaw: RootPart::Freeze, ..proposed }] {
        check_read(&link_of(&sharing(root)), sharing(root));
    }
    check_read("map=3.json", of_file("3.json"));
}

#[test]
fn parts_of_a_map_are_easy_to_write_manually() {
    let default = ViewerState::default();
    let root = |root| ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { root: Some(root), ..default.character.retarget.clone() },
            ..default.clone().character
        },
        ..default.clone()
    };
    check_read("root=in-place", root(RootOptions { horizontal: RootPart::InPlace, ..RootOptions::default() }));
    check_read("root=keep", root(RootOptions::default()));
    let both = RootOptions { yaw: RootPart::Freeze, extract: true, ..RootOptions::default() };
    check_read("root=yaw:freeze,extract", root(both));
    let at_feet = RootOptions { horizontal: RootPart::InPlace, origin: PathOrigin::Feet, ..RootOptions::default() };
    check_read("root=in-place,origin:feet", root(at_feet));
    let clip = |clip, frozen| ViewerState {
        character: CharacterView {
            retarget: RetargetEdits {
                unmapped: Some(Unmapped::Clip { clip, frozen }),
                ..default.character.retarget.clone()
            },
            ..default.clone().character
        },
        ..default.clone()
    };
    check_read("unmapped=clip:0", clip(ClipRef::Index(0), false));
    check_read("unmapped=first-key:Idle", clip(ClipRef::Name("Idle".to_owned()), true));
    check_read(
        "unmapped=rest",
        ViewerState {
            character: CharacterView {
                retarget: RetargetEdits { unmapped: Some(Unmapped::Rest), ..default.character.retarget.clone() },
                ..default.clone().character
            },
            ..default.clone()
        },
    );
    check_read(
        "feet=off",
        ViewerState {
            character: CharacterView {
                retarget: RetargetEdits { feet: Some(Feet::Off), ..default.character.retarget.clone() },
                ..default.clone().character
            },
            ..default.clone()
        },
    );
    check_read(
        "contacts=keep",
        ViewerState {
            character: CharacterView {
                retarget: RetargetEdits { contacts: Some(Contacts::Keep), ..default.character.retarget },
                ..default.character
            },
            ..default
        },
    );
}

#[test]
fn bad_values_are_reported_and_skipped() {
    check_bad("model=", "model");
    check_bad("motion=", "motion");
    check_bad("t=soon", "t");
    check_bad("t=inf", "t");
    check_bad("play=yes", "play");
    check_bad("speed=NaN", "speed");
    check_bad("loop=twice", "loop");
    check_bad("range=2,1", "range");
    check_bad("range=2", "range");
    check_bad("skinning=soft", "skinning");
    check_bad("morph=0", "morph");
    check_bad("camera=1,2,3", "camera");
    check_bad("camera=0,0,0,0,0,0", "camera");
    check_bad("camera=gltf:-1", "camera");
    check_bad("camera=1e60,10,4,0,1,0", "camera");
    check_bad("joint=hips", "joint");
    check_bad("up=w", "up");
    check_bad("background=12345", "background");
    check_bad("background=+12345", "background");
    for map in ["", "1.", "1.abc.", "1.ffffffff.1", "1.ffffffff.1-x", "1.ffffffff.1-2,1-3", "1.ffffffff..%%%", "{}"] {
        check_bad(&format!("map={map}"), "map");
    }
    check_bad("unmapped=walk", "unmapped");
    check_bad("root=fly", "root");
    check_bad("root=", "root");
    check_bad("feet=bare", "feet");
    check_bad("contacts=plant", "contacts");
    check_bad("pose=3:1:2", "pose");
    check_bad("pose=3:1:2:3:4", "pose");
    check_bad("pose=hips:1:2:3", "pose");
    check_bad("turntable=fast", "turntable");
    check_bad("change=Walk:jump", "change");
}

#[test]
fn a_trim_that_keeps_nothing_is_refused() {
    for bad in ["5:1", "1:1", "-2:-1"] {
        let link = format!("change=Walk:reverse,trim:{bad}");
        check_bad(&link, "change");
        let told = format!("{link}: expected trim:START:END in seconds, the end after the start");
        assert_eq!(from_link(&link).1[0].to_string(), told);
    }
    let (same, errors) = with_keys(&ViewerState::default(), &serde_json::json!({ "change": ["Walk:trim:5:1"] }));
    assert_eq!((same, errors.len()), (ViewerState::default(), 1));
    check_bad("change=Walk:trim:5", "change");
}

#[test]
fn a_light_is_a_file_only_if_it_looks_like_one() {
    for bad in ["studoi", "", "Studio", "hdr"] {
        check_bad(&format!("light={bad}"), "light");
    }
    let told = from_link("light=studoi").1[0].to_string();
    assert_eq!(told, "light=studoi: expected studio, white, soft, hard, outdoor or an .hdr image");
    for file in ["beach.HDR", "lights/beach", "file:beach", "https://example.org/light?id=4", "blob:1234"] {
        let mut expected = ViewerState::default();
        expected.lighting.environment = EnvironmentChoice::File(file.to_owned());
        check_read(&format!("light={file}"), expected);
    }
}

#[test]
fn unknown_keys_are_kept() {
    let link = "v=2&show=skeleton,fur&crowd=b&crowd=c&zoo=1%262";
    let (state, errors) = from_link(link);
    assert_eq!(errors.len(), 4, "{errors:?}");
    assert!(state.display.show.skeleton);
    assert_eq!(link_of(&state), link);
    // A line break does not separate values.
    let (state, _) = from_link("v=1&foo=a%0Ab");
    assert_eq!(link_of(&state), "v=2&foo=a%0Ab");
    assert_eq!(object_of(&state)["foo"], "a\nb");
}

#[test]
fn an_object_changes_only_its_keys() {
    let base = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 2.0, ..Playhead::default() },
            ..CharacterView::default()
        },
        playback: Playback { speed: 2.0, ..Playback::default() },
        selection: Selection { joint: Some(4), ..Selection::default() },
        ..ViewerState::default()
    };
    let partial =
        serde_json::json!({ "t": 0.5, "play": false, "camera": [90, 0, 4, 0, 1, 0], "joint": null, "clip": "" });
    let (state, errors) = with_keys(&base, &partial);
    assert_eq!(errors, []);
    let (camera, _) = from_link("camera=90,0,4,0,1,0");
    let expected = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.5, clip: ClipChoice::RestPose, ..base.character.playhead },
            ..base.character
        },
        camera: camera.camera,
        playback: Playback { playing: false, ..base.playback },
        selection: Selection { joint: None, ..base.selection },
        ..base
    };
    assert_eq!(state, expected);
    let (same, errors) = with_keys(&state, &serde_json::json!("t=1"));
    assert_eq!((same, errors.len()), (state, 1));
}

#[test]
fn an_early_link_to_a_model_in_an_archive_keeps_working() {
    let (state, errors) = from_link("v=1&model=https://example.org/two.zip%23/in/fox.glb");
    assert_eq!(state.character.sources.model, ["https://example.org/two.zip#!/in/fox.glb"]);
    assert!(errors.is_empty(), "{errors:?}");
    let (state, _) = from_link("v=1&model=https://example.org/two.zip%23!/in/fox.glb&model=fox.glb%23/b");
    assert_eq!(state.character.sources.model, ["https://example.org/two.zip#!/in/fox.glb", "fox.glb#/b"]);
}
