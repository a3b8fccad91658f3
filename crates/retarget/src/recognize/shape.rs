//! The shape of a body: two legs that hang on one joint, a trunk that goes the other way from there, two arms and a head at
//! its end. Pairs of limbs are found by equal lengths, which no pose changes.

use gaitway_character::anim::JointIndex;
use gaitway_character::sort::sort_by;
use glam::Vec3;

use super::evidence::Evidence;
use super::tree::Tree;

/// Maximum number of limbs on a joint and of joints in a limb. Keeps the search short in large scenes.
const MAX_COUNT: usize = 16;

/// Maximum number of pairs of limbs that are considered, longest first.
const MAX_PAIRS: usize = 32;

/// Maximum distance of the hips above the joint that the legs hang on.
const MAX_HIPS_ABOVE: usize = 3;

/// How much of the way from the feet to the shoulders of a body that hangs from its chest goes up.
const MIN_HANGING_RISE: f32 = 0.5;

/// Two limbs that mirror each other, and the joint they hang on.
#[derive(Debug, Clone)]
pub(super) struct Twins {
    pub base: JointIndex,
    /// Of equal length.
    pub chains: [Vec<JointIndex>; 2],
    /// Mean length of the chains.
    pub length: f32,
}

/// A skeleton in one pose.
pub(super) struct Shape<'a> {
    pub tree: &'a Tree<'a>,
    pub evidence: &'a Evidence,
    pub positions: &'a [Vec3],
    /// Length of the longest path down from each joint.
    reach: Vec<f32>,
}

/// Lower and upper half of a body.
pub(super) struct Halves {
    pub hips: JointIndex,
    pub legs: Twins,
    /// From the joint above the hips up to the one that the arms hang on.
    pub trunk: Vec<JointIndex>,
    pub arms: Twins,
    /// From the joint above the arms to the end of the head.
    pub head: Vec<JointIndex>,
    /// From the feet to the shoulders.
    pub up: Vec3,
    /// From the second leg to the first, perpendicular to `up`.
    pub across: Vec3,
}

impl<'a> Shape<'a> {
    pub fn new(tree: &'a Tree, evidence: &'a Evidence, positions: &'a [Vec3]) -> Self {
        let mut shape = Self { tree, evidence, positions, reach: vec![0.0; positions.len()] };
        for joint in tree.skeleton.joints().rev().filter(|joint| tree.usable[joint.get()]) {
            if let Some(parent) = tree.skeleton.parent(joint) {
                let reach = shape.reach[joint.get()] + shape.distance(parent, joint);
                shape.reach[parent.get()] = shape.reach[parent.get()].max(reach);
            }
        }
        shape
    }

    pub fn position(&self, joint: JointIndex) -> Vec3 {
        self.positions[joint.get()]
    }

    pub fn distance(&self, a: JointIndex, b: JointIndex) -> f32 {
        self.position(a).distance(self.position(b))
    }

    /// Length of the path along a chain.
    pub fn length(&self, chain: &[JointIndex]) -> f32 {
        chain.windows(2).map(|pair| self.distance(pair[0], pair[1])).sum()
    }

    /// The joint and what follows it, along the longest path where it forks. A tip that no skin references is left out.
    pub fn chain(&self, first: JointIndex) -> Vec<JointIndex> {
        let way = |from: JointIndex, to: JointIndex| self.distance(from, to) + self.reach[to.get()];
        let longest = |at: &JointIndex| {
            let children = self.tree.children(*at).iter().copied();
            children.max_by(|&a, &b| way(*at, a).total_cmp(&way(*at, b)).then(b.cmp(&a)))
        };
        let mut chain: Vec<JointIndex> = std::iter::successors(Some(first), longest).take(MAX_COUNT).collect();
        let end = chain[chain.len() - 1];
        if chain.len() > 1 && self.tree.children(end).is_empty() && self.evidence.is_skinned(end) == Some(false) {
            chain.pop();
        }
        chain
    }

