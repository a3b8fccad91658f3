//! The text form of a view: every state round-trips.

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{
    BodyPart, ClipChanges, ClipLayer, ClipRef, Contacts, Feet, JointMap, JointMapFile, LayerMask, LayerMode, MapEntry,
    MutedChannel, Pin, PinGoal, PinTimes, RestChoice, RestChoices, RootOptions, RootPart, SourceRef, Unmapped,
    UpChoice,
};
use gaitway_scene::library::{ClipCopy, ClipId, CopyId, LayeredClip, LookTarget};
use gaitway_scene::state::{
    Background, CameraChoice, Channel, CharacterView, ClipChoice, Embed, EnvironmentChoice, Fade, Hidden, KeyLight,
    LinkError, MotionMap, NumberedMap, OrbitCamera, Playhead, Show, ToneMap, UpAxis, VertexChoice, ViewerState,
    from_link,
};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

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

/// One map of each kind, with every member set.
pub fn some_maps() -> Vec<MotionMap> {
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
