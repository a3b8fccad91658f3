//! The text form of a view: every state round-trips.

use gaitway_scene::library::{ClipCopy, ClipId, CopyId, LayeredClip, LookTarget};
use std::collections::{BTreeMap, BTreeSet};

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{
    BodyPart, Chains, ClipChanges, ClipLayer, ClipRef, Contacts, Feet, JointMap, JointMapFile, LayerMask, LayerMode,
    MapEntry, MutedChannel, PathOrigin, Pin, PinGoal, PinTimes, RestChoice, RestChoices, RootOptions, RootPart,
    SourceRef, Unmapped, UpChoice,
};
use gaitway_scene::state::{
    Background, CameraChoice, Channel, CharacterView, ClipChoice, Display, Embed, EnvironmentChoice, Fade, Hidden,
    KeyLight, LinkError, MotionMap, NumberedMap, OrbitCamera, Playback, Playhead, RetargetEdits, Selection, Show,
    ToneMap, UpAxis, VertexChoice, ViewerState, from_link,
};
use glam::Vec3;

use crate::random::Random;
use crate::texts::{link_of, object_of, with_keys};

fn check_round_trip(state: &ViewerState) {
    let link = link_of(state);
    let (back, errors) = from_link(&link);
    let known = |error: &&LinkError| matches!(error, LinkError::BadValue { .. });
    assert_eq!(errors.iter().find(known), None, "{link}");
    assert_eq!(&back, state, "{link}");
    assert_eq!(link_of(&back), link);
    let (back, errors) = with_keys(&ViewerState::default(), &object_of(state));
    assert_eq!(errors.iter().find(known), None, "{}", object_of(state));
    assert_eq!(&back, state, "{}", object_of(state));
}

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

/// One map of each kind, with every member set.
fn some_maps() -> Vec<MotionMap> {
    let entry = MapEntry::following;
    let frozen = Unmapped::Clip { clip: ClipRef::Index(2), frozen: true };
    let full = JointMap {
        joints: BTreeMap::from([
            (3, entry(Some(14))),
            (12, entry(Some(0))),
            (7, entry(None)),
            (8, MapEntry { correction: glam::Quat::from_rotation_x(0.3), unmapped: Some(frozen), ..entry(None) }),
        ]),
        unmapped: Unmapped::Clip { clip: ClipRef::Name("Idle & more".to_owned()), frozen: false },
        rest: RestChoices { model: RestChoice::Bind, motion: RestChoice::FirstFrame, up: UpChoice::Z },
        root: RootOptions { vertical: RootPart::Freeze, ..RootOptions::default() },
        muted_channels: vec![MutedChannel { source: 4, property: None }],
        feet: Feet::Plant,
        contacts: Contacts::Keep,
        crossfade_secs: 0.25,
        ..JointMap::default()
    };
    let plain = JointMap { joints: BTreeMap::from([(0, entry(Some(5))), (1, entry(None))]), ..JointMap::default() };
    let by_name = JointMapFile {
        joints: BTreeMap::from([("Hüfte".to_owned(), MapEntry::following(Some(SourceRef::Name("hip".to_owned()))))]),
        ..JointMapFile::default()
    };
    vec![
        MotionMap::Numbers(NumberedMap { checksum: 0x00c0_ffee, map: full }),
        MotionMap::Numbers(NumberedMap { checksum: u32::MAX, map: plain }),
        MotionMap::of_file(&by_name),
        MotionMap::File("maps/knight.json".to_owned()),
    ]
}

