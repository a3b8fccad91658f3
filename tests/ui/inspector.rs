//! The right panel and its tabs.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{FrameTimes, RecordingProgress, Tab, UiAction, Validation, text};
use gaitway_character::anim::{
    ClipBuilder, Interpolation, Joint, JointIndex, MaterialProperty, PropertyTarget, Skeleton,
};
use gaitway_character::asset::{Asset, AssetParts, Image, MeshInstance, Panorama, Warning};
use gaitway_character::avatar::{Avatar, Expression, LookAt, LookAtKind, Override, RangeMaps, SpringJoint, Springs};
use gaitway_character::mesh::{
    AlphaMode, Geometry, Lobes, Material, Mesh, Sampler, SkinningMode, Texture, TextureRef, UvTransform,
};
use gaitway_scene::editor::{ValidatorGroup, ValidatorReport};
use gaitway_scene::library::{Environment, ImageData, Library, LookTarget, Model, ModelId};
use gaitway_scene::samples;
use gaitway_scene::state::{
    Background, CameraChoice, Channel, Command, EnvironmentChoice, Inspect, KeyLight, LightSetup, Show, ToneMap, UpAxis,
};
use glam::Vec3;

use crate::bench::{Bench, WIDE, bench, bench_of, model_with_clips, painted, press, press_key, sample_bench};
use crate::motion::reach;

#[test]
fn display_sets_skinning_overlays_and_morphs() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Display.label());
    assert_eq!(press(&mut harness, text::RIGID), [Command::SetSkinning(SkinningMode::Rigid)]);
    assert_eq!(press(&mut harness, text::DUAL_QUATERNION), [Command::SetSkinning(SkinningMode::DualQuaternion)]);
    let skeleton = Show { skeleton: true, ..Show::default() };
    assert_eq!(press(&mut harness, text::SKELETON), [Command::SetShow(skeleton)]);
    let weights = Inspect { weights: true, ..Inspect::default() };
    assert_eq!(press(&mut harness, text::JOINT_WEIGHTS), [Command::SetInspect(weights)]);
    assert!(harness.query_by_label(text::JOINT_WEIGHTS_HINT).is_some());
    harness.state_mut().commands.clear();
    harness.get_by_label("Blink").set_value_accesskit(0.75);
    harness.run();
    let morphs: Vec<_> = harness.state().state().character.edits.morph.values().copied().collect();
    assert_eq!(morphs, [0.75]);
    assert_eq!(reach(&mut harness, text::RESET_MORPHS), [Command::ClearMorphs]);
}

#[test]
fn display_offers_the_material_variants_of_the_file() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Display.label());
    assert!(harness.query_by_label(text::VARIANTS).is_none(), "the sample has none");
    let skeleton = Skeleton::new(vec![Joint::default()]).expect("one joint");
    let variants = vec!["Day".to_owned(), "Night".to_owned()];
    let asset = Asset::new(AssetParts { skeleton, variants, ..AssetParts::default() }).expect("indices in range");
    let mut library = Library::default();
    library.add(Model::new("shoe.glb".to_owned(), asset, Vec::new()));
    let mut harness = bench_of(WIDE, library);
    press(&mut harness, Tab::Display.label());
    assert_eq!(press(&mut harness, "Night"), [Command::SetVariant(Some("Night".to_owned()))]);
    assert_eq!(harness.state().state().character.edits.variant.as_deref(), Some("Night"));
    assert_eq!(press(&mut harness, text::NO_VARIANT), [Command::SetVariant(None)]);
}

#[test]
fn view_sets_camera_and_background() {
    // Tall enough for the whole tab.
    let mut harness = sample_bench([1280.0, 1600.0]);
    press(&mut harness, Tab::Camera.label());
    let angles = [(text::FRONT, 0.0, 0.0), (text::SIDE, 90.0, 0.0), (text::TOP, 0.0, 89.9)];
    for (label, yaw_degrees, pitch_degrees) in angles {
        let commands = press(&mut harness, label);
        let [Command::SetCamera(CameraChoice::Orbit(orbit))] = commands[..] else { panic!("{commands:?}") };
        assert!((orbit.yaw_radians.to_degrees() - yaw_degrees).abs() < 1e-3, "{label}");
        assert!((orbit.pitch_radians.to_degrees() - pitch_degrees).abs() < 1e-3, "{label}");
    }
    assert_eq!(press(&mut harness, text::FOLLOW), [Command::SetFollow(true)]);
    assert_eq!(press(&mut harness, text::NO_BACKGROUND), [Command::SetBackground(Background::Transparent)]);
    harness.get_by_label(text::UP_Z).scroll_to_me();
    harness.run();
    assert_eq!(press(&mut harness, text::UP_Z), [Command::SetUp(UpAxis::Z)]);
    harness.get_by_label(text::EXPOSURE).set_value_accesskit(2.0);
    harness.run();
    assert_eq!(harness.state().state().display.exposure, 2.0);
}

