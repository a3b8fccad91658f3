//! Everything in the Motion tab fits every screen.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{Tab, text};

use super::number;
use crate::bench::{Bench, NARROW, WIDE, motion_bench, press};

/// Checks that all controls are inside `screen` and none overlaps another.
fn check_fit(harness: &Harness<'_, Bench>, screen: egui::Rect, labels: &[&str]) {
    let rects: Vec<egui::Rect> = labels.iter().map(|label| harness.get_by_label(label).rect()).collect();
    for (at, (rect, label)) in rects.iter().zip(labels).enumerate() {
        assert!(screen.expand(0.5).contains_rect(*rect), "{label} at {rect:?} on {screen:?}");
        for (other, name) in rects[..at].iter().zip(labels) {
            assert!(!rect.shrink(0.5).intersects(*other), "{label} at {rect:?} over {name} at {other:?}");
        }
    }
}

#[test]
fn the_selected_joint_fits_every_screen() {
    for size in [NARROW, [360.0, 640.0], WIDE, [1920.0, 1080.0]] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        if size[0] < 700.0 {
            press(&mut harness, text::INSPECTOR);
        }
        press(&mut harness, Tab::Motion.label());
        let arm = number(&harness, "LeftUpperArm");
        harness.state_mut().change(|state| {
            state.selection.joint = Some(arm);
        });
        harness.run();
        let [translation, rotation, scale] = text::CHANNELS;
        let labels: [&str; 9] = [
            &text::source_of("LeftUpperArm"),
            text::LIST_SOURCES,
            text::CLEAR_SOURCE,
            &text::rotation_offset_about("X"),
            &text::rotation_offset_about("Y"),
            &text::rotation_offset_about("Z"),
            &text::ignore_channels(rotation),
            &text::ignore_channels(translation),
            &text::ignore_channels(scale),
        ];
        for label in labels {
            harness.get_by_label(label).scroll_to_me();
            harness.run();
            let rect = harness.get_by_label(label).rect();
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
        check_fit(&harness, egui::Rect::EVERYTHING, &labels);
    }
}

#[test]
fn everything_fits_on_a_narrow_screen() {
    for size in [NARROW, [360.0, 640.0]] {
        let mut harness = motion_bench(size, &["a-motion-with-a-rather-long-name.bvh", "b.bvh"]);
        press(&mut harness, text::INSPECTOR);
        press(&mut harness, Tab::Motion.label());
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let head = [
            text::MOTION_FILE,
            text::JOINTS,
            text::OPTIONS,
            text::FILES,
            text::PICK_IN_VIEWPORT,
            text::without_key(text::UNDO_KEY),
            text::without_key(text::REDO_KEY),
            text::REMATCH,
            text::SWAP_SIDES,
            text::CLEAR_MAP,
            &text::labelled(text::ORDER, text::BY_BODY),
            text::JOINT_FILTER,
        ];
        check_fit(&harness, screen, &head);
        press(&mut harness, text::FILES);
        check_fit(&harness, screen, &[text::SAVE_MAP, text::LOAD_MAP]);
        press(&mut harness, text::JOINTS);
        harness.get_by_label_contains(&text::follows("RightHand", "")).scroll_to_me();
        harness.run();
        harness.get_by_label_contains(&text::follows("RightHand", "")).click();
        harness.run();
        check_fit(&harness, screen, &[text::FOLLOW_NOTHING, text::CANCEL, text::SEARCH_SOURCES]);
    }
}
