//! Which objects of the scene the joints become.
//!
//! An FBX object is a bone or a mesh or a camera or a light, a glTF node all of that at once. What a joint can't be itself goes below
//! it; a skinned mesh goes where no joint moves it, since programs disagree about whether that counts.

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, Property};
use gaitway_character::asset::{Asset, SceneJoints};
use glam::{Affine3A, DMat4, DQuat, DVec3};

use crate::mesh::is_drawn;
use crate::names::Names;
use crate::objects::{Id, Objects, ROOT};
use crate::space::{Local, Space};

/// Difference between matrices, per their size, that counts as none.
const SAME_PLACE: f64 = 1e-4;

/// What an object is besides a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attribute {
    Bone,
    /// Nothing else.
    Group,
    /// Not an object at all.
    LeftOut,
    /// Index into the asset's instances.
    Mesh(usize),
    /// Index into the asset's cameras.
    Camera(usize),
    /// Index into the asset's lights.
    Light(usize),
}

/// An object of the scene.
#[derive(Debug)]
pub struct Model {
    pub id: Id,
    pub name: String,
    pub parent: Id,
    pub local: Local,
    pub attribute: Attribute,
    pub is_visible: bool,
}

/// The objects of the scene: first the joints'.
#[derive(Debug)]
pub struct Layout {
    pub models: Vec<Model>,
    /// World matrix of each joint at rest.
    pub worlds: Vec<DMat4>,
    /// Turned after each joint's own rotation: cameras and lights have other axes than glTF's.
    pub turns: Vec<DQuat>,
    /// World matrix of the object that holds each instance.
    pub of_instances: BTreeMap<usize, DMat4>,
    /// Whether the joint's own transform has an effect.
    pub is_placed: Vec<bool>,
}

/// What the file is made of.
#[derive(Debug, Clone, Copy)]
pub struct Contents<'a> {
    pub asset: &'a Asset,
    pub space: &'a Space,
    /// Without meshes, cameras and lights.
    pub clips_only: bool,
}

impl Layout {
    pub fn new(contents: Contents, objects: &mut Objects) -> Layout {
        let Contents { asset, space, .. } = contents;
        let skeleton = &asset.skeleton;
        let is_visible = SceneJoints::new(asset, asset.default_scene).visible;
        let is_bone = bones(asset);
        let is_animated = animated(asset);
        let mut attributes = Attributes::new(contents, &is_bone, &is_animated);
        let mut names = Names::default();
        let mut layout = Layout {
            models: Vec::with_capacity(skeleton.len()),
            worlds: Vec::with_capacity(skeleton.len()),
            turns: vec![DQuat::IDENTITY; skeleton.len()],
            of_instances: BTreeMap::new(),
            is_placed: vec![true; skeleton.len()],
        };
        for joint in skeleton.joints() {
            let index = joint.get();
            let local = space.local(index, &skeleton.rest().local(joint));
            let above = skeleton.parent(joint).map_or(DMat4::IDENTITY, |parent| layout.worlds[parent.get()]);
            layout.worlds.push(above * local.matrix());
            let (attribute, turn) = attributes.take(joint, is_bone[index]);
            layout.turns[index] = turn;
            let rotation = local.rotation * turn;
            let parent = skeleton.parent(joint).map_or(ROOT, |parent| layout.models[parent.get()].id);
            let name = names.unique(&attributes.name(joint, attribute));
            let local = Local { rotation, ..local };
            let id = objects.id();
            layout.models.push(Model { id, name, parent, local, attribute, is_visible: is_visible[index] });
            if let Attribute::Mesh(instance) = attribute {
                layout.of_instances.insert(instance, layout.worlds[index]);
            }
        }
        for (model, is_placed) in layout.models.iter().zip(&mut layout.is_placed) {
            *is_placed = model.attribute != Attribute::LeftOut;
        }
        layout.place_skinned(contents, &is_bone, &is_animated);
        for (joint, attribute) in std::mem::take(&mut attributes.others) {
            layout.add_below(contents, joint, attribute, &mut names, objects);
        }
        layout
    }