#[test]
fn view_sets_the_light() {
    let mut library = Library::default();
    library.add(samples::load(samples::WALKER).expect("is generated"));
    let panorama = Panorama::new(1, 1, vec![Vec3::ONE]).expect("one pixel");
    library.add_environment(Environment {
        origin: "beach.hdr".to_owned(),
        panorama: panorama.into(),
        file: Default::default(),
        is_own: true,
    });
    // Tall enough for the whole tab.
    let mut harness = bench_of([1280.0, 1600.0], library);
    press(&mut harness, Tab::Camera.label());
    let agx = text::labelled(text::TONE_MAP, text::TONE_AGX);
    assert_eq!(press(&mut harness, &agx), [Command::SetToneMap(ToneMap::Agx)]);
    let outdoor = EnvironmentChoice::Setup(LightSetup::Outdoor);
    let label = text::labelled(text::LIGHT, text::OUTDOOR_LIGHT);
    assert_eq!(press(&mut harness, &label), [Command::SetLight(outdoor)]);
    let beach = EnvironmentChoice::File("beach.hdr".to_owned());
    assert_eq!(press(&mut harness, "beach.hdr"), [Command::SetLight(beach)]);
    assert_eq!(press(&mut harness, text::BLURRED), [Command::SetBackground(Background::Blurred)]);
    let [Command::SetKeyLight(Some(key))] = press(&mut harness, text::OWN_KEY_LIGHT)[..] else {
        panic!("no key light")
    };
    assert!(key.strength > 0.0);
    harness.get_by_label(text::KEY_STRENGTH).set_value_accesskit(0.0);
    harness.run();
    assert_eq!(harness.state().state().lighting.key, Some(KeyLight { strength: 0.0, ..key }));
    assert_eq!(press(&mut harness, text::OWN_KEY_LIGHT), [Command::SetKeyLight(None)]);
}

#[test]
fn the_file_report_counts_and_groups() {
    let mut harness = bench(WIDE, model_with_clips(3));
    press(&mut harness, Tab::Info.label());
    for (name, value) in [(text::FORMAT, "GLB"), (text::CLIPS, "3"), (text::NODES, "1")] {
        assert!(harness.query_by_label(&text::labelled(name, value)).is_some(), "{name}");
    }
    assert!(harness.query_by_label_contains("KHR_texture_transform").is_some());
    assert!(harness.query_by_label(&text::warning_title("matrix-not-decomposable", 2)).is_some());
    assert_eq!(harness.query_all_by_label_contains("sheared or singular").count(), 2);
}

/// One joint and a material; one clip animates its colour and hides the joint, another does neither.
fn glowing() -> Model {
    let joint = Joint { name: "Only".to_owned(), ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint]).expect("one joint");
    let mut glow = ClipBuilder::new("Glow", &skeleton);
    let color = PropertyTarget::Material(0, MaterialProperty::BaseColor);
    glow.property(color, Interpolation::Step, &[0.0], vec![1.0, 0.5, 0.0, 1.0]).expect("one key");
    glow.property(PropertyTarget::Visibility(JointIndex(0)), Interpolation::Step, &[0.0], vec![0.0]).expect("one key");
    let clips = vec![glow.build(), ClipBuilder::new("Nothing", &skeleton).build()];
    let materials = vec![Material { name: "Paint".to_owned(), ..Material::default() }];
    let parts = AssetParts { format: "glb", skeleton, clips, materials, ..AssetParts::default() };
    Model::new("glow.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new())
}

