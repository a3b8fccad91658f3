//! A skeleton as recognition looks at it: which joints may be parts of a body, their names read, where they lie.

use std::collections::BTreeMap;

use glam::{Affine3A, Vec3};

use super::names::Name;
use super::words::{self, Word};
use crate::anim::{JointIndex, Pose, Skeleton, model_from_joint};
use crate::asset::Asset;

pub(super) struct Tree<'a> {
    pub skeleton: &'a Skeleton,
    pub names: Vec<Name>,
    /// What each name says; none for joints that cannot be parts of a body.
    pub words: Vec<Option<Word>>,
    /// False for nodes that only hold a mesh.
    pub usable: Vec<bool>,
    /// In model space, of the pose that looks most like a body at rest.
    pub places: Vec<Vec3>,
    children: Vec<Vec<JointIndex>>,
    /// One past the last joint that hangs under each: joints are in depth-first order.
    ends: Vec<u32>,
}

impl<'a> Tree<'a> {
    pub fn new(asset: &'a Asset) -> Self {
        let skeleton = &asset.skeleton;
        let mut names: Vec<Name> = skeleton.joints().map(|joint| Name::read(skeleton.name(joint))).collect();
        drop_shared_word(&mut names);
        let usable = usable(asset);
        let words =
            names.iter().zip(&usable).map(|(name, &usable)| if usable { words::read(name) } else { None }).collect();
        let mut children = vec![Vec::new(); skeleton.len()];
        let mut ends: Vec<u32> = (1..=skeleton.len() as u32).collect();
        for joint in skeleton.joints() {
            if let Some(parent) = skeleton.parent(joint).filter(|_| usable[joint.get()]) {
                children[parent.get()].push(joint);
            }
        }
        for joint in skeleton.joints().rev() {
            if let Some(parent) = skeleton.parent(joint) {
                ends[parent.get()] = ends[parent.get()].max(ends[joint.get()]);
            }
        }
        Self { skeleton, names, words, usable, places: places(skeleton, skeleton.rest()), children, ends }
    }

    pub fn word(&self, joint: JointIndex) -> Option<Word> {
        self.words[joint.get()]
    }

    pub fn place(&self, joint: JointIndex) -> Vec3 {
        self.places[joint.get()]
    }

    /// The joint itself, then its ancestors.
    pub fn upwards(&self, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
        std::iter::successors(Some(joint), |&joint| self.skeleton.parent(joint))
    }

    /// Whether `below` is `above` or hangs under it.
    pub fn is_under(&self, below: JointIndex, above: JointIndex) -> bool {
        (above.0..self.ends[above.get()]).contains(&below.0)
    }

    /// Where two chains meet.
    pub fn meeting(&self, a: JointIndex, b: JointIndex) -> Option<JointIndex> {
        self.upwards(a).find(|&joint| self.is_under(b, joint))
    }

    /// From `above` down to `below`, without `above` and with `below`; empty when `below` hangs elsewhere.
    pub fn path(&self, above: JointIndex, below: JointIndex) -> Vec<JointIndex> {
        if !self.is_under(below, above) {
            return Vec::new();
        }
        let mut path: Vec<JointIndex> = self.upwards(below).take_while(|&joint| joint != above).collect();
        path.reverse();
        path
    }

    /// Usable ones, as listed.
    pub fn children(&self, joint: JointIndex) -> &[JointIndex] {
        &self.children[joint.get()]
    }

    /// Takes the places from another pose.
    pub fn stand(&mut self, pose: &Pose) {
        self.places = places(self.skeleton, pose);
    }
}

/// So many of all names begin with the same word when it says nothing of the joint.
const SHARED: f32 = 0.6;

/// `hero_left_thigh`, `hero_head`: what most names begin with is the rig's, unless it is a part of the body.
fn drop_shared_word(names: &mut [Name]) {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names.iter().filter(|name| name.words.len() > 1) {
        *counts.entry(&name.words[0]).or_default() += 1;
    }
    let most = counts.into_iter().max_by_key(|&(_, count)| count);
    let Some((word, _)) = most.filter(|&(_, count)| count as f32 >= SHARED * names.len() as f32) else { return };
    let word = word.to_owned();
    if words::read(&Name { side: None, words: vec![word.clone()] }).is_none() {
        for name in names {
            name.drop_first(&word);
        }
    }
}

/// A node that holds a mesh is a part of the body only where a skin names it, or where nothing has a skin.
fn usable(asset: &Asset) -> Vec<bool> {
    let mut usable = vec![true; asset.skeleton.len()];
    if asset.skins.is_empty() {
        return usable;
    }
    for instance in &asset.instances {
        usable[instance.joint.get()] = false;
    }
    for joint in asset.skins.iter().flat_map(|skin| skin.joints()) {
        usable[joint.get()] = true;
    }
    usable
}

fn places(skeleton: &Skeleton, pose: &Pose) -> Vec<Vec3> {
    let mut model_from = Vec::new();
    model_from_joint(skeleton, &pose.locals, Affine3A::IDENTITY, &mut model_from);
    model_from.into_iter().map(|transform| transform.translation.into()).collect()
}
