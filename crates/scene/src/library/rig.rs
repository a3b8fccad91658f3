//! The visible part of a skeleton: which joints count, the bones between them, and the root that carries the character.

use gaitway_character::anim::{Clip, JointIndex, Keys, model_from_joint};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::Bounds;
use gaitway_character::sort::sort_floats;
use glam::{Affine3A, Vec3};

/// "Real" joints are those of skins and the nodes between them; without a skin, those that clips animate; without a mesh, all but
/// containers and what is far from the body. Cameras, lights and hidden nodes are none unless they are in a skin. Computed once per
/// model.
#[derive(Debug, Default)]
pub struct Rig {
    real: Vec<bool>,
    bones: Vec<RigBone>,
    roots: Vec<Option<JointIndex>>,
    skin_joints: usize,
    /// Number of joints to report if there is neither a skin nor a mesh.
    bare_joints: usize,
}

/// A bone from a joint to one of its children; at the end of a chain, it has no tail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RigBone {
    /// The joint it starts from.
    pub head: JointIndex,
    /// The joint it ends at, a child of `head`.
    pub tail: Option<JointIndex>,
    /// It leads to something that moves a mesh. Others are controls, as of an inverse kinematics rig.
    pub deforms: bool,
}

impl Rig {
    pub(super) fn new(asset: &Asset) -> Self {
        let skeleton = &asset.skeleton;
        let in_skin = skin_flags(asset);
        let skin_joints = in_skin.iter().filter(|&&inside| inside).count();
        let mut real = in_skin.clone();
        let helpers = helpers(asset);
        if skin_joints == 0 {
            for channel in asset.clips.iter().flat_map(|clip| clip.channels()) {
                if !matches!(channel.keys, Keys::MorphWeights { .. }) {
                    real[channel.joint.get()] = true;
                }
            }
            if asset.instances.is_empty() {
                let animated = std::mem::replace(&mut real, vec![true; skeleton.len()]);
                drop_containers(asset, &animated, &mut real);
                drop_distant(asset, &mut real);
            }
            real.iter_mut().zip(&helpers).for_each(|(real, helper)| *real &= !helper);
        }
        fill_gaps(asset, &mut real);
        let deforming = deforming(asset, &real);
        let mut has_child = vec![false; skeleton.len()];
        let mut bones = Vec::new();
        for joint in skeleton.joints().filter(|joint| real[joint.get()]) {
            if let Some(parent) = skeleton.parent(joint).filter(|parent| real[parent.get()]) {
                has_child[parent.get()] = true;
                let deforms = deforming[parent.get()] && deforming[joint.get()];
                bones.push(RigBone { head: parent, tail: Some(joint), deforms });
            }
        }
        for joint in skeleton.joints().filter(|joint| real[joint.get()] && !has_child[joint.get()]) {
            bones.push(RigBone { head: joint, tail: None, deforms: deforming[joint.get()] });
        }
        let roots = asset.clips.iter().map(|clip| root_of_clip(asset, clip, &in_skin)).collect();
        let bare_joints = helpers.iter().filter(|helper| !**helper).count();
        Self { real, bones, roots, skin_joints, bare_joints }
    }

    /// Returns whether the joint is real; false if the index is out of range.
    pub fn is_real(&self, joint: JointIndex) -> bool {
        self.real.get(joint.get()).copied().unwrap_or(false)
    }

    /// Returns the bones between real joints, then one without a tail for each end of a chain.
    pub fn bones(&self) -> &[RigBone] {
        &self.bones
    }

    /// Whether some bones move no mesh.
    pub fn has_controls(&self) -> bool {
        self.bones.iter().any(|bone| !bone.deforms)
    }

    /// Number of distinct joints in the skins.
    pub fn skin_joints(&self) -> usize {
        self.skin_joints
    }

    /// Number of joints to report: those of the skins, or all of a skeleton without a mesh but cameras, lights and hidden nodes.
    pub fn joint_count(&self, asset: &Asset) -> usize {
        if self.skin_joints == 0 && asset.instances.is_empty() { self.bare_joints } else { self.skin_joints }
    }

    /// The root-motion joints of the asset's own clips.
    pub(super) fn roots(&self) -> &[Option<JointIndex>] {
        &self.roots
    }
}

