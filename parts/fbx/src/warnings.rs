//! Warnings about contents of the file that are not converted.

use gaitway_glb::Warnings;
use ufbx::Scene;

/// Warns about what ufbx had to correct and what glTF cannot represent.
pub fn add_scene(warnings: &mut Warnings, scene: &Scene) {
    let corrections = scene.metadata.warnings.as_ref();
    for (index, warning) in corrections.iter().enumerate() {
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
