//! How much the skin is stretched: the lengths of its edges against those of the mesh as it was bound. Needs neither slots nor
//! names, so a body that comes apart shows, whatever the map says.
//!
//! Bent joints stretch some meshes as much as torn ones do others. What tears a body is a joint that isn't where it belongs on its
//! parent, so edges are also compared with those of the same pose with every joint in its place.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Asset, MeshInstance};
use gaitway_character::mesh::{Bounds, Geometry, Influences, Topology};
use gaitway_character::sort::{sort_by, sort_floats};
use glam::{Affine3A, Vec3A};

/// Edges that are measured around each joint, and the fewest that say something.
const MAX_EDGES: usize = 24;
const MIN_EDGES: usize = 6;

/// Ends whose weights differ by less than this in sum move alike: such an edge keeps its length.
const MIN_DIFFERENCE: f32 = 0.05;

/// Changes of edges shorter than this, as a share of the mesh's diagonal, are relative to it: where weights change abruptly, any
/// bent joint stretches a fine mesh many times over, and nobody sees it.
const MIN_LENGTH: f32 = 0.02;

/// The edges of a model's skin that may change their lengths.
pub struct SkinEdges<'a> {
    asset: &'a Asset,
    edges: Vec<Edge>,
    /// Changes by joint, at the current moment.
    by_joint: Vec<Sum>,
    /// The same, by how much edges are longer than with every joint in its place.
    torn_by_joint: Vec<Sum>,
    posed: Palettes,
    in_place: Palettes,
    /// Changes at all moments.
    all: Sum,
    worst: Option<(f64, JointIndex)>,
    worst_tear: Option<(f64, JointIndex)>,
}

/// `model_from_bind` of each skin's joints.
type Palettes = Vec<Vec<Affine3A>>;

struct Edge {
    skin: usize,
    /// Of the two joints that its ends follow most, the lower one in the hierarchy.
    joint: JointIndex,
    ends: [End; 2],
    bound_length: f32,
    /// What changes are relative to.
    unit: f32,
}

/// A vertex as it was bound, with joints of the skin and weights.
struct End {
    position: Vec3A,
    influences: Vec<(u16, f32)>,
}

impl End {
    fn new(geometry: &Geometry, vertex: usize) -> Self {
        let influences = geometry.influences.of_vertex(vertex).filter(|(_, weight)| *weight > 0.0).collect();
        Self { position: geometry.positions[vertex].into(), influences }
    }

    fn posed(&self, model_from_bind: &[Affine3A]) -> Vec3A {
        let moved = |&(joint, weight): &(u16, f32)| {
            weight * model_from_bind[usize::from(joint)].transform_point3a(self.position)
        };
        self.influences.iter().map(moved).sum()
    }
}

impl Edge {
    fn length(&self, palettes: &[Vec<Affine3A>]) -> f32 {
        let [from, to] = self.ends.each_ref().map(|end| end.posed(&palettes[self.skin]));
        from.distance(to)
    }
}

/// Changes of lengths, and what they are relative to.
#[derive(Clone, Copy, Default)]
struct Sum {
    change: f64,
    units: f64,
    edges: usize,
}

impl Sum {
    fn add(&mut self, change: f32, unit: f32) {
        self.change += f64::from(change);
        self.units += f64::from(unit);
        self.edges += 1;
    }

    /// 1 if nothing changes.
    fn stretch(&self) -> Option<f64> {
        (self.units > 0.0).then(|| 1.0 + self.change / self.units)
    }
}

impl<'a> SkinEdges<'a> {
    /// `model_from_joint` is the rest pose, which says how large the bound mesh is in it.
    pub fn new(asset: &'a Asset, model_from_joint: &[Affine3A]) -> Self {
        let mut found = Self {
            asset,
            edges: Vec::new(),
            by_joint: vec![Sum::default(); asset.skeleton.len()],
            torn_by_joint: vec![Sum::default(); asset.skeleton.len()],
            posed: Vec::new(),
            in_place: Vec::new(),
            all: Sum::default(),
            worst: None,
            worst_tear: None,
        };
        pose(asset, model_from_joint, &mut found.posed);
        for instance in &asset.instances {
            let mut edges = skin_edges(asset, instance);
            let mut scales: Vec<f32> = edges.iter().map(|edge| edge.length(&found.posed) / edge.bound_length).collect();
            sort_floats(&mut scales);
            let Some(&scale) = scales.get(scales.len() / 2).filter(|scale| scale.is_normal()) else { continue };
            for edge in &mut edges {
                edge.bound_length *= scale;
                edge.unit *= scale;
            }
            found.edges.append(&mut edges);
        }
        found
    }

