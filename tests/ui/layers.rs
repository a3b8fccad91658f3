//! The section of layers, and their tracks under the timeline.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Saved, Sheet, Tab, UiAction, text};
use gaitway_retarget::{BodyPart, ClipLayer, LayerMask, LayerMode};
use gaitway_scene::editor::Export;
use gaitway_scene::library::{ClipId, LayeredClip};
use gaitway_scene::state::Command;

use crate::bench::{Bench, NARROW, WIDE, bench, model_with_clips_named, motion_bench, press, sample_bench};
use crate::header::choose;

/// Clips of the walker.
const IDLE: ClipId = ClipId::Own(1);
const WAVE: ClipId = ClipId::Own(2);

fn scrolled_to(harness: &mut Harness<'_, Bench>, label: &str) {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
}

fn layers(harness: &Harness<'_, Bench>) -> Vec<LayeredClip> {
    harness.state().state().character.edits.layers.clone()
}

#[test]
fn a_layer_is_added_masked_raised_and_removed() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Motion.label());
    scrolled_to(&mut harness, text::ADD_LAYER);
    // The first clip plays, so the layer gets the second.
    let upper = [BodyPart::Torso, BodyPart::Head, BodyPart::LeftArm, BodyPart::RightArm];
    let layer = ClipLayer { mask: LayerMask::of_parts(&upper), ..ClipLayer::default() };
    let idle = LayeredClip { clip: IDLE, layer };
    assert_eq!(press(&mut harness, text::ADD_LAYER), [Command::SetLayers(vec![idle.clone()])]);
    assert!(harness.query_by_label(&text::layer_track("Idle")).is_some());
    scrolled_to(&mut harness, text::body_part(BodyPart::LeftArm));
    press(&mut harness, text::body_part(BodyPart::LeftArm));
    let name = text::labelled(text::LAYER_MODE, text::layer_mode(LayerMode::Additive));
    scrolled_to(&mut harness, &name);
    press(&mut harness, &name);
    let without_arm = LayerMask::of_parts(&[BodyPart::Torso, BodyPart::Head, BodyPart::RightArm]);
    let layer = ClipLayer { mask: without_arm, mode: LayerMode::Additive, ..ClipLayer::default() };
    let edited = LayeredClip { clip: IDLE, layer };
    assert_eq!(layers(&harness), std::slice::from_ref(&edited));
    scrolled_to(&mut harness, text::ADD_LAYER);
    press(&mut harness, text::ADD_LAYER);
    assert_eq!(layers(&harness), [edited.clone(), idle.clone()]);
    // The top layer can't be raised any further.
    let raise: Vec<_> = harness.get_all_by_label(text::RAISE_LAYER).collect();
    assert!(raise[0].accesskit_node().is_disabled() && !raise[1].accesskit_node().is_disabled());
    raise[1].scroll_to_me();
    harness.run();
    harness.get_all_by_label(text::RAISE_LAYER).nth(1).expect("two").click();
    harness.run();
    assert_eq!(layers(&harness), [idle.clone(), edited.clone()]);
    choose(&mut harness, text::EXPORT, text::SAVE_GLB);
    assert_eq!(harness.state().actions, [UiAction::Save(Saved::File(Export::Model { clip: ClipId::Own(0) }))]);
    harness.get_all_by_label(text::REMOVE_LAYER).nth(1).expect("two").click();
    harness.run();
    assert_eq!(layers(&harness), [edited]);
    for _ in 0..6 {
        press(&mut harness, text::UNDO_STEP);
    }
    assert!(layers(&harness).is_empty());
    assert!(harness.query_by_label(&text::layer_track("Idle")).is_none());
}

#[test]
fn a_new_layer_is_in_sight_and_has_the_focus() {
    for size in [WIDE, NARROW] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        harness.state_mut().panels.layout.tab = Tab::Motion;
        harness.run();
        for count in 1..=2 {
            scrolled_to(&mut harness, text::ADD_LAYER);
            press(&mut harness, text::ADD_LAYER);
            let chooser = harness.get_all_by_label(text::LAYER_CLIP).next().expect("a card");
            assert!(chooser.accesskit_node().is_focused(), "layer {count} on {size:?}");
            let (rect, timeline) = (chooser.rect(), harness.get_by_label(text::TIME).rect());
            assert!(rect.top() > 40.0 && rect.bottom() < timeline.top(), "layer {count} on {size:?}: {rect:?}");
            if size == WIDE {
                let last = harness.get_all_by_label(text::body_part(BodyPart::RightLeg)).next().expect("in the card");
                assert!(last.rect().bottom() < timeline.top(), "layer {count}: {:?}", last.rect());
            }
        }
    }
}

#[test]
fn a_long_name_leaves_the_panel_as_it_is() {
    let names = ["short".to_owned(), "a very long name of a clip ".repeat(4)];
    let mut harness = bench(WIDE, model_with_clips_named(names.into_iter()));
    press(&mut harness, Tab::Motion.label());
    let before = harness.state().viewport;
    scrolled_to(&mut harness, text::ADD_LAYER);
    press(&mut harness, text::ADD_LAYER);
    let whole = &harness.state().state().character.edits.layers[..];
    assert!(matches!(whole, [over] if over.layer.mask.is_all()), "a model without arms: {whole:?}");
    harness.run();
    assert_eq!(harness.state().viewport.x_range(), before.x_range());
}

#[test]
fn the_selected_joint_limits_a_layer_in_the_motion_tab() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    harness.state_mut().editor.apply(Command::SelectJoint(Some(5)));
    let wave = LayeredClip { clip: WAVE, layer: ClipLayer { weight: 0.25, ..ClipLayer::default() } };
    harness.state_mut().editor.apply(Command::SetLayers(vec![wave.clone()]));
    harness.run();
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, text::CLIP);
    let model = harness.state().library().active().expect("a model");
    let skeleton = &model.asset.skeleton;
    let below = text::below_joint(skeleton.name(skeleton.joint_of_source(5).expect("a joint")));
    scrolled_to(&mut harness, &below);
    press(&mut harness, &below);
    let mut limited = wave.clone();
    limited.layer.mask.joints.insert(5);
    assert_eq!(layers(&harness), [limited]);
    press(&mut harness, &below);
    assert_eq!(layers(&harness), [wave]);
}

#[test]
fn hundreds_of_layers_leave_most_of_the_window_to_the_viewport() {
    let mut harness = sample_bench(WIDE);
    harness.run();
    let before = harness.state().viewport.height();
    let layer = LayeredClip { clip: IDLE, layer: ClipLayer::default() };
    harness.state_mut().editor.apply(Command::SetLayers(vec![layer; 300]));
    harness.run();
    let taken = before - harness.state().viewport.height();
    assert!(taken > 100.0 && taken < 0.3 * WIDE[1], "{taken}");
}

#[test]
fn removing_a_layer_by_key_leaves_the_focus_at_the_button_that_adds_one() {
    let mut harness = sample_bench(WIDE);
    let layer = |clip| LayeredClip { clip, layer: ClipLayer::default() };
    harness.state_mut().editor.apply(Command::SetLayers(vec![layer(IDLE), layer(WAVE)]));
    press(&mut harness, Tab::Motion.label());
    for left in [vec![layer(WAVE)], vec![]] {
        scrolled_to(&mut harness, text::ADD_LAYER);
        harness.get_all_by_label(text::REMOVE_LAYER).last().expect("a layer").focus();
        harness.run();
        harness.key_press(egui::Key::Enter);
        harness.run();
        assert_eq!(layers(&harness), left);
        assert!(harness.get_by_label(text::ADD_LAYER).is_focused());
    }
}
