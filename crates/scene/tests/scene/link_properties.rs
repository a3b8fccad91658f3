//! Properties of all links: old ones keep their meaning, every state round-trips, and any text becomes a stable link of
//! its valid parts.

use gaitway_scene::library::{ClipCopy, ClipEdits, ClipId, CopyId, LayeredClip, LookTarget};
use std::collections::{BTreeMap, BTreeSet};

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{
    BodyPart, Chains, ClipChanges, ClipLayer, ClipRef, Contacts, Feet, JointMap, LayerMask, LayerMode, MapEntry,
    PathOrigin, Pin, PinGoal, PinTimes, RootOptions, RootPart, Unmapped,
};
use gaitway_scene::state::{
    Background, CameraChoice, CameraOptions, Channel, CharacterView, ClipChoice, Embed, EnvironmentChoice, Fade,
    Hidden, Inspect, KeyLight, LightSetup, LinkError, MotionMap, NumberedMap, OrbitCamera, RetargetEdits, Show,
    ToneMap, UpAxis, VertexChoice, ViewerState, from_link,
};
use glam::{Quat, Vec3};
use serde_json::Value;

use crate::random::Random;
use crate::texts::{link_of, object_of, with_keys};

impl Random {
    fn word(&mut self) -> u32 {
        self.bits() as u32
    }

    fn often(&mut self) -> bool {
        self.below(2) == 0
    }

    /// Returns any finite number, preferring common ones.
    fn number(&mut self) -> f32 {
        match self.below(4) {
            0 => self.below(9) as f32 * 0.25 - 1.0,
            1 => self.word() as f32 / 7.0,
            _ => Some(f32::from_bits(self.word())).filter(|number| number.is_finite()).unwrap_or(1e-30),
        }
    }