/// A head without eye bones, on a spring, with an expression that has an effect and one that has none.
fn avatar() -> Model {
    let joint = Joint { name: "Head".to_owned(), ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint]).expect("one joint");
    let joint = JointIndex(0);
    let happy = Expression { overrides: [Override::Block; 3], ..Expression::new("happy", "Joy", true) };
    let range = [90.0, 10.0];
    let maps = RangeMaps { inner: range, outer: range, down: range, up: range };
    let kind = LookAtKind::Bones([None; 2]);
    let look_at = Some(LookAt { head: joint, offset: Vec3::ZERO, faces_minus_z: false, maps, kind });
    let spring = SpringJoint {
        joint,
        tail: Vec3::Y,
        stiffness: 1.0,
        gravity: Vec3::ZERO,
        drag: 0.4,
        radius: 0.0,
        center: None,
        colliders: Vec::new(),
    };
    let avatar = Avatar {
        expressions: vec![happy, Expression::new("sad", "Sorrow", true)],
        look_at,
        springs: Springs::new(&skeleton, vec![spring], Vec::new()),
        meta: vec![("commercialUssageName".to_owned(), "Allow".to_owned())],
        first_person: vec![(joint, "thirdPersonOnly".to_owned())],
        ..Avatar::default()
    };
    let parts = AssetParts { format: "vrm", skeleton, avatar, ..AssetParts::default() };
    Model::new("head.vrm".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new())
}

#[test]
fn avatars_have_expressions_eyes_springs_and_a_licence() {
    let mut library = Library::default();
    library.add(avatar());
    // Tall enough for the whole tab.
    let mut harness = bench_of([1280.0, 1600.0], library);
    press(&mut harness, Tab::Display.label());
    assert!(harness.query_by_label("Sorrow").is_none());
    harness.get_by_label("Joy").set_value_accesskit(0.75);
    harness.run();
    assert_eq!(harness.state().state().character.edits.expressions.get("happy"), Some(&0.75));
    assert_eq!(press(&mut harness, text::RESET_EXPRESSIONS), [Command::ClearExpressions]);
    assert_eq!(press(&mut harness, text::SPRINGS), [Command::SetSprings(true)]);
    let choice = |choice: &str| format!("{}: {choice}", text::EYES);
    assert_eq!(press(&mut harness, &choice(text::LOOK_AT_CAMERA)), [Command::SetLookAt(LookTarget::Camera)]);
    let commands = press(&mut harness, &choice(text::LOOK_AT_POINT));
    assert!(matches!(commands[..], [Command::SetLookAt(LookTarget::Point(_))]), "{commands:?}");
    harness.run();
    assert!(harness.query_by_label(&text::labelled(text::EYES, "Z")).is_some());
    press(&mut harness, Tab::Info.label());
    for (name, value) in [("Commercial usage", "Allow"), (&*text::first_person("Head"), "Third person only")] {
        assert!(harness.query_by_label(&text::labelled(name, value)).is_some(), "{name}");
    }
}

#[test]
fn the_file_tab_lists_what_clips_animate_besides_joints() {
    let mut harness = bench(WIDE, glowing());
    press(&mut harness, "Only");
    assert!(harness.query_by_label(text::NODE_HIDDEN).is_some());
    press(&mut harness, Tab::Info.label());
    assert!(harness.query_by_label(&text::counted("Glow", 2)).is_some());
    assert!(harness.query_by_label_contains("Nothing (").is_none());
    let color = text::labelled("Paint", text::BASE_COLOR);
    let visibility = text::labelled("Only", text::VISIBILITY);
    let values = [(&color, "1.000  0.500  0.000  1.000"), (&visibility, text::HIDDEN)];
    for (name, value) in values {
        assert!(harness.query_by_label(&text::labelled(name, value)).is_some(), "{name}");
    }
    let mut plain = sample_bench(WIDE);
    press(&mut plain, "Head");
    assert!(plain.query_by_label(text::NODE_HIDDEN).is_none());
}

#[test]
fn the_chosen_segment_says_so() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Camera.label());
    let toggled = |label: &str| harness.get_by_label(label).accesskit_node().toggled();
    assert_eq!(toggled(text::STUDIO), Some(egui::accesskit::Toggled::True));
    assert_eq!(toggled(text::COLOR), Some(egui::accesskit::Toggled::False));
}

