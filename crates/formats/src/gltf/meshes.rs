//! Meshes and their primitives (§3.7).

use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::{
    Geometry, Influences, MAX_INFLUENCES, Material, Mesh, MorphTarget, Topology, add_tangents, first_not_below,
};
use glam::{Vec2, Vec3, Vec4};
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mode, MorphTarget as JsonMorphTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{self, Accessor, Index};
use serde_json::Value;

use super::accessor::{Accessors, get};
use super::document::fits_in_memory;
use super::influences::{self, InfluenceSet};
use super::{draco, indices, variants};
use crate::error::Problem;
use crate::limits::Limit;

/// `variants` is the number of material variants.
pub fn meshes(
    accessors: &Accessors,
    materials: &[Material],
    variants: usize,
    warnings: &mut Warnings,
) -> Result<Vec<Mesh>, Problem> {
    let meshes = accessors.document.root.meshes.iter().enumerate();
    let surfaces = Surfaces { materials, variants };
    meshes.map(|(index, mesh)| read_mesh(accessors, surfaces, index, mesh, warnings)).collect()
}

/// The materials and variants that primitives refer to.
#[derive(Clone, Copy)]
struct Surfaces<'a> {
    materials: &'a [Material],
    /// Number of material variants.
    variants: usize,
}

fn read_mesh(
    accessors: &Accessors,
    surfaces: Surfaces<'_>,
    index: usize,
    mesh: &json::Mesh,
    warnings: &mut Warnings,
) -> Result<Mesh, Problem> {
    let here = format!("meshes[{index}]");
    let targets = mesh.primitives.first().map_or(0, |primitive| targets(primitive).len());
    let mut primitives = Vec::with_capacity(mesh.primitives.len());
    for (at, primitive) in mesh.primitives.iter().enumerate() {
        let place = format!("{here}.primitives[{at}]");
        let found = self::targets(primitive).len();
        if found != targets {
            let expected = format!("{targets} morph targets, as the first primitive has");
            return Err(Problem::new(format!("{place}.targets"), expected, found));
        }
        primitives.push(read_primitive(accessors, surfaces, &place, primitive, warnings)?);
    }
    let weights = mesh.weights.as_ref().map_or(0, Vec::len);
    if weights > 0 && weights != targets {
        return Err(Problem::new(format!("{here}.weights"), format!("{targets} weights"), weights));
    }
    let name = mesh.name.clone().unwrap_or_default();
    Ok(Mesh { name, primitives, target_names: target_names(mesh, targets), ..Mesh::default() })
}

fn targets(primitive: &Primitive) -> &[JsonMorphTarget] {
    primitive.targets.as_deref().unwrap_or_default()
}

/// Names of morph targets are not in the specification, but most exporters write them to the mesh's extras.
fn target_names(mesh: &json::Mesh, targets: usize) -> Vec<String> {
    let extras = mesh.extras.as_ref().filter(|extras| targets > 0 && fits_in_memory(extras.get()));
    let extras: Value = extras.and_then(|extras| serde_json::from_str(extras.get()).ok()).unwrap_or_default();
    let name = |target: usize| extras.get("targetNames")?.as_array()?.get(target)?.as_str();
    (0..targets).map(|target| name(target).unwrap_or_default().to_owned()).collect()
}

/// The attributes of one primitive or morph target.
struct Attributes<'a> {
    accessors: &'a Accessors<'a>,
    find: &'a dyn Fn(&Semantic) -> Option<Index<Accessor>>,
    place: String,
    vertices: usize,
}