    /// Measures a pose. `in_place` is the same with every joint where it rests on its parent.
    pub fn add(&mut self, model_from_joint: &[Affine3A], in_place: &[Affine3A]) {
        if self.edges.is_empty() {
            return;
        }
        pose(self.asset, model_from_joint, &mut self.posed);
        pose(self.asset, in_place, &mut self.in_place);
        self.by_joint.fill(Sum::default());
        self.torn_by_joint.fill(Sum::default());
        for edge in &self.edges {
            let [length, in_place] = [&self.posed, &self.in_place].map(|palettes| edge.length(palettes));
            self.by_joint[edge.joint.get()].add((length - edge.bound_length).abs(), edge.unit);
            let torn = (length - in_place.max(edge.bound_length)).max(0.0);
            self.torn_by_joint[edge.joint.get()].add(torn, edge.unit);
        }
        for (joint, sum) in self.asset.skeleton.joints().zip(&self.by_joint) {
            self.all.change += sum.change;
            self.all.units += sum.units;
            keep_worst(&mut self.worst, joint, sum);
        }
        for (joint, sum) in self.asset.skeleton.joints().zip(&self.torn_by_joint) {
            keep_worst(&mut self.worst_tear, joint, sum);
        }
    }

    /// By how much edges change on average; 1 if none does.
    pub fn mean(&self) -> Option<f64> {
        self.all.stretch()
    }

    /// The joint around which edges change most at any moment, and by how much.
    pub fn worst(&self) -> Option<(f64, JointIndex)> {
        self.worst
    }

    /// The joint around which edges are stretched most at any moment by joints that are out of place, and by how much.
    pub fn worst_tear(&self) -> Option<(f64, JointIndex)> {
        self.worst_tear
    }
}

fn pose(asset: &Asset, model_from_joint: &[Affine3A], palettes: &mut Palettes) {
    palettes.resize_with(asset.skins.len(), Vec::new);
    for (skin, palette) in asset.skins.iter().zip(palettes) {
        palette.clear();
        let joints = skin.joints().iter().zip(skin.joint_from_bind());
        palette.extend(joints.map(|(joint, bind)| model_from_joint[joint.get()] * *bind));
    }
}

fn keep_worst(worst: &mut Option<(f64, JointIndex)>, joint: JointIndex, sum: &Sum) {
    let is_worse = |stretch: &f64| worst.is_none_or(|(worst, _)| *stretch > worst);
    if let Some(stretch) = sum.stretch().filter(is_worse).filter(|_| sum.edges >= MIN_EDGES) {
        *worst = Some((stretch, joint));
    }
}

/// Returns the edges around each joint whose ends move least alike.
fn skin_edges(asset: &Asset, instance: &MeshInstance) -> Vec<Edge> {
    let Some(skin) = instance.skin else { return Vec::new() };
    let joints = asset.skins[skin].joints();
    let primitives = &asset.meshes[instance.mesh].primitives;
    let positions = primitives.iter().flat_map(|geometry| geometry.positions.iter().copied());
    let min_length = MIN_LENGTH * Bounds::of(positions).diagonal();
    // By joint: how differently the ends are weighted, then the primitive and the ends.
    let mut candidates: Vec<Vec<(f32, [usize; 3])>> = vec![Vec::new(); asset.skeleton.len()];
    for (primitive, geometry) in primitives.iter().enumerate() {
        if geometry.topology != Topology::Triangles || geometry.influences.is_empty() {
            continue;
        }
        for triangle in geometry.indices.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|index| index as usize);
            // Two triangles share most edges, in opposite directions.
            for [from, to] in [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| from < to) {
                let difference = difference(&geometry.influences, from, to);
                if difference >= MIN_DIFFERENCE && geometry.positions[from] != geometry.positions[to] {
                    let strongest = [from, to].map(|end| strongest(&geometry.influences, end));
                    let [from_joint, to_joint] = strongest.map(|joint| joints[usize::from(joint)]);
                    candidates[from_joint.max(to_joint).get()].push((difference, [primitive, from, to]));
                }
            }
        }
    }
    let mut edges = Vec::new();
    for (joint, candidates) in asset.skeleton.joints().zip(&mut candidates) {
        // What comes apart shows where weights change most.
        sort_by(candidates, |a, b| b.0.total_cmp(&a.0));
        edges.extend(candidates.iter().take(MAX_EDGES).map(|&(_, [primitive, from, to])| {
            let geometry = &primitives[primitive];
            let ends = [from, to].map(|end| End::new(geometry, end));
            let bound_length = geometry.positions[from].distance(geometry.positions[to]);
            Edge { skin, joint, ends, bound_length, unit: bound_length.max(min_length) }
        }));
    }
    edges
}

/// Influences are sorted by weight.
fn strongest(influences: &Influences, vertex: usize) -> u16 {
    influences.joints[vertex * influences.stride]
}

/// The sum of what each joint's weights differ by.
fn difference(influences: &Influences, a: usize, b: usize) -> f32 {
    let weight = |vertex: usize, joint: u16| -> f32 {
        influences.of_vertex(vertex).filter(|(other, _)| *other == joint).map(|(_, weight)| weight).sum()
    };
    let of_a = influences.of_vertex(a).filter(|(_, weight)| *weight > 0.0);
    // What a has more than b, b has less in its other joints.
    2.0 * of_a.map(|(joint, own)| (own - weight(b, joint)).max(0.0)).sum::<f32>()
}