    /// Puts skinned meshes where their skin was bound, and away from joints that move.
    fn place_skinned(&mut self, contents: Contents, is_bone: &[bool], is_animated: &[bool]) {
        let Contents { asset, space, .. } = contents;
        let skeleton = &asset.skeleton;
        for joint in skeleton.joints() {
            let index = joint.get();
            let Attribute::Mesh(instance) = self.models[index].attribute else { continue };
            let Some(skin) = asset.instances[instance].skin else { continue };
            let world = bound_at(asset, skin, space, &self.worlds).unwrap_or(self.worlds[index]);
            let ancestors = || std::iter::successors(skeleton.parent(joint), |&joint| skeleton.parent(joint));
            let moves = ancestors().any(|above| is_bone[above.get()] || is_animated[above.get()]);
            let above = skeleton.parent(joint).filter(|_| !moves);
            let from_parent = above.map_or(world, |parent| self.worlds[parent.get()].inverse() * world);
            let below = Local::of(&from_parent).map(|local| (local, above));
            let (local, above) = below.or_else(|| Some((Local::of(&world)?, None))).unwrap_or((Local::IDENTITY, None));
            let parent = above.map_or(DMat4::IDENTITY, |parent| self.worlds[parent.get()]);
            self.models[index].local = local;
            self.models[index].parent = above.map_or(ROOT, |parent| self.models[parent.get()].id);
            self.of_instances.insert(instance, parent * local.matrix());
            self.is_placed[index] = false;
        }
    }

    /// Adds what a joint can't be itself.
    fn add_below(
        &mut self,
        contents: Contents,
        joint: JointIndex,
        attribute: Attribute,
        names: &mut Names,
        objects: &mut Objects,
    ) {
        let Contents { asset, space, .. } = contents;
        let own = &self.models[joint.get()];
        let (mut parent, is_visible) = (own.id, own.is_visible);
        let mut local = Local { rotation: axes_of(space, attribute), ..Local::IDENTITY };
        let mut name = own.name.clone();
        match attribute {
            Attribute::Mesh(instance) => {
                let placed = &asset.instances[instance];
                let mesh = &asset.meshes[placed.mesh].name;
                name = if mesh.is_empty() { format!("{name}_mesh") } else { mesh.clone() };
                let world = if let Some(skin) = placed.skin {
                    parent = ROOT;
                    let world = bound_at(asset, skin, space, &self.worlds).and_then(|world| Local::of(&world));
                    local = world.unwrap_or(Local::IDENTITY);
                    local.matrix()
                } else {
                    let unit = space.of_joint(joint.get());
                    local = Local::of(&space.matrix(&placed.joint_from_mesh, unit, unit)).unwrap_or(local);
                    self.worlds[joint.get()] * local.matrix()
                };
                self.of_instances.insert(instance, world);
            }
            Attribute::Camera(_) => name += "_camera",
            Attribute::Light(_) => name += "_light",
            Attribute::Bone | Attribute::Group | Attribute::LeftOut => {}
        }
        let id = objects.id();
        self.models.push(Model { id, name: names.unique(&name), parent, local, attribute, is_visible });
    }
}

/// What joints carry, until it is given out.
struct Attributes<'a> {
    contents: Contents<'a>,
    of_joints: BTreeMap<JointIndex, Vec<Carried>>,
    /// What a joint can't be itself.
    others: Vec<(JointIndex, Attribute)>,
    has_children: Vec<bool>,
    /// Leaves that do nothing but turn the axes of a camera or light back.
    is_left_out: Vec<bool>,
}

#[derive(Debug, Clone, Copy)]
struct Carried {
    attribute: Attribute,
    /// Whether a joint of glTF's axes carries it.
    has_own_axes: bool,
}

