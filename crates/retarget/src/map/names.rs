//! Looks up the joint names of a map file in a skeleton.

use std::collections::{BTreeMap, BTreeSet};

use gaitway_character::anim::{Clip, JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Side};
use gaitway_character::mesh::Skin;
use gaitway_character::sort::{collect_set, sort_by};

use super::error::MapError;
use super::file::SourceRef;
use super::resolve::source_joint;
use crate::recognize::Name;

/// Maximum number of similar names to suggest for one that is not found.
const MAX_SUGGESTIONS: usize = 3;

/// Minimum similarity of a suggested name, from 0 to 1.
const MIN_SIMILARITY: f64 = 0.6;

/// The joints of a file by name.
pub(super) struct Names<'a> {
    asset: &'a Asset,
    skeleton: &'a Skeleton,
    joints: BTreeMap<&'a str, Vec<JointIndex>>,
}

impl<'a> Names<'a> {
    pub fn new(asset: &'a Asset) -> Self {
        let skeleton = &asset.skeleton;
        let mut joints: BTreeMap<&str, Vec<JointIndex>> = BTreeMap::new();
        for joint in skeleton.joints() {
            joints.entry(skeleton.name(joint)).or_default().push(joint);
        }
        Self { asset, skeleton, joints }
    }

    fn named(&self, name: &str) -> &[JointIndex] {
        self.joints.get(name).map(Vec::as_slice).unwrap_or_default()
    }

    /// Returns the number of the joint with this name, or written as `#NODE`. A joint that is really called `#3` wins over
    /// node 3.
    pub fn find_target(&self, name: &str, path: &str) -> Result<usize, MapError> {
        let (path, name) = (path.to_owned(), name.to_owned());
        match (self.named(&name), name.strip_prefix('#')) {
            ([joint], _) => Ok(self.skeleton.source_index(*joint)),
            ([], Some(number)) => {
                let found = number.parse().ok().filter(|&number| self.skeleton.joint_of_source(number).is_some());
                let number = number.to_owned();
                found.ok_or(MapError::TargetOutOfRange { path, number, count: self.skeleton.len() })
            }
            ([], None) => Err(MapError::NoTarget { path, nearest: self.nearest(&name), name }),
            (same, _) => Err(MapError::AmbiguousTarget { path, name, numbers: self.numbers(same) }),
        }
    }

    /// Returns the number of a source joint.
    pub fn find_source(&self, source: &SourceRef, path: &str) -> Result<usize, MapError> {
        match source {
            SourceRef::Number(number) => {
                source_joint(self.skeleton, *number, path)?;
                Ok(*number)
            }
            SourceRef::Name(name) => self.source_by_name(name, path.to_owned()),
        }
    }

    fn source_by_name(&self, name: &str, path: String) -> Result<usize, MapError> {
        let name = name.to_owned();
        match self.named(&name) {
            [joint] => Ok(self.skeleton.source_index(*joint)),
            [] => Err(MapError::NoSource { path, nearest: self.nearest(&name), name }),
            same => Err(MapError::AmbiguousSource { path, name, numbers: self.numbers(same) }),
        }
    }

    /// The most similar names, best first; empty if none is similar enough. Nodes that only hold a mesh, a camera or a light are
    /// not suggested.
    fn nearest(&self, name: &str) -> Vec<String> {
        let wanted = [name.to_lowercase(), spelled_alike(name)];
        let moving = moving_joints(self.asset);
        let is_moving = |joints: &[JointIndex]| moving.is_empty() || joints.iter().any(|joint| moving.contains(joint));
        let mut scored: Vec<(f64, &str)> = self
            .joints
            .iter()
            .filter(|(other, joints)| !other.is_empty() && is_moving(joints))
            .map(|(&other, _)| {
                let others = [other.to_lowercase(), spelled_alike(other)];
                let scores = wanted.iter().zip(&others).map(|(wanted, other)| strsim::jaro_winkler(wanted, other));
                (scores.fold(0.0, f64::max), other)
            })
            .filter(|(score, _)| *score >= MIN_SIMILARITY)
            .collect();
        sort_by(&mut scored, |a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(b.1)));
        scored.into_iter().take(MAX_SUGGESTIONS).map(|(_, other)| other.to_owned()).collect()
    }

    /// The joints' numbers in the file.
    fn numbers(&self, joints: &[JointIndex]) -> Vec<usize> {
        let mut numbers: Vec<usize> = joints.iter().map(|&joint| self.skeleton.source_index(joint)).collect();
        sort_by(&mut numbers, Ord::cmp);
        numbers
    }
}

/// The name without the rig's prefix and separators, and with one word for each side.
fn spelled_alike(name: &str) -> String {
    let name = Name::read(name);
    let side = match name.side {
        Some(Side::Left) => "left",
        Some(Side::Right) => "right",
        None => "",
    };
    side.to_owned() + &name.key()
}

/// The joints that are in a skin or move in a clip.
fn moving_joints(asset: &Asset) -> BTreeSet<JointIndex> {
    let skinned = asset.skins.iter().flat_map(Skin::joints).copied();
    let animated = asset.clips.iter().flat_map(Clip::channels).map(|channel| channel.joint);
    collect_set(skinned.chain(animated))
}
