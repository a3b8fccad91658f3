//! Warnings about contents of the file that are not converted.

use gaitway_glb::Warnings;
use ufbx::Scene;

/// Warns about what ufbx had to correct and what glTF cannot represent.
pub fn add_scene(warnings: &mut Warnings, scene: &Scene) {
    let corrections = scene.metadata.warnings.as_ref();
    let is_name_damaged = is_name_damaged(scene);
    for (index, warning) in corrections.iter().enumerate() {
        if warning.type_ == ufbx::WarningType::BadUnicode && !is_name_damaged {
            continue;
        }
        let same = |other: &&ufbx::Warning| *other.description == *warning.description;
        if corrections[..index].iter().any(|other| same(&other)) {
            continue;
        }
        let count: usize = corrections.iter().filter(same).map(|warning| warning.count.max(1)).sum();
        let times = if count > 1 { format!(" ({count} times)") } else { String::new() };
        warnings.add(format!("Damaged FBX data corrected: {}{times}.", &*warning.description));
    }
    warnings.left_out(
        scene.nurbs_curves.count + scene.nurbs_surfaces.count + scene.nurbs_trim_surfaces.count,
        "NURBS object",
        "NURBS objects",
        "convert NURBS to polygons before exporting",
    );
    warnings.left_out(scene.line_curves.count, "line object", "line objects", "only meshes are converted");
    warnings.left_out(
        scene.cache_deformers.count,
        "geometry cache",
        "geometry caches",
        "bake the deformation to a skeleton or blend shapes",
    );
    let constraints = scene.constraints.as_ref().iter().filter(|constraint| constraint.active).count();
    warnings.left_out(
        constraints,
        "constraint",
        "constraints",
        "bake the animation before exporting if it moves wrongly",
    );
}

/// Returns whether text that is converted isn't UTF-8. Sound files, for one, often have paths in another encoding.
fn is_name_damaged(scene: &Scene) -> bool {
    use ufbx::ElementType::{AnimStack, BlendChannel, BlendShape, Camera, Light, Material, Mesh, Node};
    let is_damaged = |text: &str| text.contains(char::REPLACEMENT_CHARACTER);
    let is_named = |element: &ufbx::Element| {
        matches!(element.type_, AnimStack | BlendChannel | BlendShape | Camera | Light | Material | Mesh | Node)
    };
    (&scene.elements).into_iter().any(|element| is_named(element) && is_damaged(&element.name))
        || (&scene.textures).into_iter().any(|texture| is_damaged(&texture.relative_filename))
}