    fn one<T: Clone>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())].clone()
    }

    /// Returns text with characters that a link has to escape.
    fn text(&mut self) -> String {
        const LETTERS: [&str; 24] = [
            "a", "B", "7", " ", "&", "=", "#", "%", "%20", "+", ",", ":", "/", "?", "\"", "'", "<", "ü", "歩", "🦊",
            ".", "-", "{", "\t",
        ];
        (0..1 + self.below(12)).map(|_| self.one(&LETTERS)).collect()
    }

    /// Returns a joint name: one line that is not empty.
    fn name(&mut self) -> String {
        let line: String = self.text().chars().filter(|letter| !letter.is_control()).collect();
        format!("{}x", line.trim_start())
    }

    fn texts(&mut self) -> Vec<String> {
        (0..self.below(4)).map(|_| self.text()).collect()
    }

    fn clip(&mut self) -> ClipRef {
        // Including names that look like numbers.
        if self.often() {
            ClipRef::Index(self.below(300))
        } else {
            ClipRef::Name(self.one(&["0", "12", "Idle", "\"", "a:b"]).into())
        }
    }

    fn unmapped(&mut self) -> Unmapped {
        if self.often() { Unmapped::Rest } else { Unmapped::Clip { clip: self.clip(), frozen: self.often() } }
    }

    fn root(&mut self) -> RootOptions {
        let parts = [RootPart::Keep, RootPart::InPlace, RootPart::Freeze];
        let (horizontal, vertical, yaw) = (self.one(&parts), self.one(&parts), self.one(&parts));
        let origin = self.one(&[PathOrigin::Rest, PathOrigin::Feet]);
        RootOptions { horizontal, vertical, yaw, extract: self.often(), origin }
    }

    fn map(&mut self) -> MotionMap {
        let joints = (0..self.below(70)).map(|_| {
            let source = self.often().then(|| self.below(300));
            let correction = if self.often() { Quat::from_rotation_y(self.below(7) as f32) } else { Quat::IDENTITY };
            let unmapped = (self.below(5) == 0).then(|| self.unmapped());
            (self.below(400), MapEntry { source, correction, unmapped })
        });
        let joints: BTreeMap<usize, MapEntry> = joints.collect();
        let root = if self.often() { self.root() } else { RootOptions::default() };
        let feet = self.one(&[Feet::Off, Feet::Plant]);
        let contacts = self.one(&[Contacts::Off, Contacts::Keep]);
        let chains = self.one(&[Chains::Off, Chains::Share]);
        let map = JointMap { joints, root, feet, contacts, chains, ..JointMap::default() };
        MotionMap::Numbers(NumberedMap { checksum: self.word(), map })
    }

    fn camera(&mut self) -> CameraChoice {
        match self.below(3) {
            0 => CameraChoice::Auto,
            1 => CameraChoice::File(self.below(9)),
            _ => CameraChoice::Orbit(OrbitCamera {
                yaw_radians: self.below(629) as f32 / 100.0,
                pitch_radians: self.below(314) as f32 / 100.0 - 1.5,
                distance: 0.01 + self.below(100_000) as f32 / 37.0,
                target: Vec3::new(self.number(), self.number(), self.number()),
            }),
        }
    }

    fn state(&mut self) -> ViewerState {
        let mut state = ViewerState::default();
        for field in 0..43 {
            if self.often() {
                self.set(&mut state, field);
            }
        }
        state
    }

    fn set_look(&mut self, state: &mut ViewerState, field: usize) {
        match field {
            22 => state.display.exposure = self.number(),
            23 => state.display.environment_degrees = self.number(),
            24 => {
                let [_, red, green, blue] = self.word().to_be_bytes();
                state.display.background =
                    self.one(&[Background::Transparent, Background::Blurred, Background::Color([red, green, blue])]);
            }
            29 => state.display.tone_map = self.one(&[ToneMap::Aces, ToneMap::Agx, ToneMap::None]),
            30 => {
                let named = EnvironmentChoice::File(format!("{}.hdr", self.name()));
                state.lighting.environment = self.one(&[EnvironmentChoice::Setup(LightSetup::Outdoor), named]);
            }
            _ => {
                let [strength, yaw_degrees, pitch_degrees] = [self.number(), self.number(), self.number()];
                state.lighting.key = Some(KeyLight { strength, yaw_degrees, pitch_degrees });
            }
        }
    }

    fn called(&mut self) -> ClipId {
        ClipId::called(&self.text())
    }

    fn clip_or_rest(&mut self) -> ClipChoice {
        if self.often() { ClipChoice::RestPose } else { ClipChoice::Clip(self.called()) }
    }

    fn changed_clips(&mut self) -> BTreeMap<ClipId, ClipChanges> {
        let changes = ClipChanges { reverse: true, mirror: self.often(), ..ClipChanges::default() };
        (0..self.below(4)).map(|_| (self.called(), changes.clone())).collect()
    }

    fn copy_and_rename(&mut self, edits: &mut ClipEdits) {
        let names: BTreeSet<String> = (0..self.below(4)).map(|_| self.text()).collect();
        edits.copies = (0..names.len() as u32).map(|at| ClipCopy { id: CopyId(at), of: self.called() }).collect();
        edits.names = (0..).zip(names).map(|(at, name)| (ClipId::Copy(CopyId(at)), name)).collect();
        edits.names.extend((0..self.below(4)).map(|_| (self.called(), self.text())));
    }

    fn layer(&mut self) -> LayeredClip {
        let mut mask = LayerMask::default();
        for (part, _) in BodyPart::ALL.into_iter().filter(|_| self.below(4) == 0) {
            mask.toggle(part);
        }
        mask.joints = (0..self.below(3)).map(|_| self.below(300)).collect();
        let [weight, speed, start_secs] = [(); 3].map(|()| f64::from(self.number()));
        let layer = ClipLayer { weight, speed, start_secs, mode: self.one(&LayerMode::ALL), mask };
        LayeredClip { clip: self.called(), layer }
    }

    fn pin(&mut self) -> Pin {
        let point = Vec3::new(self.number(), self.number(), self.number());
        let goals =
            [PinGoal::Point(point), PinGoal::Joint(self.below(300), point), PinGoal::Look(point), PinGoal::Camera];
        let [start_secs, end_secs, blend_secs] = [0; 3].map(|_| f64::from(self.number()));
        let times = PinTimes { start_secs, end_secs, blend_secs };
        Pin { goal: self.one(&goals), times: self.often().then_some(times) }
    }

    fn set_avatar(&mut self, state: &mut ViewerState, field: usize) {
        match field {
            32 => {
                let expressions = (0..self.below(4)).map(|_| (self.text(), self.below(5) as f32 / 4.0));
                state.character.edits.expressions = expressions.collect();
            }
            33 => {
                let point = LookTarget::Point(Vec3::new(self.number(), self.number(), self.number()));
                state.display.look_at = self.one(&[LookTarget::Camera, point]);
            }
            35 => {
                let nodes = (0..self.below(4)).map(|_| self.below(300)).collect();
                let materials = (0..self.below(4)).map(|_| self.often().then(|| self.below(9))).collect();
                state.character.edits.hidden = Hidden { nodes, materials };
            }
            34 => state.display.channel = self.one(&Channel::ALL),
            _ => state.display.springs = self.often(),
        }
    }

    fn set_camera_options(&mut self, options: &mut CameraOptions, field: usize) {
        match field {
            19 => options.fov_degrees = self.number(),
            20 => options.follow = self.often(),
            _ => options.turntable = self.number(),
        }
    }

    fn skinning(&mut self) -> SkinningMode {
        self.one(&[SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion])
    }

    fn set(&mut self, state: &mut ViewerState, field: usize) {
        let CharacterView { sources, retarget, edits, playhead } = &mut state.character;
        match field {
            0 => sources.model = self.texts(),
            1 => {
                sources.motion = self.texts();
                // The first clip has a name beside motions.
                playhead.clip = if sources.motion.is_empty() { ClipChoice::First } else { ClipChoice::FirstOfMotions };
            }
            2 => retarget.map = (0..self.below(3)).map(|_| self.map()).collect(),
            3 => retarget.unmapped = Some(self.unmapped()),
            4 => retarget.root = Some(self.root()),
            5 => retarget.feet = Some(self.one(&[Feet::Off, Feet::Plant])),
            6 => sources.scene = Some(self.below(9)),
            7 => playhead.clip = self.clip_or_rest(),
            8 => playhead.time_secs = f64::from(self.number()) / 3.0,
            9 => {
                let clip = self.clip_or_rest();
                let (time_secs, elapsed_secs) = (f64::from(self.number()), f64::from(self.number()));
                playhead.fade = Some(Fade { clip, time_secs, elapsed_secs });
            }
            10 => state.playback.playing = self.often(),
            11 => state.playback.speed = f64::from(self.number()),
            12 => state.playback.loop_mode = self.one(&[LoopMode::Once, LoopMode::Loop, LoopMode::PingPong]),
            13 => {
                let (a, b) = (f64::from(self.number()), f64::from(self.number()));
                playhead.range = Some(TimeRange { start_secs: a.min(b), end_secs: a.max(b) });
            }
            14 => state.display.skinning = self.skinning(),
            15 => edits.morph = (0..self.below(5)).map(|_| (self.below(60), self.number())).collect(),
            16 => {
                let (mesh, grid, shadow) = (self.often(), self.often(), self.often());
                let (split, source) = (self.often(), self.often());
                let (boxes, smooth) = (self.often(), self.often());
                let (weights, rests) = (self.often(), self.often());
                state.display.show = Show { mesh, grid, shadow, source, boxes, smooth, ..state.display.show };
                state.inspect = Inspect { weights, split, rests };
            }
            17 => state.selection.joint = Some(self.below(300)),
            18 => state.camera = self.camera(),
            21 => edits.up = self.one(&[UpAxis::X, UpAxis::Z, UpAxis::MinusX, UpAxis::MinusY, UpAxis::MinusZ]),
            25 => {
                let turns = |random: &mut Self| [random.number(), random.number(), random.number()];
                edits.pose = (0..self.below(5)).map(|_| (self.below(300), turns(self))).collect();
            }
            37 => edits.clips.changes = self.changed_clips(),
            42 => self.copy_and_rename(&mut edits.clips),
            38 => edits.layers = (0..self.below(4)).map(|_| self.layer()).collect(),
            39 => edits.pins = (0..self.below(4)).map(|_| (self.below(300), self.pin())).collect(),
            41 => retarget.contacts = Some(self.one(&[Contacts::Off, Contacts::Keep])),
            19 | 20 | 26 => self.set_camera_options(&mut state.camera_options, field),
            27 => edits.names = (0..self.below(4)).map(|_| (self.below(300), self.name())).collect(),
            28 => {
                let (instance, primitive, vertex) = (self.below(3), self.below(9), self.below(99_999));
                state.selection.vertex = Some(VertexChoice { instance, primitive, vertex });
            }
            22 if self.often() => edits.variant = Some(self.text()),
            22..=24 | 29..=31 => self.set_look(state, field),
            32..=36 => self.set_avatar(state, field),
            _ => state.page.embed = self.one(&[Embed::Off, Embed::Page, Embed::Transport, Embed::Viewport]),
        }
    }
}

