//! Material variants (KHR_materials_variants): the file names them, and its primitives list a material for each.

use std::collections::HashSet;

use gaitway_character::asset::Warnings;
use gaitway_character::mesh::Material;
use gltf::json::Root;
use gltf::json::mesh::Primitive;
use serde_json::Value;

use super::accessor::get;
use crate::error::Problem;

pub const NAME: &str = "KHR_materials_variants";
/// Each variant may need a pipeline for each primitive.
const MAX_VARIANTS: usize = 1024;
/// Outcome of an invalid mapping.
const LEFT_OUT: &str = "the primitive keeps its material";

/// Returns the variants' names, made unique and non-empty so that a name identifies its variant.
pub fn names(root: &Root, warnings: &mut Warnings) -> Result<Vec<String>, Problem> {
    let Some(extension) = root.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME)) else {
        return Ok(Vec::new());
    };
    let Some(variants) = extension.get("variants").and_then(Value::as_array) else {
        let place = format!("extensions.{NAME}.variants");
        invalid(place, "an array of variants", extension).leave_out("variant", "the file has no variants", warnings)?;
        return Ok(Vec::new());
    };
    if variants.len() > MAX_VARIANTS {
        let problem =
            Problem::new(format!("extensions.{NAME}.variants"), format!("at most {MAX_VARIANTS}"), variants.len());
        problem.leave_out("variant", "the others are left out", warnings)?;
    }
    let (mut names, mut used) = (Vec::new(), HashSet::new());
    for (index, variant) in variants.iter().take(MAX_VARIANTS).enumerate() {
        let given = variant.get("name").and_then(Value::as_str).unwrap_or_default().trim();
        let base = if given.is_empty() { format!("Variant {index}") } else { given.to_owned() };
        let (mut name, mut number) = (base.clone(), index);
        while !used.insert(name.clone()) {
            name = format!("{base} ({number})");
            number += 1;
        }
        names.push(name);
    }
    Ok(names)
}

/// Returns pairs of variant and material for a primitive whose material depends on the variant. Invalid mappings are
/// skipped with a warning.
pub fn mappings(
    primitive: &Primitive,
    variants: usize,
    materials: &[Material],
    place: &str,
    warnings: &mut Warnings,
) -> Result<Vec<(usize, usize)>, Problem> {
    let Some(extension) = primitive.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME)) else {
        return Ok(Vec::new());
    };
    let place = format!("{place}.extensions.{NAME}.mappings");
    let (mut found, mut is_mapped) = (Vec::new(), vec![false; variants]);
    let mappings = match extension.get("mappings").and_then(Value::as_array) {
        Some(mappings) => &mappings[..],
        None => {
            invalid(place.clone(), "an array of mappings", extension).leave_out("variant", LEFT_OUT, warnings)?;
            &[]
        }
    };
    for (at, mapping) in mappings.iter().enumerate() {
        match read(mapping, variants, materials, &format!("{place}[{at}]")) {
            // The first material of a variant counts.
            Ok((material, in_variants)) => {
                for variant in in_variants {
                    if !std::mem::replace(&mut is_mapped[variant], true) {
                        found.push((variant, material));
                    }
                }
            }
            Err(problem) => problem.leave_out("variant", LEFT_OUT, warnings)?,
        }
    }
    Ok(found)
}

fn read(mapping: &Value, variants: usize, materials: &[Material], place: &str) -> Result<(usize, Vec<usize>), Problem> {
    let material = index(mapping.get("material"), &format!("{place}.material"))?;
    get(materials, material, &format_args!("{place}.material"), "materials")?;
    let list = mapping.get("variants").and_then(Value::as_array);
    let list = list.ok_or_else(|| invalid(format!("{place}.variants"), "an array of variants", mapping))?;
    let mut in_variants = Vec::new();
    for (at, variant) in list.iter().enumerate() {
        let place = format!("{place}.variants[{at}]");
        let variant = index(Some(variant), &place)?;
        if variant >= variants {
            return Err(Problem::new(place, format!("an index into the {variants} variants"), variant));
        }
        in_variants.push(variant);
    }
    Ok((material, in_variants))
}

fn index(value: Option<&Value>, place: &str) -> Result<usize, Problem> {
    let found = value.and_then(Value::as_u64).and_then(|index| usize::try_from(index).ok());
    found.ok_or_else(|| invalid(place.to_owned(), "an index", value.unwrap_or(&Value::Null)))
}

fn invalid(place: String, expected: &str, found: &Value) -> Problem {
    let found: String = found.to_string().chars().take(40).collect();
    Problem::new(place, expected, found)
}