/// States that differ from the default in one field each, with the field's name.
#[expect(clippy::too_many_lines, reason = "a table")]
fn one_field_each() -> Vec<(&'static str, ViewerState)> {
    let orbit =
        OrbitCamera { yaw_radians: 0.7, pitch_radians: -0.3, distance: 2.5, target: Vec3::new(0.1, -2.0, 3e-5) };
    let with = |change: &dyn Fn(&mut ViewerState)| {
        let mut state = ViewerState::default();
        change(&mut state);
        state
    };
    vec![
        (
            "character.sources.model",
            with(&|state| {
                state.character.sources.model =
                    vec!["https://host/a b.glb?x=1&y=2".to_owned(), "sample:walker".to_owned()]
            }),
        ),
        (
            "character.sources.motion",
            with(&|state| {
                state.character.sources.motion = vec!["walk.bvh".to_owned(), "https://host/run.glb?a=1".to_owned()];
                state.character.playhead.clip = ClipChoice::FirstOfMotions;
            }),
        ),
        ("character.retarget.map", with(&|state| state.character.retarget.map = some_maps())),
        (
            "character.retarget.unmapped",
            with(&|state| {
                state.character.retarget.unmapped =
                    Some(Unmapped::Clip { clip: ClipRef::Name("7".to_owned()), frozen: true });
            }),
        ),
        (
            "character.retarget.root",
            with(&|state| {
                let (horizontal, yaw) = (RootPart::InPlace, RootPart::Freeze);
                state.character.retarget.root =
                    Some(RootOptions { horizontal, yaw, extract: true, ..RootOptions::default() });
            }),
        ),
        ("character.retarget.feet", with(&|state| state.character.retarget.feet = Some(Feet::Plant))),
        ("character.retarget.contacts", with(&|state| state.character.retarget.contacts = Some(Contacts::Keep))),
        ("character.sources.scene", with(&|state| state.character.sources.scene = Some(2))),
        (
            "character.playhead.clip",
            with(&|state| state.character.playhead.clip = ClipChoice::called("Walk & run = 100 %")),
        ),
        ("character.playhead.time_secs", with(&|state| state.character.playhead.time_secs = 1.0 / 3.0)),
        (
            "character.playhead.fade",
            with(&|state| {
                let clip = ClipChoice::called("Walk, slow");
                state.character.playhead.fade = Some(Fade { clip, time_secs: 1.0 / 3.0, elapsed_secs: 0.1 });
            }),
        ),
        ("playback.playing", with(&|state| state.playback.playing = false)),
        ("playback.speed", with(&|state| state.playback.speed = 0.1)),
        ("playback.loop_mode", with(&|state| state.playback.loop_mode = LoopMode::PingPong)),
        (
            "character.playhead.range",
            with(&|state| state.character.playhead.range = Some(TimeRange { start_secs: 0.25, end_secs: 1.1 })),
        ),
        ("display.skinning", with(&|state| state.display.skinning = SkinningMode::DualQuaternion)),
        (
            "character.edits.hidden",
            with(&|state| {
                let (nodes, materials) = (BTreeSet::from([3, 12]), BTreeSet::from([None, Some(0)]));
                state.character.edits.hidden = Hidden { nodes, materials };
            }),
        ),
        (
            "character.edits.expressions",
            with(&|state| state.character.edits.expressions = BTreeMap::from([("a b,:".to_owned(), 0.5)])),
        ),
        ("display.look_at", with(&|state| state.display.look_at = LookTarget::Camera)),
        ("display.channel", with(&|state| state.display.channel = Channel::VertexColor)),
        ("display.springs", with(&|state| state.display.springs = true)),
        ("character.edits.morph", with(&|state| state.character.edits.morph = BTreeMap::from([(0, 0.3), (12, -1.0)]))),
        (
            "character.edits.pose",
            with(&|state| {
                state.character.edits.pose = BTreeMap::from([(3, [30.5, 0.0, -179.9]), (12, [0.0, 1.0 / 3.0, 0.0])])
            }),
        ),
        (
            "character.edits.pins",
            with(&|state| {
                let times = Some(PinTimes { start_secs: 0.25, end_secs: 1.0 / 3.0, blend_secs: 0.1 });
                let at = Vec3::new(0.1, -1.0 / 3.0, 2e-7);
                let goals = [PinGoal::Point(at), PinGoal::Joint(4, at), PinGoal::Look(at), PinGoal::Camera];
                let pins = (3..)
                    .zip(goals)
                    .map(|(joint, goal)| (joint, Pin { goal, times: times.filter(|_| joint % 2 == 0) }));
                state.character.edits.pins = pins.collect();
            }),
        ),
        (
            "character.edits.clips",
            with(&|state| {
                let trim = Some(TimeRange { start_secs: 0.25, end_secs: 1.5 });
                let all = ClipChanges {
                    mirror: true,
                    trim,
                    reverse: true,
                    speed: 1.5,
                    loop_secs: Some(0.2),
                    offset: [1.0, -0.5],
                    turn_degrees: 90.0,
                };
                let mirrored = ClipChanges { mirror: true, ..ClipChanges::default() };
                let looped = ClipChanges { loop_secs: Some(0.0), ..ClipChanges::default() };
                let clips = [("Walk: fast, 100 % & more", all), ("3", mirrored), ("歩", looped)];
                let clips = clips.into_iter().map(|(clip, changes)| (ClipId::called(clip), changes));
                state.character.edits.clips.changes = clips.collect();
                for (at, (name, of)) in (0..).zip([("Walk: 50 % & more", "Walk"), ("a", "2")]) {
                    state.character.edits.clips.copies.push(ClipCopy { id: CopyId(at), of: ClipId::called(of) });
                    state.character.edits.clips.names.insert(ClipId::Copy(CopyId(at)), name.to_owned());
                }
                state.character.edits.clips.names.insert(ClipId::called("Run: 1"), "Läufer, 2:1".to_owned());
            }),
        ),
        (
            "character.edits.layers",
            with(&|state| {
                let mut mask = LayerMask::of_parts(&[BodyPart::Head, BodyPart::LeftArm]);
                mask.joints.extend([4, 17]);
                let (mode, weight) = (LayerMode::AdditiveToRest, 1.0 / 3.0);
                let over = |clip, layer| LayeredClip { clip: ClipId::called(clip), layer };
                let all = ClipLayer { weight, speed: 0.5, start_secs: -0.1, mode, mask };
                let sum = ClipLayer { mode: LayerMode::Additive, ..ClipLayer::default() };
                let layers = [("a: b, c", all), ("歩 50 % & more", ClipLayer::default()), ("歩 50 % & more", sum)];
                state.character.edits.layers = layers.map(|(clip, layer)| over(clip, layer)).to_vec();
            }),
        ),
        (
            "character.edits.names",
            with(&|state| {
                let names = [(0, "Hips"), (3, "left: knee, 100 % & more"), (12, "ümläut 歩")];
                state.character.edits.names = names.into_iter().map(|(joint, name)| (joint, name.to_owned())).collect();
            }),
        ),
        (
            "display.show",
            with(&|state| {
                let overlays = Show { skeleton: true, mesh: false, grid: false, ..Show::default() };
                let overlays = Show { boxes: true, controls: true, smooth: true, ..overlays };
                state.display.show = Show { source: true, over: true, error: true, ..overlays };
            }),
        ),
        ("inspect.weights", with(&|state| state.inspect.weights = true)),
        ("inspect.split", with(&|state| state.inspect.split = true)),
        ("inspect.rests", with(&|state| state.inspect.rests = true)),
        ("selection.joint", with(&|state| state.selection.joint = Some(0))),
        (
            "selection.vertex",
            with(&|state| state.selection.vertex = Some(VertexChoice { instance: 0, primitive: 1, vertex: 13335 })),
        ),
        ("camera", with(&|state| state.camera = CameraChoice::Orbit(orbit))),
        ("camera_options.fov_degrees", with(&|state| state.camera_options.fov_degrees = 50.0)),
        ("camera_options.follow", with(&|state| state.camera_options.follow = true)),
        ("camera_options.turntable", with(&|state| state.camera_options.turntable = -12.5)),
        (
            "character.edits.variant",
            with(&|state| state.character.edits.variant = Some("Midnight & blue, 100 %".to_owned())),
        ),
        ("character.edits.up", with(&|state| state.character.edits.up = UpAxis::MinusZ)),
        ("display.exposure", with(&|state| state.display.exposure = -0.7)),
        ("display.tone_map", with(&|state| state.display.tone_map = ToneMap::Agx)),
        ("display.environment_degrees", with(&|state| state.display.environment_degrees = 123.4)),
        (
            "lighting.environment",
            with(&|state| {
                state.lighting.environment = EnvironmentChoice::File("https://example.org/a b.hdr".to_owned())
            }),
        ),
        (
            "lighting.key",
            with(&|state| {
                state.lighting.key = Some(KeyLight { strength: 0.3, yaw_degrees: -44.5, pitch_degrees: 1.0 / 3.0 });
            }),
        ),
        ("display.background", with(&|state| state.display.background = Background::Color([0, 128, 255]))),
        ("page.embed", with(&|state| state.page.embed = Embed::Transport)),
        (
            "page.unknown",
            with(&|state| {
                let values = vec!["3:x\n4:y".to_owned(), "5:z".to_owned()];
                state.page.unknown = BTreeMap::from([("zoo".to_owned(), values)]);
            }),
        ),
    ]
}