fn is_bad(error: &LinkError) -> bool {
    matches!(error, LinkError::BadValue { .. })
}

#[test]
fn any_state_round_trips_through_its_link() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let state = random.state();
        let link = link_of(&state);
        let (back, errors) = from_link(&link);
        assert_eq!(errors, [], "{link}");
        assert_eq!(back, state, "{link}");
        assert_eq!(link_of(&back), link);
        let object = object_of(&state);
        let (back, errors) = with_keys(&random.state(), &object);
        assert_eq!(errors, [], "{object}");
        assert_eq!(back, state, "an object sets every key, whatever the state was: {object}");
    }
}

/// Invalid parts are reported once; the link of the remaining state round-trips.
#[test]
fn any_text_normalizes_to_a_stable_link() {
    let mut random = Random(2);
    let words = [
        "v",
        "model",
        "map",
        "t",
        "play",
        "camera",
        "clip",
        "show",
        "morph",
        "range",
        "fade",
        "root",
        "zoo",
        "=",
        "=",
        "=",
        "&",
        "&",
        "&",
        "1",
        "0",
        "-3.5",
        "1e400",
        "NaN",
        "%",
        "%ff",
        "%26",
        "gltf:",
        "1.ffffffff.0-5",
        "{}",
        ",",
        ":",
        "",
        "auto",
        "skeleton",
        "#",
        "é",
    ];
    for _ in 0..5000 {
        let text: String = (0..random.below(30)).map(|_| random.one(&words)).collect();
        let (state, _) = from_link(&text);
        let link = link_of(&state);
        let (again, errors) = from_link(&link);
        assert!(!errors.iter().any(is_bad), "{text} → {link}: {errors:?}");
        // The first clip has a name in version 2.
        assert_eq!(object_of(&again), object_of(&state), "{text} → {link}");
        assert_eq!(link_of(&again), link, "{text}");
    }
}

