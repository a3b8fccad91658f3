//! Meshes and their primitives (§3.7).

use glam::{Vec2, Vec3, Vec4};
use serde_json::{Map, Value};

use super::accessor::{Accessors, get};
use super::influences::{self, InfluenceSet};
use super::{indices, schema};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;
use crate::mesh::{Geometry, Influences, Material, Mesh, MorphTarget, Topology, add_tangents};

pub fn meshes(accessors: &Accessors, materials: &[Material], warnings: &mut Warnings) -> Result<Vec<Mesh>, Problem> {
    let meshes = accessors.root.meshes.iter().enumerate();
    meshes.map(|(index, mesh)| read_mesh(accessors, materials, index, mesh, warnings)).collect()
}

fn read_mesh(
    accessors: &Accessors,
    materials: &[Material],
    index: usize,
    mesh: &schema::Mesh,
    warnings: &mut Warnings,
) -> Result<Mesh, Problem> {
    let here = format!("meshes[{index}]");
    let targets = mesh.primitives.first().map_or(0, |primitive| primitive.targets.len());
    let mut primitives = Vec::with_capacity(mesh.primitives.len());
    for (at, primitive) in mesh.primitives.iter().enumerate() {
        let place = format!("{here}.primitives[{at}]");
        if primitive.targets.len() != targets {
            return Err(Problem::new(
                format!("{place}.targets"),
                format!("{targets} morph targets, as the first primitive has"),
                primitive.targets.len(),
            ));
        }
        primitives.push(read_primitive(accessors, materials, &place, primitive, warnings)?);
    }
    if !mesh.weights.is_empty() && mesh.weights.len() != targets {
        return Err(Problem::new(format!("{here}.weights"), format!("{targets} weights"), mesh.weights.len()));
    }
    let names = mesh.extras.get("targetNames").and_then(Value::as_array);
    let target_names = (0..targets)
        .map(|target| names.and_then(|names| names.get(target)?.as_str()).unwrap_or_default().to_owned())
        .collect();
    Ok(Mesh { name: mesh.name.clone(), primitives, target_names, ..Mesh::default() })
}

/// Attributes of one primitive or morph target, looked up by semantic.
struct Attributes<'a> {
    accessors: &'a Accessors<'a>,
    map: &'a Map<String, Value>,
    place: String,
    vertices: usize,
}

impl Attributes<'_> {
    fn index(&self, semantic: &str) -> Result<Option<usize>, Problem> {
        match self.map.get(semantic) {
            None => Ok(None),
            Some(value) => match value.as_u64().and_then(|index| usize::try_from(index).ok()) {
                Some(index) => Ok(Some(index)),
                None => Err(Problem::new(format!("{}.{semantic}", self.place), "an accessor's index", value)),
            },
        }
    }

    /// Accessor and place of an attribute; its count is checked before anything is decoded.
    fn located(&self, semantic: &str) -> Result<Option<(usize, String)>, Problem> {
        let Some(index) = self.index(semantic)? else { return Ok(None) };
        let place = format!("{}.{semantic}", self.place);
        let found = self.accessors.count(index, &place)?;
        if found != self.vertices {
            return Err(Problem::new(place, format!("{} elements, as POSITION has", self.vertices), found));
        }
        Ok(Some((index, place)))
    }

    fn floats<const N: usize>(&self, semantic: &str, what: &str) -> Result<Vec<[f32; N]>, Problem> {
        match self.located(semantic)? {
            None => Ok(Vec::new()),
            Some((index, place)) => self.accessors.finite::<N>(index, &place, what),
        }
    }

    fn vec3(&self, semantic: &str) -> Result<Vec<Vec3>, Problem> {
        Ok(self.floats::<3>(semantic, "VEC3")?.into_iter().map(Vec3::from).collect())
    }

    fn colors(&self) -> Result<Vec<Vec4>, Problem> {
        let Some((index, place)) = self.located("COLOR_0")? else { return Ok(Vec::new()) };
        if get(&self.accessors.root.accessors, index, &place, "accessors")?.shape == "VEC3" {
            let colors = self.accessors.finite::<3>(index, &place, "VEC3 or VEC4")?;
            return Ok(colors.into_iter().map(|color| Vec3::from(color).extend(1.0)).collect());
        }
        let colors = self.accessors.finite::<4>(index, &place, "VEC3 or VEC4")?;
        Ok(colors.into_iter().map(Vec4::from).collect())
    }

    fn influences(&self, mesh: &str, warnings: &mut Warnings) -> Result<Influences, Problem> {
        let mut sets = Vec::new();
        for set in 0.. {
            let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
            match (self.located(&joints)?, self.located(&weights)?) {
                (None, None) => break,
                (Some((joint_index, joint_place)), Some((weight_index, weight_place))) => sets.push(InfluenceSet {
                    joints: self.accessors.integers::<4>(joint_index, &joint_place, "VEC4 of joints")?,
                    weights: self.accessors.floats::<4>(weight_index, &weight_place, "VEC4 of weights")?,
                }),
                (Some(_), None) => return Err(Problem::new(self.place.as_str(), &weights, format!("only {joints}"))),
                (None, Some(_)) => return Err(Problem::new(self.place.as_str(), &joints, format!("only {weights}"))),
            }
        }
        Ok(influences::merge(mesh, self.vertices, &sets, warnings))
    }
}