impl Attributes<'_> {
    /// Returns an attribute's accessor and its place; checks the count before anything is decoded.
    fn located(&self, semantic: Semantic) -> Result<Option<(usize, String)>, Problem> {
        let Some(index) = (self.find)(&semantic) else { return Ok(None) };
        let place = format!("{}.{}", self.place, semantic.to_string());
        let found = self.accessors.count(index.value(), &place)?;
        if found != self.vertices {
            return Err(Problem::new(place, format!("{} elements, as POSITION has", self.vertices), found));
        }
        Ok(Some((index.value(), place)))
    }

    fn floats<const N: usize>(&self, semantic: Semantic, what: &str) -> Result<Vec<[f32; N]>, Problem> {
        match self.located(semantic)? {
            None => Ok(Vec::new()),
            Some((index, place)) => self.accessors.finite::<N>(index, &place, what),
        }
    }

    fn vec3(&self, semantic: Semantic) -> Result<Vec<Vec3>, Problem> {
        Ok(self.floats::<3>(semantic, "VEC3")?.into_iter().map(Vec3::from).collect())
    }

    fn colors(&self) -> Result<Vec<Vec4>, Problem> {
        let Some((index, place)) = self.located(Semantic::Colors(0))? else { return Ok(Vec::new()) };
        let accessor = get(&self.accessors.document.root.accessors, index, &place, "accessors")?;
        if accessor.type_ == Checked::Valid(Type::Vec3) {
            let colors = self.accessors.finite::<3>(index, &place, "VEC3 or VEC4")?;
            return Ok(colors.into_iter().map(|color| Vec3::from(color).extend(1.0)).collect());
        }
        let colors = self.accessors.finite::<4>(index, &place, "VEC3 or VEC4")?;
        Ok(colors.into_iter().map(Vec4::from).collect())
    }

    fn influences(&self, mesh: &str, warnings: &mut Warnings) -> Result<Influences, Problem> {
        let mut sets = Vec::new();
        for set in 0.. {
            let only = |missing: Semantic, found: Semantic| {
                let found = format!("only {}", found.to_string());
                Problem::new(self.place.as_str(), missing.to_string(), found)
            };
            match (self.located(Semantic::Joints(set))?, self.located(Semantic::Weights(set))?) {
                (None, None) => break,
                (Some((joint_index, joint_place)), Some((weight_index, weight_place))) => sets.push(InfluenceSet {
                    joints: self.accessors.integers::<4>(joint_index, &joint_place, "VEC4 of joints")?,
                    weights: self.accessors.floats::<4>(weight_index, &weight_place, "VEC4 of weights")?,
                }),
                (Some(_), None) => return Err(only(Semantic::Weights(set), Semantic::Joints(set))),
                (None, Some(_)) => return Err(only(Semantic::Joints(set), Semantic::Weights(set))),
            }
        }
        let influence = size_of::<u16>() + size_of::<f32>();
        let count = self.vertices.saturating_mul((4 * sets.len()).min(MAX_INFLUENCES));
        self.accessors.budget.allocate(count, influence, &self.place)?;
        Ok(influences::merge(mesh, self.vertices, &sets, warnings))
    }
}

fn read_primitive(
    accessors: &Accessors,
    surfaces: Surfaces<'_>,
    place: &str,
    primitive: &Primitive,
    warnings: &mut Warnings,
) -> Result<Geometry, Problem> {
    if draco::is_needed(&accessors.document.root, primitive) {
        return Err(Problem::new(place, "decoded data (call `prepare` before `load`)", draco::NAME));
    }
    let find = |semantic: &Semantic| primitive.attributes.get(&Checked::Valid(semantic.clone())).copied();
    let Some(position) = find(&Semantic::Positions) else {
        let problem = "it has no POSITION and cannot be drawn".to_owned();
        warnings.push(Warning::Other { code: "no-positions", place: place.to_owned(), problem });
        let morph_targets = vec![MorphTarget::default(); targets(primitive).len()];
        return Ok(Geometry { morph_targets, ..Geometry::default() });
    };
    let vertices = accessors.count(position.value(), &format!("{place}.attributes.POSITION"))?;
    let attributes = Attributes { accessors, find: &find, place: format!("{place}.attributes"), vertices };
    let positions = attributes.vec3(Semantic::Positions)?;
    let normals = attributes.vec3(Semantic::Normals)?;
    let normals: Vec<Vec3> = normals.into_iter().map(|normal| normal.normalize_or(Vec3::Y)).collect();
    let mut uvs = [Vec::new(), Vec::new()];
    for (set, uv) in (0..).zip(&mut uvs) {
        *uv = attributes.floats::<2>(Semantic::TexCoords(set), "VEC2")?.into_iter().map(Vec2::from).collect();
    }
    // Tangents without normals have to be ignored (§3.7.2.1).
    let tangents = if normals.is_empty() { Vec::new() } else { attributes.floats::<4>(Semantic::Tangents, "VEC4")? };
    let colors = attributes.colors()?;
    let influences = attributes.influences(place, warnings)?;
    let (topology, indices) = read_indices(accessors, place, primitive, vertices)?;
    let morph_targets = read_targets(accessors, place, primitive, vertices, !normals.is_empty())?;
    let material = read_material(surfaces.materials, place, primitive, warnings)?;
    let variants = variants::mappings(primitive, surfaces.variants, surfaces.materials, place, warnings)?;
    let mut geometry = Geometry {
        topology,
        positions,
        normals,
        tangents: tangents.into_iter().map(Vec4::from).collect(),
        uvs,
        colors,
        indices,
        influences,
        morph_targets,
        material,
        variants,
        file_vertices: vertices,
        file_vertex: Vec::new(),
    };
    let of_variants = geometry.variants.iter().map(|&(_, material)| material);
    let mut used = material.into_iter().chain(of_variants);
    if let Some(uv_set) = used.find_map(|material| surfaces.materials[material].tangent_uv_set())
        && topology == Topology::Triangles
        && geometry.tangents.is_empty()
    {
        let copied_bytes = add_tangents(&mut geometry, uv_set, accessors.budget.left(Limit::DataBytes));
        accessors.budget.allocate(1, copied_bytes, &place)?;
    }
    Ok(geometry)
}