#[test]
fn warnings_lead_to_their_nodes_and_have_badges() {
    let joint = |name: &str| Joint { name: name.to_owned(), ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint("First"), joint("Second")]).expect("two joints");
    let mut asset = Asset::from(skeleton);
    asset.warnings.push(Warning::MatrixNotDecomposable { node: "nodes[1]".to_owned() });
    let mut harness = bench(WIDE, Model::new("two.glb".to_owned(), asset, Vec::new()));
    let badge = |harness: &Harness<'_, Bench>| {
        let tab = harness.get_by_label(Tab::Info.label());
        tab.accesskit_node().data().description().map(str::to_owned)
    };
    assert_eq!(badge(&harness), Some(text::file_warnings(1)));
    press(&mut harness, Tab::Info.label());
    assert!(harness.query_by_label("Matrix not decomposable").is_some(), "a code in words");
    assert_eq!(reach(&mut harness, &text::go_to("Second")), [Command::SelectJoint(Some(1))]);
    assert_eq!(harness.state().panels.layout.tab, Tab::Scene);
    let described = |name: &str| {
        let row = harness.get_by_role_and_label(Role::TreeItem, name);
        row.accesskit_node().data().description().map(str::to_owned)
    };
    assert_eq!((described("First"), described("Second")), (None, Some(text::node_warnings(1))));
    harness.get_by_role_and_label(Role::TreeItem, "Second").hover();
    harness.run_steps(60);
    assert!(harness.query_by_label(&text::node_warnings(1)).is_some(), "the tooltip");
    let harness = sample_bench(WIDE);
    assert_eq!(badge(&harness), None);
}

#[test]
fn the_validators_results_come_into_sight() {
    let group = |name: &str, count: usize| ValidatorGroup {
        severity: 0,
        code: name.to_owned(),
        meaning: name.to_owned(),
        count: count as u64,
        findings: (0..count).map(|at| (format!("{name} {at}"), None)).collect(),
    };
    let groups = (0..9).map(|at| group(&format!("Group {at}"), 1)).collect();
    let many = ValidatorReport { groups, ..ValidatorReport::default() };
    let few = ValidatorReport { groups: vec![group("Alone", 2)], ..ValidatorReport::default() };
    for (report, last) in [(ValidatorReport::default(), text::NO_FINDINGS), (few, "Alone 1"), (many, "Group 1 0")] {
        let mut harness = bench([1280.0, 480.0], model_with_clips(3));
        press(&mut harness, Tab::Info.label());
        let host = &mut harness.state_mut().panels.host;
        (host.has_validator, host.has_gltf) = (true, true);
        harness.run();
        let id = harness.state().library().active().unwrap().id;
        harness.state_mut().panels.host.validation = Some((id, Validation::Running));
        harness.run();
        let timeline = harness.get_by_label(text::TIME).rect();
        let below = harness.get_by_label(text::VALIDATING).rect().bottom();
        assert!(below > timeline.top(), "out of sight at {below}");
        harness.state_mut().panels.host.validation = Some((id, Validation::Done(report)));
        harness.run();
        for label in [text::VALIDATE_AGAIN, text::NO_FINDINGS, last] {
            let rect = harness.get_by_label(label).rect();
            assert!(rect.top() > 60.0 && rect.bottom() < timeline.top(), "{label}: {rect:?} and {timeline:?}");
        }
    }
}

#[test]
fn lists_that_drop_down_fit_low_windows() {
    for size in [WIDE, [1280.0, 320.0], [844.0, 390.0], [320.0, 240.0]] {
        let mut harness = sample_bench(size);
        if harness.query_by_label(Tab::Display.label()).is_none() {
            press(&mut harness, text::INSPECTOR);
        }
        press(&mut harness, Tab::Display.label());
        harness.get_by_label(text::CHANNEL).scroll_to_me();
        harness.run();
        press(&mut harness, text::CHANNEL);
        // A switch of the tab is named Wireframe, too.
        let role = harness.get_by_label(text::channel(Channel::Metallic)).accesskit_node().role();
        for channel in Channel::ALL {
            harness.get_by_role_and_label(role, text::channel(channel)).scroll_to_me();
            harness.run();
            let rect = harness.get_by_role_and_label(role, text::channel(channel)).rect();
            assert!(rect.top() >= 0.0 && rect.bottom() <= size[1], "{channel:?} at {rect:?} on {size:?}");
        }
    }
}

