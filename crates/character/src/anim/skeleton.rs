//! Skeletons: joint names, hierarchy and rest pose. Every node of a file is a joint of one skeleton, so all ancestors
//! of a joint are included, and meshes, cameras and lights are attached to joints.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

use super::joint::JointIndex;
use super::pose::Pose;
use super::reflection::Reflection;
use super::transform::Transform;

/// Input for building a skeleton; `parent` is an index into the same list.
#[derive(Debug, Clone, Default)]
pub struct Joint {
    /// May be empty and need not be unique.
    pub name: String,
    /// `None` for a root.
    pub parent: Option<usize>,
    /// Local rest transform.
    pub rest: Transform,
    /// Rest weights of the morph targets of the mesh on this joint, if any.
    pub morph_weights: Vec<f32>,
}

/// Why joints do not form a hierarchy. Indices are those of the list the skeleton is built from.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SkeletonError {
    /// A parent index is not in the list.
    #[error("joint {joint} has parent {parent}, but there are only {count} joints")]
    ParentOutOfRange {
        /// The child.
        joint: usize,
        /// Its parent index.
        parent: usize,
        /// Number of joints in the list.
        count: usize,
    },
    /// The parents of some joints form a cycle.
    #[error("joint {joint} is its own ancestor")]
    Cycle {
        /// A joint on the cycle.
        joint: usize,
    },
}

/// Joints sorted so that parents come before their children. Immutable once built.
#[derive(Debug, Clone, Default)]
pub struct Skeleton {
    names: Vec<String>,
    parents: Vec<Option<JointIndex>>,
    /// Whether each joint's name is unique, computed when a label is first needed.
    has_unique_name: OnceLock<Vec<bool>>,
    /// All joints with their parents, sorted by depth: the order of a pose's lanes.
    by_depth: Vec<(JointIndex, Option<JointIndex>)>,
    rest: Pose,
    reflection: Reflection,
    morph_ranges: Vec<Range<u32>>,
    /// Each joint's index in the list the skeleton was built from, and the inverse mapping.
    source_of_joint: Vec<u32>,
    joint_of_source: Vec<JointIndex>,
}

