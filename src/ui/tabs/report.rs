//! The Info tab: the contents of the file, and its problems.

use std::collections::BTreeMap;

use egui::{RichText, Ui};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{Geometry, Mesh};
use gaitway_scene::editor::Export;
use gaitway_scene::library::{Finding, Model};

use super::facts::{about_node, fact};
use super::{animated, avatar, materials, performance, validation};
use crate::ui::text::grouped;
use crate::ui::{Layout, Output, Saved, Shown, UiAction, UiState, controls, style, text};

/// Further parts are not listed.
const MAX_PARTS: usize = 100;

pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    let asset: &Asset = &model.asset;
    // The app makes the thumbnails before the next frame.
    if local.info_model.replace(model.id).is_none() && local.host.thumbnails_of != Some(model.id) {
        ui.ctx().request_repaint();
    }
    contents(ui, model);
    warnings(ui, shown, model, &mut local.layout, out);
    validation::show(ui, shown, model, local, out);
    let lists = local.lists.of(model);
    avatar::facts(ui, shown, model);
    animated::show(ui, shown, model);
    parts(ui, asset);
    save(ui, asset, out);
    performance::show(ui, lists, &local.host);
    materials::show(ui, shown, model, lists, out);
    materials::images(ui, model, lists, &local.host);
    extensions(ui, asset);
}

fn contents(ui: &mut Ui, model: &Model) {
    let asset: &Asset = &model.asset;
    let primitives = || asset.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let size = model.rest_bounds().size();
    let rows = [
        (text::FORMAT, format_name(asset.format)),
        (text::NODES, grouped(asset.skeleton.len())),
        ("Skins", grouped(asset.skins.len())),
        ("Joints", grouped(model.rig().joint_count(asset))),
        ("Meshes", grouped(asset.meshes.len())),
        ("Primitives", grouped(primitives().count())),
        ("Vertices", grouped(asset.meshes.iter().map(Mesh::file_vertex_count).sum())),
        ("Triangles", grouped(primitives().map(Geometry::triangles).sum())),
        ("Materials", grouped(asset.materials.len())),
        ("Images", grouped(asset.images.len())),
        (text::CLIPS, grouped(asset.clips.len())),
        ("Cameras", grouped(asset.cameras.len())),
        ("Lights", grouped(asset.lights.len())),
        ("Size", size_text(size.to_array())),
    ];
    controls::section(ui, "CONTENTS");
    controls::card(ui, |ui| {
        for (name, value) in rows {
            fact(ui, name, &value);
        }
        if !asset.generator.is_empty() {
            fact(ui, "Generator", &asset.generator);
        }
    });
}

fn extensions(ui: &mut Ui, asset: &Asset) {
    controls::section(ui, "EXTENSIONS");
    if asset.extensions_used.is_empty() {
        controls::hint(ui, "None");
        return;
    }
    controls::card(ui, |ui| {
        for name in &asset.extensions_used {
            let required = asset.extensions_required.contains(name);
            fact(ui, name, if required { "required" } else { "" });
        }
    });
}

fn warnings(ui: &mut Ui, shown: &Shown<'_>, model: &Model, layout: &mut Layout, out: &mut Output) {
    controls::section(ui, text::WARNINGS);
    if model.findings().is_empty() {
        controls::hint(ui, text::NO_WARNINGS);
        return;
    }
    let mut by_code: BTreeMap<&str, Vec<&Finding>> = BTreeMap::new();
    for finding in model.findings() {
        by_code.entry(finding.warning.code()).or_default().push(finding);
    }
    let color = style::palette(ui).warning;
    for (code, findings) in by_code {
        let title = RichText::new(text::warning_title(code, findings.len())).color(color);
        egui::CollapsingHeader::new(title).id_salt(code).default_open(findings.len() <= 3).show(ui, |ui| {
            for finding in findings {
                about_node(ui, shown, model, &finding.warning.to_string(), finding.joint, layout, out);
            }
        });
    }
}

/// The named parts of the meshes.
fn parts(ui: &mut Ui, asset: &Asset) {
    let mut parts =
        asset.meshes.iter().flat_map(|mesh| mesh.part_names.iter().zip(&mesh.primitives)).take(MAX_PARTS).peekable();
    if parts.peek().is_none() {
        return;
    }
    controls::section(ui, "PARTS");
    controls::card(ui, |ui| {
        for (name, geometry) in parts {
            let name = if name.is_empty() { "unnamed" } else { name };
            fact(ui, name, &format!("{} triangles", grouped(geometry.triangles())));
        }
    });
}

/// Saves models of other formats as GLB.
fn save(ui: &mut Ui, asset: &Asset, out: &mut Output) {
    if asset.format != "obj" {
        return;
    }
    if asset.skins.is_empty() {
        controls::hint(ui, "Static model: opened without its .skel and .attach files.");
    }
    controls::section(ui, "SAVE AS GLB");
    for (label, posed) in [(text::SAVE_REST_POSE, false), (text::SAVE_CURRENT_POSE, true)] {
        let button = egui::Button::new(label).min_size(egui::vec2(ui.available_width(), 32.0));
        if ui.add(button).clicked() {
            out.actions.push(UiAction::Save(Saved::File(Export::FullModel { posed })));
        }
    }
    controls::hint(ui, "Includes all weights of each vertex, in sets of four, and your joint names.");
}

/// A format as it is written in prose.
fn format_name(format: &str) -> String {
    if format == "gltf" { "glTF".to_owned() } else { format.to_uppercase() }
}

/// Formats a size with the same decimals for all three axes, as many as suit the largest.
fn size_text(size: [f32; 3]) -> String {
    let largest = size.into_iter().fold(0.0, f32::max);
    let [x, y, z] = size.map(|length| match largest {
        100.0..1e6 => format!("{length:.1}"),
        0.01..100.0 => format!("{length:.3}"),
        _ => format!("{length:.1e}"),
    });
    format!("{x} × {y} × {z} m")
}

#[cfg(test)]
mod tests {
    use super::size_text;

    #[test]
    fn the_lengths_of_a_size_have_the_same_decimals() {
        assert_eq!(size_text([25.185, 79.029, 154.7]), "25.2 × 79.0 × 154.7 m");
        assert_eq!(size_text([0.5, 1.8, 0.25]), "0.500 × 1.800 × 0.250 m");
    }
}
