//! A body without the mirroring of a node above it, such as an armature with a negative scale, for formats whose bones can't be
//! mirrored. See [`Reflection`](gaitway_character::anim::Reflection).

use gaitway_character::anim::{Clip, ClipBuilder, Keys, Pose, Skeleton};
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
                Keys::Scale(values) => reflection.change_scales(joint, channel.interpolation, values),
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
