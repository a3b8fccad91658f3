//! Finds the joint chains of a quadruped or a winged biped by shape: legs that hang across the trunk, and what
//! continues the trunk in front of and behind them.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Asset;
use glam::Vec3;

use super::evidence::Evidence;
use super::shape::{Shape, Twins};
use super::tree::Tree;

/// A chain of an animal's joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Limb {
    /// From the hips to the joint that front legs or wings hang on.
    Spine,
    /// From there to the head.
    Head,
    Tail,
    LeftHindLeg,
    RightHindLeg,
    LeftFrontLeg,
    RightFrontLeg,
    LeftWing,
    RightWing,
}

/// Returns the chains of an animal, each from the trunk outwards; empty if the skeleton isn't one.
pub(crate) fn chains(asset: &Asset) -> BTreeMap<Limb, Vec<JointIndex>> {
    let (tree, evidence) = (Tree::new(asset), Evidence::new(asset));
    let shapes = evidence.poses.iter().take(2).map(|positions| Shape::new(&tree, &evidence, positions));
    let mut found = shapes.into_iter().map(|shape| animal(&shape).map(|animal| animal.chains(&shape)));
    found.find_map(|chains| chains).unwrap_or_default()
}

struct Animal {
    hips: JointIndex,
    hind: Twins,
    front: Twins,
    /// Whether `front` are legs of at least [`MIN_FRONT_LEG`], which rank above wings.
    has_front_legs: bool,
    /// From the hind legs to the front legs.
    forward: Vec3,
    left: Vec3,
}

/// Front legs of at least this share of the hind legs' length rank above wings.
const MIN_FRONT_LEG: f32 = 0.5;

/// The longest pairs of limbs that make an animal. Front legs rank above wings, which are longer on a dragon.
fn animal(shape: &Shape) -> Option<Animal> {
    let pairs = shape.limbs();
    let mut best: Option<Animal> = None;
    for hind in &pairs {
        for front in &pairs {
            let rank = |animal: &Animal| (animal.has_front_legs, animal.hind.length + animal.front.length);
            let is_better = |found: &Animal| best.as_ref().is_none_or(|best| rank(found) > rank(best));
            best = Animal::new(shape, hind, front).filter(is_better).or(best);
        }
    }
    best
}

impl Animal {
    /// None if the hind legs don't hang across the trunk, or the others are neither legs nor wings.
    fn new(shape: &Shape, hind: &Twins, front: &Twins) -> Option<Self> {
        let tree = shape.tree;
        let on_leg = |joint| hind.chains.iter().any(|chain| tree.is_under(joint, chain[0]));
        if front.base == hind.base || on_leg(front.base) || hind.chains[0].len() < 3 {
            return None;
        }
        let hips = shape.trunk_root(hind, front).filter(|&hips| hips != front.base)?;
        let forward = (shape.middle(front, 0) - shape.middle(hind, 0)).try_normalize()?;
        let down = hang(shape, hind)?;
        let up = (forward * down.dot(forward) - down).try_normalize()?;
        let hangs_across = down.dot(forward).abs() < 0.7;
        let is_leg = hang(shape, front).is_some_and(|front| front.dot(down) > 0.5);
        let has_front_legs = is_leg && front.length > MIN_FRONT_LEG * hind.length;
        let left = up.cross(forward);
        let animal = Self { hips, hind: hind.clone(), front: front.clone(), has_front_legs, forward, left };
        (hangs_across && (is_leg || animal.is_wing(shape, front))).then_some(animal)
    }

    /// Whether a pair reaches sideways more than down.
    fn is_wing(&self, shape: &Shape, twins: &Twins) -> bool {
        let chain = &twins.chains[0];
        let span = shape.position(chain[chain.len() - 1]) - shape.position(chain[0]);
        span.dot(self.left).abs() > 0.7 * span.length()
    }

    fn chains(&self, shape: &Shape) -> BTreeMap<Limb, Vec<JointIndex>> {
        use Limb::*;
        let tree = shape.tree;
        let mut found = BTreeMap::new();
        let spine = tree.path(self.hips, self.front.base);
        let outside = |children: &[JointIndex]| -> Vec<JointIndex> {
            let limbs = self.hind.chains.iter().chain(&self.front.chains);
            let taken: Vec<JointIndex> = limbs.map(|chain| chain[0]).chain(spine.iter().copied()).collect();
            let is_free = |child: &JointIndex| taken.iter().all(|&taken| !tree.is_under(taken, *child));
            children.iter().copied().filter(is_free).collect()
        };
        let ahead = |chain: &Vec<JointIndex>| chain.last().map_or(0.0, |&end| shape.position(end).dot(self.forward));
        let heads = outside(tree.children(self.front.base)).into_iter().map(|first| shape.unforked(first));
        if let Some(head) = heads.max_by(|a, b| ahead(a).total_cmp(&ahead(b)))
            && ahead(&head) > shape.position(self.front.base).dot(self.forward)
        {
            found.insert(Head, head);
        }
        let mut tails = outside(tree.children(self.hips));
        tails.extend(outside(tree.children(self.hind.base)));
        let tails = tails.into_iter().map(|first| shape.chain(first));
        if let Some(tail) = tails.min_by(|a, b| ahead(a).total_cmp(&ahead(b)))
            && ahead(&tail) < shape.position(self.hips).dot(self.forward)
        {
            found.insert(Tail, tail);
        }
        found.insert(Spine, std::iter::once(self.hips).chain(spine.iter().copied()).collect());
        let is_front_wing = self.is_wing(shape, &self.front);
        let mut put = |twins: &Twins, [left, right]: [Limb; 2]| {
            let is_first_left = shape.apart(twins).is_some_and(|line| line.dot(self.left) > 0.0);
            let sides = if is_first_left { [left, right] } else { [right, left] };
            for (limb, chain) in sides.into_iter().zip(&twins.chains) {
                found.insert(limb, chain.clone());
            }
        };
        put(&self.hind, [LeftHindLeg, RightHindLeg]);
        put(&self.front, if is_front_wing { [LeftWing, RightWing] } else { [LeftFrontLeg, RightFrontLeg] });
        let is_on_trunk = |twins: &&Twins| twins.base == self.hips || spine.contains(&twins.base);
        let is_other = |twins: &&Twins| [&self.hind, &self.front].iter().all(|own| own.chains[0] != twins.chains[0]);
        let pairs = if is_front_wing { Vec::new() } else { shape.limbs() };
        let is_long = |twins: &&Twins| twins.length > 0.4 * self.front.length && self.is_wing(shape, twins);
        if let Some(wings) = pairs.iter().filter(is_on_trunk).filter(is_other).find(is_long) {
            put(wings, [LeftWing, RightWing]);
        }
        found
    }
}

/// Direction in which a pair of limbs hangs.
fn hang(shape: &Shape, twins: &Twins) -> Option<Vec3> {
    (shape.middle(twins, twins.chains[0].len() - 1) - shape.middle(twins, 0)).try_normalize()
}
