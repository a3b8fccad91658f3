//! One design: panels and page share a theme, the interface has three sizes of text, and sheets have room for fingers.

use egui::{Color32, Shape, Theme};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{self, Sheet, Tab, text};
use gaitway_character::anim::{Joint, Skeleton};
use gaitway_character::asset::{Asset, Warning};
use gaitway_scene::library::Model;
use gaitway_scene::state::{Command, Show};

use crate::bench::{Bench, NARROW, WIDE, bench, motion_bench, press};

const THEME: &str = include_str!("../../web/theme.css");
const PAGE: &str = include_str!("../../web/index.html");
const MANIFEST: &str = include_str!("../../web/manifest.webmanifest");

/// The value of a custom property of the page.
fn value(name: &str) -> &'static str {
    let (_, rest) = THEME.split_once(&format!("  --{name}: ")).unwrap_or_else(|| panic!("no {name}"));
    rest.split_once(';').expect("a value").0
}

/// A colour of the page in the light and the dark theme.
fn colors(name: &str) -> [&'static str; 2] {
    let inner = value(name).strip_prefix("light-dark(").and_then(|value| value.strip_suffix(')'));
    inner.and_then(|value| value.split_once(", ")).map(|(light, dark)| [light, dark]).expect("two colours")
}

fn pixels(name: &str) -> f32 {
    value(name).trim_end_matches("px").parse().expect("a length")
}

#[test]
fn panels_have_the_colours_radii_and_sizes_of_the_page() {
    let context = egui::Context::default();
    ui::install(&context);
    let hex = |color: Color32| format!("#{:02x}{:02x}{:02x}", color.r(), color.g(), color.b());
    for (index, theme) in [Theme::Light, Theme::Dark].into_iter().enumerate() {
        let style = context.style_of(theme);
        let visuals = &style.visuals;
        for (name, color) in [
            ("panel", visuals.panel_fill),
            ("surface", visuals.extreme_bg_color),
            ("hover", visuals.widgets.hovered.bg_fill),
            ("pressed", visuals.widgets.active.bg_fill),
            ("line", visuals.window_stroke.color),
            ("text", visuals.widgets.inactive.fg_stroke.color),
            ("weak-text", visuals.weak_text_color.expect("a colour")),
            ("accent", visuals.hyperlink_color),
            ("on-accent", visuals.selection.stroke.color),
            ("warning", visuals.warn_fg_color),
            ("error", visuals.error_fg_color),
        ] {
            assert_eq!(hex(color), colors(name)[index], "{name} of {theme:?}");
        }
        assert_eq!(f32::from(visuals.widgets.inactive.corner_radius.nw), pixels("corner"));
        assert_eq!(f32::from(visuals.window_corner_radius.nw), pixels("window-corner"));
        assert_eq!(style.spacing.item_spacing.x, pixels("gap"));
        let mut sizes: Vec<f32> = style.text_styles.values().map(|font| font.size).collect();
        sizes.sort_by(f32::total_cmp);
        sizes.dedup();
        assert_eq!(sizes, ["small", "body", "heading"].map(pixels));
    }
    // Browsers colour their own bars before any style sheet has arrived.
    let [light, dark] = colors("panel");
    for (scheme, color) in [("light", light), ("dark", dark)] {
        let meta = format!(r#"content="{color}" media="(prefers-color-scheme: {scheme})""#);
        assert!(PAGE.contains(&meta), "{meta}");
    }
    assert!(MANIFEST.contains(&format!(r#""theme_color": "{dark}""#)));
}

fn collect_sizes(shape: &Shape, sizes: &mut Vec<f32>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect_sizes(shape, sizes)),
        Shape::Text(text) => sizes.extend(text.galley.job.sections.iter().map(|section| section.format.font_id.size)),
        _ => {}
    }
}

fn show(harness: &mut Harness<'_, Bench>, tab: Tab) {
    let layout = &mut harness.state_mut().panels.layout;
    (layout.tab, layout.sheet) = (tab, Some(Sheet::Inspector));
    harness.run();
}

fn check_sizes(harness: &Harness<'_, Bench>, place: &str) {
    let mut sizes = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| collect_sizes(&clipped.shape, &mut sizes));
    assert!(sizes.len() > 10, "{place}: {} texts", sizes.len());
    let allowed = ["small", "body", "heading"].map(pixels);
    assert!(sizes.iter().all(|size| allowed.contains(size)), "{place}: {sizes:?}");
}

#[test]
fn all_texts_have_one_of_three_sizes() {
    for size in [WIDE, NARROW] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        harness.state_mut().editor.apply(Command::SelectJoint(Some(3)));
        let overlays = Show { source: true, ..Show::default() };
        harness.state_mut().editor.apply(Command::SetShow(overlays));
        for tab in [Tab::Scene, Tab::Display, Tab::Info, Tab::Camera, Tab::Motion] {
            show(&mut harness, tab);
            check_sizes(&harness, tab.label());
        }
        for part in [text::OPTIONS, text::FIT, text::FILES] {
            // The table has scrolled to the selected joint.
            harness.get_by_label(part).scroll_to_me();
            harness.run();
            press(&mut harness, part);
            check_sizes(&harness, part);
        }
        harness.state_mut().panels.layout.sheet = Some(Sheet::Clips);
        harness.state_mut().panels.help.is_open = true;
        harness.run();
        check_sizes(&harness, "clips and keys");
    }
}

#[test]
fn controls_on_sheets_are_large_enough_for_fingers() {
    let least = pixels("touch");
    let check = |harness: &Harness<'_, Bench>, label: &str| {
        let height = harness.get_by_label(label).rect().height();
        assert!(height >= least, "{label}: {height}");
    };
    let joint = |name: &str| Joint { name: name.to_owned(), ..Joint::default() };
    let mut asset = Asset::from(Skeleton::new(vec![joint("First"), joint("Second")]).expect("two joints"));
    asset.warnings.push(Warning::MatrixNotDecomposable { node: "nodes[1]".to_owned() });
    let mut harness = bench(NARROW, Model::new("two.glb".to_owned(), asset, Vec::new()));
    show(&mut harness, Tab::Scene);
    check(&harness, Tab::Info.label());
    check(&harness, "Second");
    show(&mut harness, Tab::Display);
    check(&harness, text::SKELETON);
    check(&harness, text::RIGID);
    show(&mut harness, Tab::Info);
    check(&harness, &text::go_to("Second"));
}