#[test]
fn a_chooser_opens_at_what_is_chosen_follows_the_focus_and_closes_without_it() {
    let size = [1280.0, 320.0];
    let mut harness = sample_bench(size);
    let [first, .., last] = Channel::ALL;
    harness.state_mut().change(|state| state.display.channel = last);
    press(&mut harness, Tab::Display.label());
    harness.get_by_label(text::CHANNEL).scroll_to_me();
    harness.run();
    press(&mut harness, text::CHANNEL);
    // A switch of the tab is named Wireframe, too.
    let role = harness.get_by_label(text::channel(Channel::Metallic)).accesskit_node().role();
    let is_in_sight = |harness: &Harness<'_, Bench>, channel| {
        let rect = harness.get_by_role_and_label(role, text::channel(channel)).rect();
        rect.top() >= 0.0 && rect.bottom() <= size[1]
    };
    assert!(is_in_sight(&harness, last) && !is_in_sight(&harness, first));
    harness.get_by_role_and_label(role, text::channel(first)).focus();
    harness.run();
    assert!(is_in_sight(&harness, first) && !is_in_sight(&harness, last));
    harness.get_by_role_and_label(Role::CheckBox, "Grid").focus();
    harness.run();
    assert!(!egui::Popup::is_any_open(&harness.ctx));
    assert!(harness.get_by_role_and_label(Role::CheckBox, "Grid").is_focused());
}

#[test]
fn a_channel_without_data_says_so() {
    // The sample has colours and no texture coordinates, the other model neither.
    for (mut harness, lacks) in [(sample_bench(WIDE), [false, true]), (bench(WIDE, model_with_clips(1)), [true, true])]
    {
        press(&mut harness, Tab::Display.label());
        for (channel, text, lacks) in
            [(Channel::VertexColor, "No vertex colours", lacks[0]), (Channel::Uv, "No texture coordinates", lacks[1])]
        {
            harness.state_mut().change(|state| state.display.channel = channel);
            harness.run();
            let count = painted(&harness).iter().filter(|(painted, ..)| painted == text).count();
            assert_eq!(count, if lacks { 2 } else { 0 }, "{text}: in the tab and in the viewport");
        }
    }
}

#[test]
fn the_focus_returns_to_what_started_a_recording() {
    let mut harness = sample_bench([1280.0, 1600.0]);
    press(&mut harness, Tab::Camera.label());
    harness.get_by_label(text::RECORD).focus();
    harness.run();
    let progress = RecordingProgress { frames_done: 1, frame_count: 9 };
    harness.state_mut().panels.host.recording = Some(progress);
    harness.run();
    harness.get_by_label(text::CANCEL).focus();
    harness.run();
    assert!(harness.get_by_label(text::CANCEL).accesskit_node().is_focused());
    harness.state_mut().panels.host.recording = None;
    harness.run();
    assert!(harness.get_by_label(text::RECORD).accesskit_node().is_focused());
}