impl<'a> Attributes<'a> {
    fn new(contents: Contents<'a>, is_bone: &[bool], is_animated: &[bool]) -> Attributes<'a> {
        let Contents { asset, clips_only, .. } = contents;
        let skeleton = &asset.skeleton;
        let mut has_children = vec![false; skeleton.len()];
        for parent in skeleton.parents().iter().flatten() {
            has_children[parent.get()] = true;
        }
        let of_joints = BTreeMap::new();
        let is_left_out = vec![false; skeleton.len()];
        let mut attributes = Attributes { contents, of_joints, others: Vec::new(), has_children, is_left_out };
        if clips_only {
            return attributes;
        }
        for (index, instance) in asset.instances.iter().enumerate() {
            if is_drawn(&asset.meshes[instance.mesh]) {
                attributes.add(instance.joint, Attribute::Mesh(index), true);
            }
        }
        let cameras = asset.cameras.iter().enumerate();
        let cameras = cameras.map(|(index, camera)| (camera.joint, Attribute::Camera(index)));
        let lights = asset.lights.iter().enumerate();
        let lights = lights.map(|(index, light)| (light.joint, Attribute::Light(index)));
        let all: Vec<_> = cameras.chain(lights).collect();
        for (joint, attribute) in all {
            let is_free = |joint: JointIndex| !is_bone[joint.get()] && !is_animated[joint.get()];
            let parent = skeleton.parent(joint).filter(|parent| !is_bone[parent.get()] && is_free(joint));
            match parent.filter(|_| attributes.only_turns_back(joint, attribute)) {
                Some(parent) => {
                    attributes.is_left_out[joint.get()] = true;
                    attributes.add(parent, attribute, false);
                }
                None => attributes.add(joint, attribute, true),
            }
        }
        attributes
    }

    fn add(&mut self, joint: JointIndex, attribute: Attribute, has_own_axes: bool) {
        self.of_joints.entry(joint).or_default().push(Carried { attribute, has_own_axes });
    }

    /// Whether a joint is what Gaitway makes of a camera or light of an FBX file: a leaf without a name below it.
    fn only_turns_back(&self, joint: JointIndex, attribute: Attribute) -> bool {
        let Contents { asset, space, .. } = self.contents;
        let local = space.local(joint.get(), &asset.skeleton.rest().local(joint));
        let turned = (local.rotation * axes_of(space, attribute)).w.abs();
        let is_leaf = !self.has_children[joint.get()] && asset.skeleton.name(joint).is_empty();
        let is_here = local.translation.length() < 1e-9 && local.scale.abs_diff_eq(DVec3::ONE, 1e-6);
        !space.is_z_up && is_leaf && is_here && turned > 1.0 - 1e-9 && !self.of_joints.contains_key(&joint)
    }

    /// Returns what a joint is itself, and how that is turned; the rest goes below it.
    fn take(&mut self, joint: JointIndex, is_bone: bool) -> (Attribute, DQuat) {
        let Contents { asset, space, .. } = self.contents;
        if self.is_left_out[joint.get()] {
            return (Attribute::LeftOut, DQuat::IDENTITY);
        }
        let mut own = if is_bone { Attribute::Bone } else { Attribute::Group };
        let mut turn = DQuat::IDENTITY;
        for Carried { attribute, has_own_axes } in self.of_joints.remove(&joint).unwrap_or_default() {
            let is_leaf = !self.has_children[joint.get()];
            let fits = match attribute {
                Attribute::Mesh(instance) => {
                    let instance = &asset.instances[instance];
                    let is_here = instance.joint_from_mesh == Affine3A::IDENTITY;
                    if instance.skin.is_some() { is_leaf } else { is_here }
                }
                _ => is_leaf || !has_own_axes,
            };
            if own != Attribute::Group || !fits {
                self.others.push((joint, attribute));
                continue;
            }
            own = attribute;
            if has_own_axes {
                turn = axes_of(space, attribute);
            }
        }
        (own, turn)
    }

    fn name(&self, joint: JointIndex, attribute: Attribute) -> String {
        let Contents { asset, .. } = self.contents;
        let name = asset.skeleton.name(joint);
        let number = asset.skeleton.source_index(joint);
        let other = match attribute {
            Attribute::Mesh(instance) => asset.meshes[asset.instances[instance].mesh].name.as_str(),
            Attribute::Camera(camera) => asset.cameras[camera].name.as_str(),
            _ => "",
        };
        match (name.is_empty(), other.is_empty(), attribute) {
            (false, ..) => name.to_owned(),
            (_, false, _) => other.to_owned(),
            (.., Attribute::Bone) => format!("joint_{number}"),
            _ => format!("node_{number}"),
        }
    }
}

/// Returns the rotation that gives what looks along glTF's -Z FBX's axes: cameras look along +X, lights shine along -Y. It
/// replaces the change of axes of a joint's own space.
fn axes_of(space: &Space, attribute: Attribute) -> DQuat {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    match attribute {
        Attribute::Camera(_) => space.axes() * DQuat::from_xyzw(0.0, half, 0.0, half),
        Attribute::Light(_) => space.axes() * DQuat::from_xyzw(half, 0.0, 0.0, half),
        _ => DQuat::IDENTITY,
    }
}

/// Returns which joints are bones: those of skins, and what is between and below them. Without skins, all that carry nothing.
fn bones(asset: &Asset) -> Vec<bool> {
    let skeleton = &asset.skeleton;
    let mut carries = vec![false; skeleton.len()];
    let carriers = asset.instances.iter().map(|instance| instance.joint);
    let carriers = carriers.chain(asset.cameras.iter().map(|camera| camera.joint));
    carriers.chain(asset.lights.iter().map(|light| light.joint)).for_each(|joint| carries[joint.get()] = true);
    if asset.skins.is_empty() {
        let is_motion = asset.instances.is_empty();
        return carries.iter().map(|carries| is_motion && !carries).collect();
    }
    let mut is_bone = vec![false; skeleton.len()];
    asset.skins.iter().flat_map(|skin| skin.joints()).for_each(|joint| is_bone[joint.get()] = true);
    let mut has_bones_below = is_bone.clone();
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            has_bones_below[parent.get()] |= has_bones_below[joint.get()];
        }
    }
    for joint in skeleton.joints() {
        let below_bone = skeleton.parent(joint).is_some_and(|parent| is_bone[parent.get()]);
        is_bone[joint.get()] |= below_bone && (has_bones_below[joint.get()] || !carries[joint.get()]);
    }
    is_bone
}

/// Returns which joints a clip moves.
fn animated(asset: &Asset) -> Vec<bool> {
    let mut animated = vec![false; asset.skeleton.len()];
    for channel in asset.clips.iter().flat_map(|clip| clip.channels()) {
        animated[channel.joint.get()] |= channel.keys.property() != Property::MorphWeights;
    }
    animated
}

/// Returns the matrix that takes a skinned mesh to where its joints are at rest, if they agree about it: in most files, the skin was
/// bound in the rest pose.
fn bound_at(asset: &Asset, skin: usize, space: &Space, worlds: &[DMat4]) -> Option<DMat4> {
    let skin = &asset.skins[skin];
    let mut places = skin.joints().iter().zip(skin.joint_from_bind()).map(|(joint, joint_from_bind)| {
        worlds[joint.get()] * space.matrix(joint_from_bind, space.unit, space.of_joint(joint.get()))
    });
    let first = places.next()?;
    let columns = first.to_cols_array_2d();
    let size = columns.as_flattened().iter().fold(0.0_f64, |size, element| size.max(element.abs()));
    places.all(|place| place.abs_diff_eq(first, SAME_PLACE * size)).then_some(first)
}
