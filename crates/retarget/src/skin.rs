//! Which joints move skin.

use gaitway_character::asset::Asset;

/// Smaller weights are those that a painter has overlooked.
const MIN_WEIGHT: f32 = 0.1;

/// Returns for each joint whether it moves any vertex of a skin; `None` if no joint does.
pub fn moves_skin(asset: &Asset) -> Option<Vec<bool>> {
    let mut moves = vec![false; asset.skeleton.len()];
    for instance in &asset.instances {
        let Some(skin) = instance.skin else { continue };
        let joints = asset.skins[skin].joints();
        for geometry in &asset.meshes[instance.mesh].primitives {
            let influences = &geometry.influences;
            for (&slot, _) in
                influences.joints.iter().zip(&influences.weights).filter(|(_, weight)| **weight >= MIN_WEIGHT)
            {
                moves[joints[usize::from(slot)].get()] = true;
            }
        }
    }
    moves.contains(&true).then_some(moves)
}