    /// The pairs of chains on a joint whose segments have equal lengths, as far as they do.
    fn twins(&self, base: JointIndex) -> Vec<Twins> {
        let children = self.tree.children(base);
        if !(2..=MAX_COUNT).contains(&children.len()) {
            return Vec::new();
        }
        let chains: Vec<Vec<JointIndex>> = children.iter().map(|&child| self.chain(child)).collect();
        let mut found = Vec::new();
        for (at, a) in chains.iter().enumerate() {
            for b in &chains[at + 1..] {
                found.extend(self.pair_up(base, a, b));
            }
        }
        found
    }

    fn pair_up(&self, base: JointIndex, a: &[JointIndex], b: &[JointIndex]) -> Option<Twins> {
        let whole = self.reach[base.get()];
        let mut length = 0.0;
        let mut above = [base, base];
        let mut count = 0;
        for (&a, &b) in a.iter().zip(b) {
            let segments = [self.distance(above[0], a), self.distance(above[1], b)];
            if (segments[0] - segments[1]).abs() > 0.12 * segments[0].max(segments[1]) + 0.03 * whole {
                break;
            }
            length += 0.5 * (segments[0] + segments[1]);
            above = [a, b];
            count += 1;
        }
        let twins = Twins { base, chains: [a[..count].to_vec(), b[..count].to_vec()], length };
        (count >= 2 && length > 0.0 && self.apart(&twins).is_some()).then_some(twins)
    }

    /// All pairs of limbs, the longest first.
    pub fn limbs(&self) -> Vec<Twins> {
        let mut pairs: Vec<Twins> = self.tree.skeleton.joints().flat_map(|joint| self.twins(joint)).collect();
        sort_by(&mut pairs, |a, b| b.length.total_cmp(&a.length).then(a.base.cmp(&b.base)));
        pairs.truncate(MAX_PAIRS);
        pairs
    }

    /// The joint that legs and trunk meet in: the legs' own or one above it.
    pub fn trunk_root(&self, legs: &Twins, arms: &Twins) -> Option<JointIndex> {
        self.tree.upwards(legs.base).take(MAX_HIPS_ABOVE).find(|&hips| self.tree.is_under(arms.base, hips))
    }

    /// The joint and what follows it, up to the joint where the chain forks.
    pub fn unforked(&self, first: JointIndex) -> Vec<JointIndex> {
        let next = |at: &JointIndex| match self.tree.children(*at) {
            [only] => Some(*only),
            _ => None,
        };
        std::iter::successors(Some(first), next).take(MAX_COUNT).collect()
    }

    /// Direction from the second chain to the first, where they first separate.
    pub fn apart(&self, twins: &Twins) -> Option<Vec3> {
        let [a, b] = &twins.chains;
        let line = a.iter().zip(b).map(|(&a, &b)| self.position(a) - self.position(b));
        line.into_iter().find(|line| line.length() > 0.02 * twins.length)?.try_normalize()
    }

    /// Midpoint of the two joints at the same place in the chains of a pair.
    pub fn middle(&self, twins: &Twins, at: usize) -> Vec3 {
        let [a, b] = twins.chains.each_ref().map(|chain| self.position(chain[at]));
        a.midpoint(b)
    }
}

/// The longest legs and arms that make an upright body.
pub(super) fn halves(shape: &Shape) -> Option<Halves> {
    let pairs = shape.limbs();
    let mut best: Option<Halves> = None;
    for legs in pairs.iter().filter(|legs| legs.chains[0].len() >= 3) {
        for arms in &pairs {
            let length = |halves: &Halves| halves.legs.length + halves.arms.length;
            if best.as_ref().is_none_or(|best| legs.length + arms.length > length(best)) {
                best = body(shape, legs, arms).or(best);
            }
        }
    }
    best
}