/// Flags nodes that aren't joints: hidden ones, and those of cameras and lights. Flags none if there is nothing else.
fn helpers(asset: &Asset) -> Vec<bool> {
    let skeleton = &asset.skeleton;
    let mut helpers = vec![false; skeleton.len()];
    let mut hidden = vec![false; skeleton.len()];
    asset.hidden.iter().for_each(|joint| hidden[joint.get()] = true);
    let mut child_count = vec![0; skeleton.len()];
    skeleton.joints().filter_map(|joint| skeleton.parent(joint)).for_each(|parent| child_count[parent.get()] += 1);
    let carriers = asset.cameras.iter().map(|camera| camera.joint).chain(asset.lights.iter().map(|light| light.joint));
    for joint in carriers {
        helpers[joint.get()] = true;
        // Converted files hold cameras and lights in nameless nodes that turn them.
        let own = skeleton.parent(joint).filter(|_| skeleton.name(joint).is_empty());
        own.filter(|own| child_count[own.get()] == 1).into_iter().for_each(|own| helpers[own.get()] = true);
    }
    for joint in skeleton.joints() {
        hidden[joint.get()] |= skeleton.parent(joint).is_some_and(|parent| hidden[parent.get()]);
        helpers[joint.get()] |= hidden[joint.get()];
    }
    if helpers.iter().all(|helper| *helper) { vec![false; skeleton.len()] } else { helpers }
}

/// Unmarks nodes that only contain the animated joints of a skeleton without a mesh (`RootNode`, `Armature`). They stay
/// behind when a clip travels.
fn drop_containers(asset: &Asset, animated: &[bool], real: &mut [bool]) {
    let skeleton = &asset.skeleton;
    let mut contains_animated = vec![false; skeleton.len()];
    for joint in skeleton.joints().rev() {
        if (animated[joint.get()] || contains_animated[joint.get()])
            && let Some(parent) = skeleton.parent(joint)
        {
            contains_animated[parent.get()] = true;
        }
    }
    for joint in skeleton.joints() {
        let below_real = skeleton.parent(joint).is_some_and(|parent| real[parent.get()]);
        real[joint.get()] = below_real || animated[joint.get()] || !contains_animated[joint.get()];
    }
}

/// Maximum length of a bone, in median bone lengths. A longer one leads to something that isn't part of the body.
const MAX_BONE_LENGTH: f32 = 20.0;
/// Maximum distance of a few joints from the body they are part of, in body sizes.
const MAX_DISTANCE: f32 = 2.0;
/// A group of joints with at least this share of the body's counts at any distance.
const MIN_SHARE: f32 = 0.25;

/// Unmarks cameras, lights and the like in a skeleton without a mesh: a few joints far from the body.
fn drop_distant(asset: &Asset, real: &mut [bool]) {
    let skeleton = &asset.skeleton;
    let mut world_from_joint = Vec::with_capacity(skeleton.len());
    model_from_joint(skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut world_from_joint);
    let position = |joint: JointIndex| Vec3::from(world_from_joint[joint.get()].translation);
    let bone = |joint: JointIndex| {
        let parent = skeleton.parent(joint).filter(|parent| real[parent.get()])?;
        Some((parent, position(parent).distance(position(joint))))
    };
    let joints: Vec<JointIndex> = skeleton.joints().filter(|joint| real[joint.get()]).collect();
    let mut lengths: Vec<f32> = joints
        .iter()
        .filter_map(|&joint| bone(joint))
        .map(|(_, length)| length)
        .filter(|length| *length > 0.0)
        .collect();
    sort_floats(&mut lengths);
    let Some(&median) = lengths.get(lengths.len() / 2) else { return };
    // Of each joint, the first one of those that bones connect it to.
    let mut group: Vec<JointIndex> = skeleton.joints().collect();
    let mut sizes = vec![0_usize; skeleton.len()];
    for &joint in &joints {
        if let Some((parent, _)) = bone(joint).filter(|(_, length)| *length <= MAX_BONE_LENGTH * median) {
            group[joint.get()] = group[parent.get()];
        }
        sizes[group[joint.get()].get()] += 1;
    }
    let Some(&body) = joints.iter().max_by_key(|joint| sizes[joint.get()]) else { return };
    let bounds = Bounds::of(joints.iter().filter(|joint| group[joint.get()] == body).map(|&joint| position(joint)));
    let far = MAX_DISTANCE * bounds.diagonal();
    let is_near = |joint: JointIndex| position(joint).clamp(bounds.min, bounds.max).distance(position(joint)) <= far;
    let mut has_near = vec![false; skeleton.len()];
    joints.iter().for_each(|&joint| has_near[group[joint.get()].get()] |= is_near(joint));
    for joint in joints {
        let first = group[joint.get()].get();
        real[joint.get()] = has_near[first] || sizes[first] as f32 >= MIN_SHARE * sizes[body.get()] as f32;
    }
}