#[test]
fn old_links_keep_working() {
    let fixtures: Value = serde_json::from_str(include_str!("links.json")).expect("JSON");
    let now = object_of(&ViewerState::default());
    for (key, value) in fixtures["defaults"].as_object().expect("an object") {
        assert_eq!(&now[key], value, "a version fixes the default of {key}");
    }
    for fixture in fixtures["links"].as_array().expect("a list") {
        let link = fixture["link"].as_str().expect("a text");
        let (state, errors) = from_link(link);
        assert!(!errors.iter().any(is_bad), "{link}: {errors:?}");
        let mut expected = now.clone();
        for (key, value) in fixture["state"].as_object().expect("an object") {
            expected[key] = value.clone();
        }
        assert_eq!(object_of(&state), expected, "{link}");
        let again = from_link(&link_of(&state)).0;
        assert_eq!((object_of(&again), link_of(&again)), (expected, link_of(&state)), "{link}");
    }
}

/// A typical character with fingers.
#[test]
fn a_map_of_sixty_joints_is_short() {
    let entry = |number| MapEntry::following(Some(number));
    let joints = (0..60).map(|joint| (joint, entry(3 * joint + 100))).collect();
    let map = JointMap { joints, ..JointMap::default() };
    let map = vec![MotionMap::Numbers(NumberedMap { checksum: u32::MAX, map })];
    let link = link_of(&ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map, ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    });
    assert!(link.len() < 2000, "{} characters", link.len());
}