/// The path of each field in the state: group and name. The camera is both a group and a field, and the character has groups of its
/// own.
fn fields() -> Vec<String> {
    let state = serde_json::to_value(ViewerState::default()).expect("plain data");
    let groups = state.as_object().expect("a struct").iter();
    groups.flat_map(|(group, value)| fields_of(group, value, if group == "character" { 2 } else { 1 })).collect()
}

fn fields_of(path: &str, value: &serde_json::Value, levels: usize) -> Vec<String> {
    match value.as_object().filter(|_| levels > 0) {
        Some(fields) => {
            fields.iter().flat_map(|(field, value)| fields_of(&format!("{path}.{field}"), value, levels - 1)).collect()
        }
        None => vec![path.to_owned()],
    }
}

#[test]
fn every_field_of_the_state_has_a_key() {
    let changed = one_field_each();
    let fields: BTreeSet<String> = fields().into_iter().collect();
    assert_eq!(changed.iter().map(|(field, _)| (*field).to_owned()).collect::<BTreeSet<_>>(), fields);
    for (field, state) in &changed {
        assert_ne!(link_of(state), link_of(&ViewerState::default()), "{field} is not in the link");
        check_round_trip(state);
    }
}

#[test]
fn all_fields_at_once_round_trip() {
    let mut all = serde_json::to_value(ViewerState::default()).expect("plain data");
    for (field, state) in one_field_each() {
        let pointer = format!("/{}", field.replace('.', "/"));
        let changed = serde_json::to_value(&state).expect("plain data");
        *all.pointer_mut(&pointer).expect("the same fields") = changed.pointer(&pointer).expect("there").clone();
    }
    check_round_trip(&serde_json::from_value(all).expect("the same fields"));
}

#[test]
fn any_camera_round_trips_exactly() {
    let mut random = Random(1);
    let mut next = |scale: f32| scale * (2.0 * random.f32() - 1.0);
    for _ in 0..500 {
        let camera = OrbitCamera {
            yaw_radians: next(std::f32::consts::PI),
            pitch_radians: next(1.56),
            distance: next(3.0).exp(),
            target: Vec3::new(next(10.0), next(1e-4), next(1e4)),
        };
        let time_secs = f64::from(next(100.0)) / 3.0;
        check_round_trip(&ViewerState {
            character: CharacterView {
                playhead: Playhead { time_secs, ..Playhead::default() },
                ..CharacterView::default()
            },
            camera: CameraChoice::Orbit(camera),
            ..ViewerState::default()
        });
    }
}

#[test]
fn defaults_are_left_out() {
    assert_eq!(link_of(&ViewerState::default()), "v=2");
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