/// Marks joints between two real ones.
fn fill_gaps(asset: &Asset, real: &mut [bool]) {
    let skeleton = &asset.skeleton;
    let mut below_real = vec![false; skeleton.len()];
    for joint in skeleton.joints() {
        let parent = skeleton.parent(joint);
        below_real[joint.get()] = parent.is_some_and(|parent| real[parent.get()] || below_real[parent.get()]);
    }
    let mut above_real = vec![false; skeleton.len()];
    for joint in skeleton.joints().rev() {
        if (real[joint.get()] || above_real[joint.get()])
            && let Some(parent) = skeleton.parent(joint)
        {
            above_real[parent.get()] = true;
        }
    }
    for joint in 0..real.len() {
        real[joint] = real[joint] || (below_real[joint] && above_real[joint]);
    }
}

/// Marks real joints that move a mesh themselves or through a joint below, and the ends of limbs. Without a skin or a mesh, all.
fn deforming(asset: &Asset, real: &[bool]) -> Vec<bool> {
    // A skeleton alone, also one that a skin was made for, has nothing that could tell its bones from controls.
    if asset.skins.is_empty() || asset.instances.is_empty() {
        return real.to_vec();
    }
    let skeleton = &asset.skeleton;
    let mut moves_mesh = vec![false; skeleton.len()];
    for instance in &asset.instances {
        let Some(skin) = instance.skin.and_then(|skin| asset.skins.get(skin)) else {
            moves_mesh[instance.joint.get()] = true;
            continue;
        };
        for primitive in asset.meshes.get(instance.mesh).into_iter().flat_map(|mesh| &mesh.primitives) {
            let influences = &primitive.influences;
            for (&joint, _) in influences.joints.iter().zip(&influences.weights).filter(|(_, weight)| **weight > 0.0) {
                moves_mesh[skin.joints()[usize::from(joint)].get()] = true;
            }
        }
    }
    let (mut above, mut has_child) = (moves_mesh.clone(), vec![false; skeleton.len()]);
    for joint in skeleton.joints().rev().filter(|joint| real[joint.get()]) {
        if let Some(parent) = skeleton.parent(joint) {
            has_child[parent.get()] = true;
            above[parent.get()] |= above[joint.get()];
        }
    }
    let is_end = |joint: JointIndex| {
        !has_child[joint.get()] && skeleton.parent(joint).is_some_and(|parent| moves_mesh[parent.get()])
    };
    skeleton.joints().map(|joint| real[joint.get()] && (above[joint.get()] || is_end(joint))).collect()
}

/// Finds the joint whose travel is the character's in a clip for this asset.
pub(super) fn root_of(asset: &Asset, clip: &Clip) -> Option<JointIndex> {
    root_of_clip(asset, clip, &skin_flags(asset))
}

/// Whether each joint belongs to a skin.
fn skin_flags(asset: &Asset) -> Vec<bool> {
    let mut in_skin = vec![false; asset.skeleton.len()];
    for joint in asset.skins.iter().flat_map(|skin| skin.joints()) {
        in_skin[joint.get()] = true;
    }
    in_skin
}