fn read_primitive(
    accessors: &Accessors,
    materials: &[Material],
    place: &str,
    primitive: &schema::Primitive,
    warnings: &mut Warnings,
) -> Result<Geometry, Problem> {
    let mut attributes =
        Attributes { accessors, map: &primitive.attributes, place: format!("{place}.attributes"), vertices: 0 };
    let Some(position) = attributes.index("POSITION")? else {
        let problem = "it has no POSITION and cannot be drawn".to_owned();
        warnings.push(Warning::Other { code: "no-positions", place: place.to_owned(), problem });
        let morph_targets = vec![MorphTarget::default(); primitive.targets.len()];
        return Ok(Geometry { morph_targets, ..Geometry::default() });
    };
    attributes.vertices = accessors.count(position, &format!("{place}.attributes.POSITION"))?;
    let vertices = attributes.vertices;
    let positions = attributes.vec3("POSITION")?;
    let normals: Vec<Vec3> =
        attributes.vec3("NORMAL")?.into_iter().map(|normal| normal.normalize_or(Vec3::Y)).collect();
    let mut uvs = [Vec::new(), Vec::new()];
    for (set, uv) in uvs.iter_mut().enumerate() {
        let read = attributes.floats::<2>(&format!("TEXCOORD_{set}"), "VEC2")?;
        *uv = read.into_iter().map(Vec2::from).collect();
    }
    // Without normals, given tangents are to be ignored (§3.7.2.1).
    let tangents = if normals.is_empty() { Vec::new() } else { attributes.floats::<4>("TANGENT", "VEC4")? };
    let tangents = tangents.into_iter().map(Vec4::from).collect();
    let colors = attributes.colors()?;
    let influences = attributes.influences(place, warnings)?;
    let (topology, index_list) = read_indices(accessors, place, primitive, vertices)?;

    let mut morph_targets = Vec::with_capacity(primitive.targets.len());
    for (at, map) in primitive.targets.iter().enumerate() {
        let target = Attributes { accessors, map, place: format!("{place}.targets[{at}]"), vertices };
        morph_targets.push(MorphTarget {
            positions: target.vec3("POSITION")?,
            normals: if normals.is_empty() { Vec::new() } else { target.vec3("NORMAL")? },
            tangents: target.vec3("TANGENT")?,
        });
    }
    if let Some(material) = primitive.material {
        get(materials, material, &format!("{place}.material"), "materials")?;
    }
    let mut geometry = Geometry {
        topology,
        positions,
        normals,
        tangents,
        uvs,
        colors,
        indices: index_list,
        influences,
        morph_targets,
        material: primitive.material,
        file_vertices: vertices,
    };
    let normal_texture = primitive.material.and_then(|material| materials[material].normal_texture);
    if let Some(texture) = normal_texture
        && topology == Topology::Triangles
        && geometry.tangents.is_empty()
    {
        let copied_bytes = add_tangents(&mut geometry, texture.uv_set, accessors.bytes_left());
        accessors.charge(1, copied_bytes, &place)?;
    }
    Ok(geometry)
}

fn read_indices(
    accessors: &Accessors,
    place: &str,
    primitive: &schema::Primitive,
    vertices: usize,
) -> Result<(Topology, Vec<u32>), Problem> {
    let list = match primitive.indices {
        None => (0..u32::try_from(vertices).unwrap_or(u32::MAX)).collect(),
        Some(index) => {
            let place = format!("{place}.indices");
            let read = accessors.integers::<1>(index, &place, "SCALAR")?;
            if let Some(at) = read.iter().position(|[index]| *index as usize >= vertices) {
                return Err(Problem::new(format!("{place}[{at}]"), format!("an index below {vertices}"), read[at][0]));
            }
            read.into_iter().map(|[index]| index).collect()
        }
    };
    indices::to_list(primitive.mode, list)
        .ok_or_else(|| Problem::new(format!("{place}.mode"), "0 to 6", primitive.mode))
}
