//! A body without the mirroring of a node above it, such as an armature with a negative scale, for formats whose bones can't be
//! mirrored. See [`Reflection`](gaitway_character::anim::Reflection).

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys, Pose, Skeleton};
use gaitway_character::asset::Asset;
use glam::Vec3;

/// The parts of an asset that are written, in the mirror if the asset is mirrored.
pub struct Body {
    pub skeleton: Skeleton,
    /// The reference pose.
    pub reference: Pose,
    pub clip: Clip,
    /// The direction that the body faces.
    pub forward: Option<Vec3>,
}

impl Body {
    pub fn new(asset: &Asset, clip: &Clip, forward: Option<Vec3>) -> Self {
        let reflection = asset.skeleton.reflection();
        let (skeleton, mut reference) = (asset.skeleton.clone(), asset.reference_pose());
        if reflection.is_identity() {
            return Self { skeleton, reference, clip: clip.clone(), forward };
        }
        let mut rest = skeleton.rest().clone();
        for joint in skeleton.joints().filter(|&joint| reflection.changes(joint)) {
            let local = reflection.transform(joint, &rest.local(joint));
            rest.set_local(joint, local);
            // The mirroring node is above the body and not part of its bind pose.
            reference.set_local(joint, local);
        }
        let mut builder = ClipBuilder::new(clip.name(), &skeleton);
        for channel in clip.channels() {
            let (joint, mut keys) = (channel.joint, channel.keys.clone());
            match &mut keys {
                Keys::Scale(values) => {
                    let in_mirror = |scale: Vec3| reflection.scale(joint, scale.as_dvec3()).as_vec3();
                    if channel.interpolation == Interpolation::CubicSpline {
                        values.chunks_exact_mut(3).for_each(|key| mirror_scale_key(key, in_mirror));
                    } else {
                        values.iter_mut().for_each(|scale| *scale = in_mirror(*scale));
                    }
                }
                keys => reflection.change_keys(joint, keys),
            }
            let times = &clip.timelines()[channel.timeline as usize];
            let added = builder.channel(joint, channel.interpolation, times, keys);
            // Except for signs, they are those of a valid clip.
            debug_assert!(added.is_ok(), "{added:?}");
        }
        let clip = builder.build().with_properties_of(clip, &Some);
        let forward = forward.map(|forward| forward * Vec3::new(-1.0, 1.0, 1.0));
        Self { skeleton: skeleton.with_rest(&rest), reference, clip, forward }
    }
}

/// Mirrors a key of a spline: its in-tangent, value and out-tangent. Tangents have any sign, so they turn round where the value
/// does.
fn mirror_scale_key(key: &mut [Vec3], in_mirror: impl Fn(Vec3) -> Vec3) {
    let [before, value, after] = key else { return };
    let mirrored = in_mirror(*value);
    let signs = Vec3::select(mirrored.cmpeq(*value), Vec3::ONE, Vec3::NEG_ONE);
    (*before, *value, *after) = (*before * signs, mirrored, *after * signs);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_of_a_scale_turn_round_where_the_scale_does() {
        let mut key = [Vec3::new(-0.5, -0.5, 2.0), Vec3::new(-1.0, 1.0, 1.0), Vec3::new(0.25, -0.25, 3.0)];
        mirror_scale_key(&mut key, Vec3::abs);
        assert_eq!(key, [Vec3::new(0.5, -0.5, 2.0), Vec3::ONE, Vec3::new(-0.25, -0.25, 3.0)]);
    }
}