/// None if these legs and arms don't make an upright body with a head.
fn body(shape: &Shape, legs: &Twins, arms: &Twins) -> Option<Halves> {
    let tree = shape.tree;
    let on_leg = |joint| legs.chains.iter().any(|chain| tree.is_under(joint, chain[0]));
    if arms.base == legs.base || on_leg(arms.base) || !(0.3..3.0).contains(&(arms.length / legs.length)) {
        return None;
    }
    let root = shape.trunk_root(legs, arms)?;
    // A body may also hang from its chest.
    let hangs = root == arms.base;
    let (hips, trunk, hip) = if hangs {
        let above = tree.upwards(legs.base).skip(1).take_while(|&joint| tree.is_under(joint, root));
        (legs.base, above.collect(), shape.middle(legs, 0))
    } else {
        (root, tree.path(root, arms.base), shape.position(legs.base))
    };
    let shoulder = shape.middle(arms, 0);
    let feet = shape.middle(legs, legs.chains[0].len() - 1);
    let down = (feet - hip).try_normalize()?;
    let up = (shoulder - feet).try_normalize()?;
    // So may an animal, but level.
    let is_upright = (shoulder - hip).try_normalize()?.dot(down) < -0.6
        && (!hangs || rise_at_rest(shape, legs, arms) > MIN_HANGING_RISE);
    let line = shape.apart(legs)?;
    let across = (line - up * line.dot(up)).try_normalize()?;
    let is_parallel = shape.apart(arms)?.dot(across).abs() > 0.7;
    if trunk.is_empty() || !is_upright || !is_parallel || shoulder.distance(hip) < 0.15 * legs.length {
        return None;
    }
    let head = head(shape, legs, arms, up)?;
    Some(Halves { hips, legs: legs.clone(), trunk, arms: arms.clone(), head, up, across })
}

/// The share of the way from feet to shoulders that goes up, at rest.
fn rise_at_rest(shape: &Shape, legs: &Twins, arms: &Twins) -> f32 {
    let middle = |ends: [Option<&JointIndex>; 2]| {
        let [a, b] = ends.map(|joint| joint.map_or(Vec3::ZERO, |joint| shape.evidence.poses[0][joint.get()]));
        a.midpoint(b)
    };
    let feet = middle(legs.chains.each_ref().map(|chain| chain.last()));
    let shoulders = middle(arms.chains.each_ref().map(|chain| chain.first()));
    (shoulders - feet).normalize_or_zero().y
}

/// The chain above the arms, up to the joint where it forks.
fn head(shape: &Shape, legs: &Twins, arms: &Twins, up: Vec3) -> Option<Vec<JointIndex>> {
    let below = |joint: JointIndex| {
        let below =
            shape.tree.skeleton.joints().skip(joint.get()).take_while(move |&other| shape.tree.is_under(other, joint));
        below.filter(|joint| shape.tree.usable[joint.get()])
    };
    let top =
        |joint: JointIndex| below(joint).map(|joint| shape.position(joint).dot(up)).fold(f32::NEG_INFINITY, f32::max);
    // A head without a neck may turn about the very point the arms hang on.
    let skin_top = |joint: JointIndex| {
        let regions = below(joint).filter_map(|joint| shape.evidence.region(joint));
        regions.map(|region| region.min.midpoint(region.max).dot(up)).fold(f32::NEG_INFINITY, f32::max)
    };
    let is_free = |child: &JointIndex| {
        !arms.chains.iter().any(|chain| chain[0] == *child) && !shape.tree.is_under(legs.base, *child)
    };
    let highest = |top: &dyn Fn(JointIndex) -> f32| {
        let free = shape.tree.children(arms.base).iter().copied().filter(is_free);
        let first = free.max_by(|&a, &b| top(a).total_cmp(&top(b)).then(b.cmp(&a)))?;
        (top(first) >= shape.position(arms.base).dot(up) + 0.02 * arms.length).then_some(first)
    };
    Some(shape.unforked(highest(&top).or_else(|| highest(&skin_top))?))
}
