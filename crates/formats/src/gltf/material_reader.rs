//! What the readers of a material and of its extensions share: textures by index, and members by path.

use std::fmt::Display;

use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::{Material, TextureRef, UvTransform};
use glam::Vec2;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::{self, Root};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::accessor::get;
use super::loosen::{cleaned, whole};
use crate::error::Problem;

/// Reads an extension that the crate has no type for at this place.
pub fn extension<T: DeserializeOwned>(
    extensions: &Map<String, Value>,
    name: &str,
    place: &str,
) -> Result<Option<T>, Problem> {
    let Some(value) = extensions.get(name) else { return Ok(None) };
    let wrong = |found: &dyn Display| {
        Problem::new(format!("{place}.extensions.{name}"), "what the extension's specification says", found)
    };
    // An array would be read by position.
    if !value.is_object() {
        return Err(wrong(value));
    }
    T::deserialize(cleaned(value)).map(Some).map_err(|problem| wrong(&problem))
}

/// Reads the textures of one material. The crate has a type for KHR_texture_transform of colour textures, but not of
/// normal and occlusion textures.
pub struct TextureReader<'a> {
    pub root: &'a Root,
    /// The material's place in the file.
    pub material: &'a str,
    pub warnings: &'a mut Warnings,
}

/// Texture index, UV set, extensions.
pub type DataTexture<'a> = (usize, u32, Option<&'a Map<String, Value>>);

impl TextureReader<'_> {
    pub fn color(&mut self, info: &Option<json::texture::Info>, name: &str) -> Result<Option<TextureRef>, Problem> {
        let Some(info) = info else { return Ok(None) };
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.clone());
        self.texture(info.index.value(), info.tex_coord, transform, format!("{}.{name}", self.material))
    }

    pub fn data(&mut self, info: Option<DataTexture>, name: &str) -> Result<Option<TextureRef>, Problem> {
        let Some((index, uv_set, extensions)) = info else { return Ok(None) };
        let place = format!("{}.{name}", self.material);
        let transform =
            extensions.map_or(Ok(None), |extensions| extension(extensions, "KHR_texture_transform", &place));
        let transform = match transform {
            Ok(transform) => transform,
            Err(problem) => {
                problem.leave_out("texture", "it is ignored", self.warnings)?;
                None
            }
        };
        self.texture(index, uv_set, transform, place)
    }

    /// Reads a texture of an extension for which the crate has no type.
    pub fn extension_texture(&mut self, info: Option<&Value>, name: &str) -> Result<Option<TextureRef>, Problem> {
        let Some(info) = info.filter(|info| !info.is_null()) else { return Ok(None) };
        let Some(index) = info.get("index").and_then(whole) else {
            let problem = Problem::new(format!("{}.{name}", self.material), "a texture's index", info);
            problem.leave_out("texture", "the texture is left out", self.warnings)?;
            return Ok(None);
        };
        let uv_set = info.get("texCoord").and_then(whole).unwrap_or(0);
        let extensions = info.get("extensions").and_then(Value::as_object);
        self.data(Some((index as usize, uv_set.min(u64::from(u32::MAX)) as u32, extensions)), name)
    }

    fn texture(
        &mut self,
        index: usize,
        uv_set: u32,
        transform: Option<TextureTransform>,
        place: String,
    ) -> Result<Option<TextureRef>, Problem> {
        if let Err(problem) = get(&self.root.textures, index, &format_args!("{place}.index"), "textures") {
            problem.leave_out("texture", "the texture is left out", self.warnings)?;
            return Ok(None);
        }
        let transform = transform.unwrap_or_default();
        let mut uv_set = transform.tex_coord.unwrap_or(uv_set) as usize;
        if uv_set > 1 {
            let problem = format!("TEXCOORD_{uv_set} is not supported; only sets 0 and 1 are, so set 0 is used");
            self.warnings.push(Warning::Other { code: "texcoord-set", place, problem });
            uv_set = 0;
        }
        let uv_transform = UvTransform {
            offset: Vec2::from(transform.offset.0),
            rotation_radians: transform.rotation.0,
            scale: Vec2::from(transform.scale.0),
        };
        Ok(Some(TextureRef { texture: index, uv_set, uv_transform }))
    }
}

/// Reads textures by their paths into slots of the material.
pub fn read_textures(
    extensions: &Map<String, Value>,
    table: &[(&str, TextureSlot)],
    material: &mut Material,
    reader: &mut TextureReader<'_>,
) -> Result<(), Problem> {
    for &(path, slot) in table {
        let name = format!("extensions.{}", path.replace('/', "."));
        let texture = reader.extension_texture(member(extensions, path), &name)?;
        material.set_texture(slot, texture);
    }
    Ok(())
}

/// Returns the value at a path of member names separated by `/`.
pub fn member<'a>(extensions: &'a Map<String, Value>, path: &str) -> Option<&'a Value> {
    let (extension, rest) = path.split_once('/')?;
    rest.split('/').try_fold(extensions.get(extension)?, |value, key| value.get(key))
}

/// Reads a number, or an array of numbers as long as `out`. Leaves `out` unchanged if the member is missing, or with a
/// warning if it is anything else.
pub fn read_numbers(extensions: &Map<String, Value>, path: &str, out: &mut [f32], reader: &mut TextureReader<'_>) {
    let Some(value) = member(extensions, path).filter(|value| !value.is_null()) else { return };
    let number = |value: &Value| value.as_f64().map(|value| value as f32).filter(|value| value.is_finite());
    let list = match out.len() {
        1 => std::slice::from_ref(value),
        _ => value.as_array().map_or(&[][..], Vec::as_slice),
    };
    let numbers: Vec<f32> = list.iter().filter_map(number).collect();
    match numbers.len() == out.len() && list.len() == out.len() {
        true => out.copy_from_slice(&numbers),
        false => {
            let expected = if out.len() == 1 { "a number".to_owned() } else { format!("{} numbers", out.len()) };
            ignore(reader, &path.replace('/', "."), &expected, value);
        }
    }
}

/// Warns that a member below the material's `extensions` is ignored.
pub fn ignore(reader: &mut TextureReader<'_>, path: &str, expected: &str, found: &Value) {
    let place = format!("{}.extensions.{path}", reader.material);
    let problem = format!("expected {expected}, found {found}; it is ignored");
    reader.warnings.push(Warning::Other { code: "material", place, problem });
}
