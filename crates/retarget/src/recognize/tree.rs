//! A skeleton prepared for recognition: which joints may belong to a body, the words in their names, their positions.

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, Pose, Skeleton, model_from_joint};
use gaitway_character::asset::Asset;
use glam::Vec3;

use super::languages;
use super::names::{Name, is_number};
use super::words::{self, Word};
use crate::pose::mirror_from_model;
use crate::skin::moves_skin;

pub(super) struct Tree<'a> {
    pub skeleton: &'a Skeleton,
    /// In English; empty for joints that are not usable.
    pub names: Vec<Name>,
    /// The word in each name; None for joints that cannot belong to a body.
    pub words: Vec<Option<Word>>,
    /// False for nodes that only carry a mesh.
    pub usable: Vec<bool>,
    /// Positions in model space, in the pose that looks most like a body at rest.
    pub positions: Vec<Vec3>,
    moves_skin: Option<Vec<bool>>,
    children: Vec<Vec<JointIndex>>,
    /// One past each joint's last descendant: joints are in depth-first order.
    ends: Vec<u32>,
}

impl<'a> Tree<'a> {
    pub fn new(asset: &'a Asset) -> Self {
        let skeleton = &asset.skeleton;
        let usable = usable(asset);
        // Attachments must not change how a rig's joints are read.
        let read =
            |joint: JointIndex| if usable[joint.get()] { Name::read(skeleton.name(joint)) } else { Name::default() };
        let mut names: Vec<Name> = skeleton.joints().map(read).collect();
        languages::translate(&mut names);
        drop_shared_words(&mut names);
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
        let positions = positions(skeleton, skeleton.rest());
        Self { skeleton, names, words, usable, positions, moves_skin: moves_skin(asset), children, ends }
    }

    pub fn word(&self, joint: JointIndex) -> Option<Word> {
        self.words[joint.get()]
    }

    /// Whether a joint moves any vertex; None without a skin.
    pub fn moves_skin(&self, joint: JointIndex) -> Option<bool> {
        self.moves_skin.as_ref().map(|moves| moves[joint.get()])
    }

    pub fn position(&self, joint: JointIndex) -> Vec3 {
        self.positions[joint.get()]
    }

    /// The joint, then its ancestors.
    pub fn upwards(&self, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
        std::iter::successors(Some(joint), |&joint| self.skeleton.parent(joint))
    }

    /// Whether `below` is `above` or one of its descendants.
    pub fn is_under(&self, below: JointIndex, above: JointIndex) -> bool {
        (above.0..self.ends[above.get()]).contains(&below.0)
    }

    /// The nearest common ancestor.
    pub fn meeting(&self, a: JointIndex, b: JointIndex) -> Option<JointIndex> {
        self.upwards(a).find(|&joint| self.is_under(b, joint))
    }

    /// The joints from `above` (excluded) down to `below` (included); empty if `below` is not a descendant.
    pub fn path(&self, above: JointIndex, below: JointIndex) -> Vec<JointIndex> {
        if !self.is_under(below, above) {
            return Vec::new();
        }
        let mut path: Vec<JointIndex> = self.upwards(below).take_while(|&joint| joint != above).collect();
        path.reverse();
        path
    }

    /// The usable children, in order.
    pub fn children(&self, joint: JointIndex) -> &[JointIndex] {
        &self.children[joint.get()]
    }

    /// Takes the positions from another pose.
    pub fn set_pose(&mut self, pose: &Pose) {
        self.positions = positions(self.skeleton, pose);
    }
}

/// A first or last word that at least this share of all names has in common says nothing about the joints.
const MIN_SHARED: f32 = 0.6;

/// Drops the first and the last word that most names share (`hero_left_thigh_env`, `hero_head_env`): they name the rig and
/// the kind of node, unless they are words for a part of the body.
fn drop_shared_words(names: &mut [Name]) {
    if let Some(word) = shared_word(names, |words| words.first()) {
        names.iter_mut().for_each(|name| name.drop_first(&word));
    }
    if let Some(word) = shared_word(names, |words| words.last()) {
        names.iter_mut().for_each(|name| name.drop_last(&word));
    }
}

fn shared_word(names: &[Name], of: fn(&[String]) -> Option<&String>) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for word in names.iter().filter(|name| name.words.len() > 1).filter_map(|name| of(&name.words)) {
        *counts.entry(word).or_default() += 1;
    }
    let named = names.iter().filter(|name| !name.words.is_empty()).count();
    let (word, count) = counts.into_iter().max_by_key(|&(_, count)| count)?;
    let says_nothing = words::read(&Name { side: None, words: vec![word.to_owned()] }).is_none() && !is_number(word);
    (count as f32 >= MIN_SHARED * named as f32 && says_nothing).then(|| word.to_owned())
}

/// A node that carries a mesh is usable only if a skin names it, or if there is no skin at all.
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

fn positions(skeleton: &Skeleton, pose: &Pose) -> Vec<Vec3> {
    let mut model_from = Vec::new();
    model_from_joint(skeleton, pose, mirror_from_model(skeleton), &mut model_from);
    model_from.into_iter().map(|transform| transform.translation.into()).collect()
}
