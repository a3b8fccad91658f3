//! The right panel and its tabs.

use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::anim::{ClipBuilder, Interpolation, Joint, JointIndex, MaterialProperty, PropertyTarget, Skeleton};
use gaitway::asset::{Asset, AssetParts, Panorama};
use gaitway::avatar::{Avatar, Expression, LookAt, LookAtKind, Override, RangeMaps, SpringJoint, Springs};
use gaitway::library::{Environment, Library, Model};
use gaitway::mesh::{Material, SkinningMode};
use gaitway::samples;
use gaitway::state::{
    Background, CameraChoice, Command, EnvironmentChoice, Inspect, KeyLight, LightSetup, LookTarget, Show, ToneMap,
    UpAxis,
};
use gaitway::ui::{Tab, text};
use glam::Vec3;

use crate::bench::{WIDE, bench, bench_of, model_with_clips, press, sample_bench};
use crate::motion::reach;

#[test]
fn the_tree_shows_all_joints_and_chooses_one() {
    // Tall enough for the whole tree.
    let mut harness = sample_bench([1280.0, 1600.0]);
    let commands = press(&mut harness, "LeftHand");
    let skeleton = &harness.state().library().active().unwrap().asset.skeleton;
    let hand = skeleton.source_index(skeleton.find("LeftHand").unwrap());
    assert_eq!(commands, [Command::SelectJoint(Some(hand))]);
    assert!(harness.query_by_label(&text::local_transform(Some("LeftLowerArm"))).is_some());
    assert!(harness.query_all_by_label_contains(text::POSITION).count() >= 2, "local and world");
    assert_eq!(press(&mut harness, text::DESELECT_JOINT), [Command::SelectJoint(None)]);
}

#[test]
fn folding_a_joint_hides_what_hangs_on_it() {
    let mut harness = sample_bench(WIDE);
    assert!(harness.query_by_label("Head").is_some());
    press(&mut harness, &text::collapse("Neck"));
    assert!(harness.query_by_label("Head").is_none());
    press(&mut harness, &text::expand("Neck"));
    assert!(harness.query_by_label("Head").is_some());
}

#[test]
fn nodes_are_found_by_name() {
    let mut harness = sample_bench(WIDE);
    harness.get_by_label(text::SEARCH_NODES).click();
    harness.run();
    harness.get_by_label(text::SEARCH_NODES).type_text("toes");
    harness.run();
    assert!(harness.query_by_label("LeftToes").is_some());
    assert!(harness.query_by_label("Hips").is_none());
}

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
    let morphs: Vec<_> = harness.state().state().edits.morph.values().copied().collect();
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
    assert_eq!(harness.state().state().edits.variant.as_deref(), Some("Night"));
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
    library.add_environment(Environment { origin: "beach.hdr".to_owned(), panorama: panorama.into(), is_own: true });
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
    assert!(harness.query_by_label(&text::counted("matrix-not-decomposable", 2)).is_some());
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
    assert_eq!(harness.state().state().edits.expressions.get("happy"), Some(&0.75));
    assert_eq!(press(&mut harness, text::RESET_EXPRESSIONS), [Command::ClearExpressions]);
    assert_eq!(press(&mut harness, text::SPRINGS), [Command::SetSprings(true)]);
    let choice = |choice: &str| format!("{}: {choice}", text::EYES);
    assert_eq!(press(&mut harness, &choice(text::LOOK_AT_CAMERA)), [Command::SetLookAt(LookTarget::Camera)]);
    let commands = press(&mut harness, &choice(text::LOOK_AT_POINT));
    assert!(matches!(commands[..], [Command::SetLookAt(LookTarget::Point(_))]), "{commands:?}");
    harness.run();
    assert!(harness.query_by_label("Z").is_some());
    press(&mut harness, Tab::Info.label());
    for (name, value) in [("Commercial usage name", "Allow"), (&*text::first_person("Head"), "Third person only")] {
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

/// Wherever in the tree it is, and whether or not another joint was selected before.
#[test]
fn selecting_a_joint_moves_no_row() {
    let mut harness = sample_bench(WIDE);
    for joint in ["Hips", "Chest", "Neck", "Hips"] {
        let before = harness.get_by_label(joint).rect();
        press(&mut harness, joint);
        let name = |label: &str| harness.query_all_by_label(label).map(|node| node.rect()).next();
        assert_eq!(name(joint), Some(before), "{joint}");
    }
}