impl Skeleton {
    /// Sorts the joints depth first, siblings in the given order.
    pub fn new(joints: Vec<Joint>) -> Result<Self, SkeletonError> {
        let count = joints.len();
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut stack = Vec::new();
        for (index, joint) in joints.iter().enumerate() {
            match joint.parent {
                Some(parent) if parent >= count => {
                    return Err(SkeletonError::ParentOutOfRange { joint: index, parent, count });
                }
                Some(parent) => children[parent].push(index as u32),
                None => stack.push(index as u32),
            }
        }
        stack.reverse();
        let mut source_of_joint = Vec::with_capacity(count);
        while let Some(source) = stack.pop() {
            source_of_joint.push(source);
            stack.extend(children[source as usize].iter().rev());
        }
        let mut joint_of_source = vec![JointIndex(u32::MAX); count];
        for (joint, &source) in source_of_joint.iter().enumerate() {
            joint_of_source[source as usize] = JointIndex(joint as u32);
        }
        if let Some(unreached) = joint_of_source.iter().position(|index| index.0 == u32::MAX) {
            return Err(SkeletonError::Cycle { joint: first_on_cycle(&joints, unreached) });
        }
        let mut skeleton = Self { source_of_joint, joint_of_source, ..Self::default() };
        let (mut locals, mut morph_weights) = (Vec::with_capacity(count), Vec::new());
        for &source in &skeleton.source_of_joint {
            let joint = &joints[source as usize];
            skeleton.names.push(joint.name.clone());
            skeleton.parents.push(joint.parent.map(|parent| skeleton.joint_of_source[parent]));
            locals.push(joint.rest);
            let start = morph_weights.len() as u32;
            morph_weights.extend_from_slice(&joint.morph_weights);
            skeleton.morph_ranges.push(start..start + joint.morph_weights.len() as u32);
        }
        skeleton.by_depth = sorted_by_depth(&skeleton.parents);
        skeleton.rest = Pose::new(&locals, morph_weights, skeleton.by_depth.iter().map(|&(joint, _)| joint));
        skeleton.reflection = Reflection::of(&skeleton.parents, &skeleton.rest);
        Ok(skeleton)
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there are no joints.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// All joints, parents before their children.
    pub fn joints(&self) -> impl DoubleEndedIterator<Item = JointIndex> + ExactSizeIterator + use<> {
        (0..self.names.len() as u32).map(JointIndex)
    }

    /// The joint's name; may be empty and need not be unique.
    pub fn name(&self, joint: JointIndex) -> &str {
        &self.names[joint.get()]
    }

    /// Finds the first joint with this name, in the order of the source list.
    pub fn find(&self, name: &str) -> Option<JointIndex> {
        self.joint_of_source.iter().copied().find(|joint| self.names[joint.get()] == name)
    }

    /// The joint's parent; `None` for a root.
    pub fn parent(&self, joint: JointIndex) -> Option<JointIndex> {
        self.parents[joint.get()]
    }

    /// Parents of all joints; each index is smaller than the joint's own.
    pub fn parents(&self) -> &[Option<JointIndex>] {
        &self.parents
    }

    /// All joints with their parents, sorted by depth.
    pub(super) fn by_depth(&self) -> &[(JointIndex, Option<JointIndex>)] {
        &self.by_depth
    }

    /// Children of a joint, siblings in the order of the source list. Scans all joints.
    pub fn children(&self, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
        self.joints().filter(move |&child| self.parent(child) == Some(joint))
    }

    /// The rest pose, including the rest morph weights.
    pub fn rest(&self) -> &Pose {
        &self.rest
    }

    /// The reflection that puts the skeleton right, the identity unless most joints are mirrored at rest.
    pub fn reflection(&self) -> &Reflection {
        &self.reflection
    }

    /// Range of this joint's mesh in [`Pose::morph_weights`]; empty without morph targets.
    pub fn morph_range(&self, joint: JointIndex) -> Range<usize> {
        let range = &self.morph_ranges[joint.get()];
        range.start as usize..range.end as usize
    }

    /// Index of this joint in the list the skeleton was built from: a glTF node index, a BVH joint number.
    pub fn source_index(&self, joint: JointIndex) -> usize {
        self.source_of_joint[joint.get()] as usize
    }

    /// Returns a copy with some joints renamed, given by their source index.
    pub fn with_names<'a>(&self, names: impl Iterator<Item = (usize, &'a str)>) -> Self {
        let mut skeleton = Self { has_unique_name: OnceLock::new(), ..self.clone() };
        for (source, name) in names {
            if let Some(slot) = self.joint_of_source(source).and_then(|joint| skeleton.names.get_mut(joint.get())) {
                name.clone_into(slot);
            }
        }
        skeleton
    }

    /// Returns a joint's name, or `#NODE` if the name is empty or not unique, as in joint maps.
    pub fn label(&self, joint: JointIndex) -> String {
        let name = self.name(joint);
        let is_unique = self.has_unique_name.get_or_init(|| unique(&self.names))[joint.get()];
        if is_unique && !name.is_empty() { name.to_owned() } else { format!("#{}", self.source_index(joint)) }
    }

    /// Returns a copy whose rest pose has the local transforms of another pose; morph weights are unchanged.
    pub fn with_rest(&self, pose: &Pose) -> Self {
        let mut skeleton = self.clone();
        for (joint, local) in self.joints().zip(pose.locals()) {
            skeleton.rest.set_local(joint, local);
        }
        skeleton
    }

    /// The joint built from an entry of the source list; `None` if out of range. Inverse of [`Skeleton::source_index`].
    pub fn joint_of_source(&self, source: usize) -> Option<JointIndex> {
        self.joint_of_source.get(source).copied()
    }
}

/// Whether each name occurs once.
fn unique(names: &[String]) -> Vec<bool> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_default() += 1;
    }
    names.iter().map(|name| counts[name.as_str()] == 1).collect()
}

/// `parents` come before their children.
fn sorted_by_depth(parents: &[Option<JointIndex>]) -> Vec<(JointIndex, Option<JointIndex>)> {
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); parents.len()];
    let mut joints = Vec::with_capacity(parents.len());
    for (joint, parent) in (0..).zip(parents) {
        match parent {
            Some(parent) => children[parent.get()].push(joint),
            None => joints.push((JointIndex(joint), None)),
        }
    }
    let mut next = 0;
    while let Some(&(parent, _)) = joints.get(next) {
        joints.extend(children[parent.get()].iter().map(|&child| (JointIndex(child), Some(parent))));
        next += 1;
    }
    joints
}

/// Walks up from a joint that no root reaches, as the joint itself may merely be below the cycle.
fn first_on_cycle(joints: &[Joint], mut joint: usize) -> usize {
    let mut seen = vec![false; joints.len()];
    while !std::mem::replace(&mut seen[joint], true) {
        joint = joints[joint].parent.unwrap_or(joint);
    }
    joint
}
