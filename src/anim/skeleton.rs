//! The hierarchy that moves: names, parents and the rest pose. All nodes of a file are joints of one skeleton, so every
//! ancestor of a joint is in it, and meshes, cameras and lights hang on joints too.

use std::ops::Range;

use super::{Pose, Transform};

/// Index of a joint in its skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointIndex(pub u32);

impl JointIndex {
    pub fn get(self) -> usize {
        self.0 as usize
    }
}

/// What a skeleton is built from: one joint, its parent given by position in the same list.
#[derive(Debug, Clone, Default)]
pub struct Joint {
    pub name: String,
    pub parent: Option<usize>,
    pub rest: Transform,
    /// Rest weights of the morph targets of the mesh that hangs on this joint; empty when there is none.
    pub morph_weights: Vec<f32>,
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SkeletonError {
    #[error("joint {joint} has parent {parent}, but there are only {count} joints")]
    ParentOutOfRange { joint: usize, parent: usize, count: usize },
    #[error("joint {joint} is its own ancestor")]
    Cycle { joint: usize },
}

/// Joints in an order where every parent comes before its children. Immutable once built.
#[derive(Debug, Clone, Default)]
pub struct Skeleton {
    names: Vec<String>,
    parents: Vec<Option<JointIndex>>,
    rest: Pose,
    morph_ranges: Vec<Range<u32>>,
    /// For each joint, its position in the list the skeleton was built from; and the inverse.
    source_of_joint: Vec<u32>,
    joint_of_source: Vec<JointIndex>,
}

impl Skeleton {
    /// Sorts the joints so that parents come first, keeping the given order otherwise (depth first, siblings as listed).
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
        if let Some(joint) = joint_of_source.iter().position(|index| index.0 == u32::MAX) {
            return Err(SkeletonError::Cycle { joint });
        }
        let mut skeleton = Self { source_of_joint, joint_of_source, ..Self::default() };
        for &source in &skeleton.source_of_joint {
            let joint = &joints[source as usize];
            skeleton.names.push(joint.name.clone());
            skeleton.parents.push(joint.parent.map(|parent| skeleton.joint_of_source[parent]));
            skeleton.rest.locals.push(joint.rest);
            let start = skeleton.rest.morph_weights.len() as u32;
            skeleton.rest.morph_weights.extend_from_slice(&joint.morph_weights);
            skeleton.morph_ranges.push(start..start + joint.morph_weights.len() as u32);
        }
        Ok(skeleton)
    }

    pub fn len(&self) -> usize {
        self.names.len()
    }

    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    pub fn joints(&self) -> impl DoubleEndedIterator<Item = JointIndex> + ExactSizeIterator + use<> {
        (0..self.names.len() as u32).map(JointIndex)
    }

    pub fn name(&self, joint: JointIndex) -> &str {
        &self.names[joint.get()]
    }

    /// The first joint with this name, in the order of the source list.
    pub fn find(&self, name: &str) -> Option<JointIndex> {
        self.joint_of_source.iter().copied().find(|joint| self.names[joint.get()] == name)
    }

    pub fn parent(&self, joint: JointIndex) -> Option<JointIndex> {
        self.parents[joint.get()]
    }

    /// Parents of all joints; each is smaller than the joint's own index.
    pub fn parents(&self) -> &[Option<JointIndex>] {
        &self.parents
    }

    pub fn children(&self, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
        self.joints().filter(move |&child| self.parent(child) == Some(joint))
    }

    pub fn rest(&self) -> &Pose {
        &self.rest
    }

    /// Where the morph weights of the mesh on this joint lie in [`Pose::morph_weights`]; empty when there are none.
    pub fn morph_range(&self, joint: JointIndex) -> Range<usize> {
        let range = &self.morph_ranges[joint.get()];
        range.start as usize..range.end as usize
    }

    /// Position of this joint in the list the skeleton was built from: a glTF node index, a BVH joint number.
    pub fn source_index(&self, joint: JointIndex) -> usize {
        self.source_of_joint[joint.get()] as usize
    }

    /// The same with other names for some joints, given by their position in the list the skeleton was built from.
    pub fn with_names<'a>(&self, names: impl Iterator<Item = (usize, &'a str)>) -> Self {
        let mut skeleton = self.clone();
        for (source, name) in names {
            if let Some(slot) = self.joint_of_source(source).and_then(|joint| skeleton.names.get_mut(joint.get())) {
                name.clone_into(slot);
            }
        }
        skeleton
    }

    /// The same with another rest pose: one local transform per joint.
    pub fn with_rest(&self, locals: &[Transform]) -> Self {
        let mut skeleton = self.clone();
        for (slot, local) in skeleton.rest.locals.iter_mut().zip(locals) {
            *slot = *local;
        }
        skeleton
    }

    pub fn joint_of_source(&self, source: usize) -> Option<JointIndex> {
        self.joint_of_source.get(source).copied()
    }
}