#[test]
fn the_validator_reports_beside_the_warnings_and_leads_to_nodes() {
    let joint = |name: &str| Joint { name: name.to_owned(), ..Joint::default() };
    let skeleton = Skeleton::new(vec![joint("First"), joint("Second")]).expect("two joints");
    let mut harness = bench([1280.0, 1600.0], Model::new("two.glb".to_owned(), Asset::from(skeleton), Vec::new()));
    press(&mut harness, Tab::Info.label());
    assert!(harness.query_by_label(&text::KHRONOS_VALIDATOR.to_uppercase()).is_none(), "only where there is one");
    harness.state_mut().panels.host.has_validator = true;
    harness.run();
    assert!(harness.query_by_label(text::NO_GLTF).is_some() && harness.query_by_label(text::VALIDATE).is_none());
    harness.state_mut().panels.host.has_gltf = true;
    harness.run();
    press(&mut harness, text::VALIDATE);
    assert_eq!(harness.state().actions, [UiAction::Validate]);

    let id = harness.state().library().active().unwrap().id;
    let show = |harness: &mut Harness<'_, Bench>, of, validation| {
        harness.state_mut().panels.host.validation = Some((of, validation));
        harness.run();
    };
    show(&mut harness, id, Validation::Running);
    assert!(harness.query_by_label(text::VALIDATING).is_some());
    show(&mut harness, id, Validation::Failed("no connection".to_owned()));
    assert!(harness.query_by_label(&text::validator_failed("no connection")).is_some());
    press(&mut harness, text::VALIDATE_AGAIN);
    assert_eq!(harness.state().actions, [UiAction::Validate, UiAction::Validate]);
    show(&mut harness, id, Validation::Done(ValidatorReport::default()));
    assert!(harness.query_by_label(text::NO_FINDINGS).is_some());

    let group = |severity, code: &str, meaning: &str, count, findings: &[(&str, Option<JointIndex>)]| ValidatorGroup {
        severity,
        code: code.to_owned(),
        meaning: meaning.to_owned(),
        count,
        findings: findings.iter().map(|(text, joint)| ((*text).to_owned(), *joint)).collect(),
    };
    let long = "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION";
    let groups = vec![
        group(0, long, "", 1, &[("/skins/0: long", None)]),
        group(0, "BAD", "It is bad", 1315, &[("/nodes/1: bad", Some(JointIndex(1))), ("/asset: worse", None)]),
        group(3, "BAD", "", 1, &[("/nodes/0: hint", Some(JointIndex(0)))]),
    ];
    let report = ValidatorReport { counts: [1316, 0, 0, 1], is_truncated: false, groups };
    show(&mut harness, id, Validation::Done(report.clone()));
    let summary = "2 kinds of error in 1\u{2009}316 places, 1 hint";
    let title = "Error: It is bad (1\u{2009}315 places)\nBAD";
    for label in [summary, title, "/nodes/1: bad", "/asset: worse", "and 1\u{2009}313 more", "Hint: BAD"] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
    assert!(harness.query_by_label("/nodes/0: hint").is_none(), "hints are collapsed");
    let dot = harness.get_by_label(Tab::Info.label()).accesskit_node().description();
    assert_eq!(dot.as_deref(), Some(&*text::labelled(text::KHRONOS_VALIDATOR, summary)));
    let edge = |label: &str| harness.get_by_label(label).rect().right();
    assert!(edge(&format!("Error: {long}")) <= edge(text::VALIDATE_AGAIN), "wrapped");
    press(&mut harness, "Hint: BAD");
    assert!(harness.query_by_label(&text::go_to("First")).is_some());
    assert_eq!(reach(&mut harness, &text::go_to("Second")), [Command::SelectJoint(Some(1))]);
    assert_eq!(harness.state().panels.layout.tab, Tab::Scene);

    press(&mut harness, Tab::Info.label());
    show(&mut harness, ModelId(99), Validation::Done(report));
    assert!(harness.query_by_label(text::VALIDATE).is_some() && harness.query_by_label("/asset: worse").is_none());
}

#[test]
fn materials_and_images_are_listed_with_what_they_are() {
    let skeleton = Skeleton::new(vec![Joint { name: "Cloak".to_owned(), ..Joint::default() }]).expect("one joint");
    let map = Some(TextureRef { texture: 0, uv_set: 0, uv_transform: UvTransform::IDENTITY });
    let lobes = Lobes { clearcoat: 1.0, ..Lobes::default() };
    let cloth = Material {
        name: "Cloth".to_owned(),
        alpha_mode: AlphaMode::Blend,
        double_sided: true,
        base_color_texture: map,
        emissive_texture: map,
        lobes: Some(Box::new(lobes)),
        ..Material::default()
    };
    let image = Image { name: "weave".to_owned(), mime: "image/png", width: 8, height: 4, ..Image::default() };
    let triangle = |material| Geometry {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        indices: vec![0, 1, 2],
        file_vertices: 3,
        material,
        ..Geometry::default()
    };
    let asset = Asset::new(AssetParts {
        skeleton,
        meshes: vec![Mesh { primitives: vec![triangle(Some(0)), triangle(None)], ..Mesh::default() }],
        instances: vec![MeshInstance::new(JointIndex(0), 0, None)],
        materials: vec![cloth],
        textures: vec![Texture { image: Some(0), sampler: Sampler::default() }],
        images: vec![image],
        ..AssetParts::default()
    });
    let pixels = ImageData::Rgba8 { width: 8, height: 4, pixels: vec![9; 128] };
    let model = Model::new("cloak.glb".to_owned(), asset.expect("indices in range"), vec![Some(pixels)]);
    // Tall enough for the whole tab.
    let mut harness = bench([1280.0, 2000.0], model);
    press(&mut harness, Tab::Info.label());
    for line in [
        "Cloth",
        "blended, double-sided, base colour, emissive\nKHR_materials_clearcoat\non Cloak",
        "Default material",
        "opaque\non Cloak",
        "weave",
        "PNG, 8 × 4, base colour, emissive, 0.2 KB on the GPU",
    ] {
        assert!(harness.query_by_label(line).is_some(), "{line}");
    }
    let facts = painted(&harness).into_iter().find(|(text, ..)| text.starts_with("PNG, 8"));
    let (_, is_cut, rect) = facts.expect("the image's facts");
    assert!(!is_cut && rect.right() <= WIDE[0] - 14.0 && rect.height() > 20.0, "in two lines: {rect:?}");
    assert!(harness.query_by_label(&text::labelled(text::INFLUENCES, "none")).is_some());
    assert!(harness.query_by_label(&text::labelled(text::FRAME_TIME, text::NO_FRAMES)).is_some());
    assert_eq!(harness.state().panels.info_model, Some(harness.state().library().active().unwrap().id));
    let drawn = &mut harness.state_mut().panels.host.drawn;
    (drawn.draw_calls, drawn.triangles) = (7, 4321);
    (0..200).for_each(|_| drawn.frames.push(0.02));
    assert_eq!(drawn.frames.iter().count(), FrameTimes::CAPACITY);
    harness.run();
    assert!(harness.query_by_label(&text::labelled(text::DRAW_CALLS, "7")).is_some());
    assert!(harness.query_by_label(&text::labelled(text::FRAME_TIME, &text::frame_time(0.02))).is_some());
    assert!(harness.query_by_label(&text::frame_graph(FrameTimes::CAPACITY, 60.0, 0.05)).is_some());
}

