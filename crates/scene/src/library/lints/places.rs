//! From a place in a file to the node that it concerns.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Asset;

/// Returns the node that a place such as `nodes[3].scale` or `/meshes/0/primitives/1` concerns: the node itself, a joint of the
/// skin (the first one, unless the place names another), or the first node that draws the mesh or the material. `None` for other
/// places, and for meshes and materials that no node draws.
pub fn joint_of_place(asset: &Asset, place: &str) -> Option<JointIndex> {
    let mut words = place.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let (list, index) = (words.next()?, words.next()?.parse().ok()?);
    let first_drawing = |uses: &dyn Fn(usize) -> bool| {
        asset.instances.iter().find(|instance| uses(instance.mesh)).map(|instance| instance.joint)
    };
    match list {
        "nodes" => asset.skeleton.joint_of_source(index),
        "meshes" => first_drawing(&|mesh| mesh == index),
        "materials" => {
            let is_in_mesh = |mesh: usize| {
                let mut primitives = asset.meshes[mesh].primitives.iter();
                primitives.any(|geometry| {
                    geometry.material == Some(index) || geometry.variants.iter().any(|&(_, material)| material == index)
                })
            };
            first_drawing(&is_in_mesh)
        }
        "skins" => {
            let joints = asset.skins.get(index)?.joints();
            let joint = words.next().filter(|word| *word == "joints").and(words.next());
            joints.get(joint.map_or(Ok(0), str::parse).ok()?).copied()
        }
        _ => None,
    }
}
