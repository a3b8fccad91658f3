//! Copies of a node's mesh (EXT_mesh_gpu_instancing), each with a translation, rotation and scale relative to the node.
//!
//! Each copy is a `MeshInstance` at the joint of its node, so bounds, picking and the pose document need no special case.

use gaitway_character::asset::{MeshInstance, Warnings};
use glam::{Affine3A, Quat};
use gltf::json::Node;
use serde_json::Value;

use super::accessor::Accessors;
use crate::error::Problem;
use crate::limits::Limit;

pub const NAME: &str = "EXT_mesh_gpu_instancing";

/// Returns the transform from mesh to node of each copy. `None` without the extension, or with a warning if its data is
/// invalid: the mesh is drawn once.
pub fn copies(
    accessors: &Accessors,
    node: &Node,
    place: &str,
    warnings: &mut Warnings,
) -> Result<Option<Vec<Affine3A>>, Problem> {
    let Some(extension) = node.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME)) else {
        return Ok(None);
    };
    let place = format!("{place}.extensions.{NAME}");
    let read = match node.skin {
        None => read(accessors, extension, &format!("{place}.attributes")),
        Some(_) => Err(Problem::new(place, "a mesh without a skin", "a skinned mesh")),
    };
    match read {
        Ok(copies) => Ok(Some(copies)),
        Err(problem) => {
            problem.leave_out("instancing", "the mesh is drawn once", warnings)?;
            Ok(None)
        }
    }
}

/// Returns how many draw calls the copies of a primitive take: consecutive ones share a call if both or neither are mirrored.
pub fn draw_calls(copies: &[Affine3A]) -> usize {
    copies.chunk_by(|copy, next| is_mirrored(copy) == is_mirrored(next)).count()
}

fn is_mirrored(copy: &Affine3A) -> bool {
    copy.matrix3.determinant() < 0.0
}

fn read(accessors: &Accessors, extension: &Value, place: &str) -> Result<Vec<Affine3A>, Problem> {
    let find = |name: &str| {
        let value = extension.get("attributes").and_then(|attributes| attributes.get(name));
        let index = value.and_then(Value::as_u64).and_then(|index| usize::try_from(index).ok());
        index.map(|index| (index, format!("{place}.{name}")))
    };
    let attributes = ["TRANSLATION", "ROTATION", "SCALE"].map(find);
    let mut count = None;
    for (index, place) in attributes.iter().flatten() {
        let found = accessors.count(*index, place)?;
        let expected = *count.get_or_insert(found);
        if found != expected {
            return Err(Problem::new(
                place.as_str(),
                format!("{expected} elements, as the first attribute has"),
                found,
            ));
        }
    }
    let Some(count) = count else {
        return Err(Problem::new(place, "TRANSLATION, ROTATION or SCALE", "none of them"));
    };
    accessors.budget.spend(Limit::Nodes, count, &place)?;
    accessors.budget.allocate(count, size_of::<MeshInstance>(), &place)?;
    let vectors = |attribute: &Option<(usize, String)>, default: [f32; 3]| match attribute {
        None => Ok(vec![default; count]),
        Some((index, place)) => accessors.finite::<3>(*index, place, "VEC3"),
    };
    let [translation, rotation, scale] = &attributes;
    let (translations, scales) = (vectors(translation, [0.0; 3])?, vectors(scale, [1.0; 3])?);
    let rotations = match rotation {
        None => vec![[0.0, 0.0, 0.0, 1.0]; count],
        Some((index, place)) => accessors.finite::<4>(*index, place, "VEC4")?,
    };
    let copies = translations.into_iter().zip(rotations).zip(scales);
    Ok(copies.map(|((translation, rotation), scale)| transform(translation, rotation, scale)).collect())
}

fn transform(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Affine3A {
    let rotation = Quat::from_array(rotation);
    let rotation = if rotation.length() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
    Affine3A::from_scale_rotation_translation(scale.into(), rotation, translation.into())
}