/// Warns about an index out of range and returns the default material instead.
fn read_material(
    materials: &[Material],
    place: &str,
    primitive: &Primitive,
    warnings: &mut Warnings,
) -> Result<Option<usize>, Problem> {
    let Some(index) = primitive.material.map(|material| material.value()) else { return Ok(None) };
    match get(materials, index, &format_args!("{place}.material"), "materials") {
        Ok(_) => Ok(Some(index)),
        Err(problem) => {
            problem.leave_out("material", "the default material is used", warnings)?;
            Ok(None)
        }
    }
}

fn read_targets(
    accessors: &Accessors,
    place: &str,
    primitive: &Primitive,
    vertices: usize,
    has_normals: bool,
) -> Result<Vec<MorphTarget>, Problem> {
    let read = |(at, target): (usize, &JsonMorphTarget)| {
        let find = |semantic: &Semantic| match semantic {
            Semantic::Positions => target.positions,
            Semantic::Normals => target.normals.filter(|_| has_normals),
            Semantic::Tangents => target.tangents,
            _ => None,
        };
        let target = Attributes { accessors, find: &find, place: format!("{place}.targets[{at}]"), vertices };
        Ok(MorphTarget {
            positions: target.vec3(Semantic::Positions)?,
            normals: target.vec3(Semantic::Normals)?,
            tangents: target.vec3(Semantic::Tangents)?,
        })
    };
    targets(primitive).iter().enumerate().map(read).collect()
}

fn read_indices(
    accessors: &Accessors,
    place: &str,
    primitive: &Primitive,
    vertices: usize,
) -> Result<(Topology, Vec<u32>), Problem> {
    let list = match primitive.indices {
        None => {
            accessors.budget.allocate(vertices, size_of::<u32>(), &place)?;
            (0..u32::try_from(vertices).unwrap_or(u32::MAX)).collect()
        }
        Some(index) => {
            let place = format!("{place}.indices");
            let read = accessors.integers::<1>(index.value(), &place, "SCALAR")?.into_flattened();
            if let Some(at) = first_not_below(&read, vertices) {
                return Err(Problem::new(format!("{place}[{at}]"), format!("an index below {vertices}"), read[at]));
            }
            read
        }
    };
    let Checked::Valid(mode) = primitive.mode else {
        let place = format!("{place}.mode");
        let found = accessors.document.quoted_at(&place);
        return Err(Problem::new(place, "0 to 6", found));
    };
    // Lists grow: a strip or a fan yields up to three indices for each of its own.
    let is_list = matches!(mode, Mode::Points | Mode::Lines | Mode::Triangles);
    accessors.budget.allocate(if is_list { 0 } else { 3 * list.len() }, size_of::<u32>(), &place)?;
    Ok(indices::to_list(mode, list))
}