fn root_of_clip(asset: &Asset, clip: &Clip, in_skin: &[bool]) -> Option<JointIndex> {
    let is_translated = |channel: &&gaitway_character::anim::Channel| match &channel.keys {
        Keys::Translation(values) => values.windows(2).any(|pair| pair[0] != pair[1]),
        _ => false,
    };
    let translated = || clip.channels().iter().filter(is_translated).map(|channel| channel.joint);
    // Parents come first, so the smallest index is a topmost joint.
    translated()
        .filter(|joint| in_skin[joint.get()])
        .min()
        .or_else(|| {
            // A node above the skin travels and carries all its joints along.
            translated().min()?;
            asset.skeleton.joints().find(|joint| in_skin[joint.get()])
        })
        .or_else(|| translated().min())
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::Rig;
    use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton, Transform};
    use gaitway_character::asset::{Asset, AssetParts, MeshInstance};
    use gaitway_character::mesh::{Geometry, Influences, Mesh, Skin};

    /// A body of two joints with an end, and beside it a target with its pole, all in the skin.
    #[test]
    fn bones_that_move_no_mesh_are_controls() {
        let names = ["Root", "Hips", "Head", "Head_End", "IK", "Pole"];
        let parents = [None, Some(0), Some(1), Some(2), Some(0), Some(4)];
        let joint = |(name, parent): (&str, Option<usize>)| Joint { name: name.to_owned(), parent, ..Joint::default() };
        let skeleton = Skeleton::new(names.into_iter().zip(parents).map(joint).collect()).expect("parents come first");
        let joints: Vec<JointIndex> = skeleton.joints().collect();
        let matrices = vec![Affine3A::IDENTITY; joints.len()];
        let skin = Skin::new("Skin".to_owned(), joints, matrices, skeleton.len()).expect("as many matrices");
        let influences =
            Influences { stride: 4, joints: [1, 2, 0, 0].repeat(3), weights: [0.5, 0.5, 0.0, 0.0].repeat(3) };
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let geometry =
            Geometry { file_vertices: 3, positions, indices: vec![0, 1, 2], influences, ..Geometry::default() };
        let parts = AssetParts {
            skeleton,
            meshes: vec![Mesh { primitives: vec![geometry], ..Mesh::default() }],
            skins: vec![skin],
            instances: vec![MeshInstance::new(JointIndex(0), 0, Some(0))],
            ..AssetParts::default()
        };
        let rig = Rig::new(&Asset::new(parts).expect("indices in range"));
        let names_of = |deforms: bool| {
            let ends = rig.bones().iter().filter(|bone| bone.deforms == deforms);
            ends.map(|bone| bone.tail.map_or("", |tail| names[tail.get()])).collect::<Vec<_>>()
        };
        assert_eq!(names_of(true), ["Hips", "Head", "Head_End", ""]);
        assert_eq!(names_of(false), ["IK", "Pole", ""]);
        assert!(rig.has_controls());
    }

    #[test]
    fn a_skeleton_with_a_skin_and_no_mesh_has_no_controls() {
        let joint = |parent| Joint { parent, ..Joint::default() };
        let skeleton = Skeleton::new([None, Some(0), Some(1)].map(joint).to_vec()).expect("parents come first");
        let joints: Vec<JointIndex> = skeleton.joints().collect();
        let skin = Skin::new("Skin".to_owned(), joints, vec![Affine3A::IDENTITY; 3], 3).expect("as many matrices");
        let parts = AssetParts { skeleton, skins: vec![skin], ..AssetParts::default() };
        let rig = Rig::new(&Asset::new(parts).expect("indices in range"));
        assert_eq!((rig.bones().len(), rig.has_controls()), (3, false));
    }

    /// A body of ten joints, and a camera with its target 150 m away: in a tree of its own or below the body's root, still or
    /// animated.
    #[test]
    fn far_cameras_are_not_part_of_a_motions_body() {
        for (is_below, is_animated) in [(false, false), (true, false), (false, true), (true, true)] {
            let joint = |name: &str, parent: Option<usize>, at: Vec3| Joint {
                name: name.to_owned(),
                parent,
                rest: Transform::from_translation(at),
                ..Joint::default()
            };
            let mut joints = vec![joint("Root", None, Vec3::ZERO), joint("Hips", Some(0), Vec3::Y)];
            (2..11).for_each(|at| joints.push(joint("Spine", Some(at - 1), 0.1 * Vec3::Y)));
            joints.push(joint("Camera", is_below.then_some(0), 150.0 * Vec3::Z));
            joints.push(joint("Target", Some(11), -0.5 * Vec3::Z));
            let skeleton = Skeleton::new(joints).expect("parents come first");
            let mut clip = ClipBuilder::new("clip", &skeleton);
            for animated in [Some(1), is_animated.then_some(0), is_animated.then_some(11)].into_iter().flatten() {
                let joint = JointIndex(animated);
                let keys = Keys::Translation(vec![skeleton.rest().local(joint).translation; 2]);
                clip.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).expect("a channel");
            }
            let parts = AssetParts { clips: vec![clip.build()], skeleton, ..AssetParts::default() };
            let asset = Asset::new(parts).expect("indices in range");
            let rig = Rig::new(&asset);
            let real: Vec<usize> = (1..13).filter(|&joint| rig.is_real(JointIndex(joint as u32))).collect();
            assert_eq!(real, (1..11).collect::<Vec<_>>(), "below {is_below}, animated {is_animated}");
        }
    }
}