#[test]
fn small_steps_of_a_slider_are_one_edit_unless_there_is_a_pause() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Camera.label());
    harness.get_by_role_and_label(egui::accesskit::Role::Slider, text::EXPOSURE).focus();
    harness.run();
    for steps in [1, 2] {
        for _ in 0..3 {
            press_key(&mut harness, egui::Key::ArrowRight);
        }
        assert_eq!(harness.state().editor.undo_steps(), steps);
        // A second.
        harness.run_steps(70);
    }
    let exposure = harness.state().state().display.exposure;
    assert!(harness.state_mut().editor.undo());
    let before = harness.state().state().display.exposure;
    assert!(0.0 < before && before < exposure, "{before}, {exposure}");
}

#[test]
fn a_double_click_on_a_slider_resets_it_in_one_step() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Camera.label());
    harness.get_by_role_and_label(egui::accesskit::Role::Slider, text::EXPOSURE).set_value_accesskit(1.0);
    harness.run();
    let bar = harness.get_by_role_and_label(egui::accesskit::Role::Slider, text::EXPOSURE).rect();
    let pos = bar.left_center() + egui::vec2(0.2 * bar.width(), 0.0);
    harness.event(egui::Event::PointerMoved(pos));
    // The click on the tab is too long ago to count.
    harness.run_steps(30);
    for pressed in [true, false, true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        harness.step();
        if pressed {
            assert_eq!(harness.state().editor.undo_steps(), 2);
            assert!(harness.state().state().display.exposure < 0.0, "the first click moves it");
        }
    }
    assert_eq!(harness.state().state().display.exposure, 0.0);
    assert_eq!(harness.state().editor.undo_steps(), 2);
    assert!(harness.state_mut().editor.undo());
    assert_eq!(harness.state().state().display.exposure, 1.0);
}

#[test]
fn a_control_that_takes_the_focus_comes_into_sight() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Display.label());
    let heights =
        |harness: &Harness<'_, Bench>, name: &str| harness.get_by_role_and_label(Role::Slider, name).rect().y_range();
    let panel = harness.state().viewport.y_range();
    let below = heights(&harness, "Blink");
    assert!(below.min > panel.max, "out of sight: {below:?}");
    // A slider in the row below the panel lies where the panel's contents go on.
    harness.get_by_role_and_label(Role::Slider, text::SPEED).focus();
    harness.run();
    assert_eq!(heights(&harness, "Blink"), below);
    harness.get_by_role_and_label(Role::Slider, "Blink").focus();
    harness.run();
    let slider = heights(&harness, "Blink");
    assert!(panel.contains(slider.min) && panel.contains(slider.max), "{slider:?} in {panel:?}");
}
