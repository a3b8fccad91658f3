//! Materials, textures and samplers (§3.9, §3.8.4), with the extensions that change them.

use std::fmt::Display;

use glam::{Vec2, Vec3, Vec4};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::AlphaMode as JsonAlphaMode;
use gltf::json::texture::{MagFilter, MinFilter, Sampler as JsonSampler, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{self, Root};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::accessor::get;
use super::document::{Document, present};
use super::lobes;
use super::loosen::{cleaned, whole};
use super::{mtoon, vrm};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;
use crate::mesh::{AlphaMode, Filter, Material, MipFilter, Sampler, Texture, TextureRef, UvTransform, Wrap};

/// Reads an extension that the crate has no type for at this place.
fn extension<T: DeserializeOwned>(
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

pub fn materials(document: &Document, warnings: &mut Warnings) -> Result<Vec<Material>, Problem> {
    let materials = document.root.materials.iter().enumerate();
    materials.map(|(index, material)| read(document, index, material, warnings)).collect()
}

fn read(
    document: &Document,
    index: usize,
    material: &json::Material,
    warnings: &mut Warnings,
) -> Result<Material, Problem> {
    let here = format!("materials[{index}]");
    let pbr = &material.pbr_metallic_roughness;
    let mut reader = TextureReader { root: &document.root, material: &here, warnings };
    let base_color_texture = reader.color(&pbr.base_color_texture, "pbrMetallicRoughness.baseColorTexture")?;
    let metallic_roughness_texture =
        reader.color(&pbr.metallic_roughness_texture, "pbrMetallicRoughness.metallicRoughnessTexture")?;
    let normal = material.normal_texture.as_ref().map(|info| {
        (info.index.value(), info.tex_coord, info.extensions.as_ref().map(|extensions| &extensions.others))
    });
    let normal_texture = reader.data(normal, "normalTexture")?;
    let occlusion = material.occlusion_texture.as_ref().map(|info| {
        (info.index.value(), info.tex_coord, info.extensions.as_ref().map(|extensions| &extensions.others))
    });
    let occlusion_texture = reader.data(occlusion, "occlusionTexture")?;
    let emissive_texture = reader.color(&material.emissive_texture, "emissiveTexture")?;
    let extensions = material.extensions.as_ref();
    let others = extensions.map(|extensions| &extensions.others);
    let emissive_strength = extensions.and_then(|extensions| extensions.emissive_strength.as_ref());
    let mut read = Material {
        name: material.name.clone().unwrap_or_default(),
        base_color: Vec4::from(pbr.base_color_factor.0),
        metallic: pbr.metallic_factor.0,
        roughness: pbr.roughness_factor.0,
        emissive: Vec3::from(material.emissive_factor.0),
        emissive_strength: emissive_strength.map_or(1.0, |strength| strength.emissive_strength.0),
        normal_scale: material.normal_texture.as_ref().map_or(1.0, |info| info.scale),
        occlusion_strength: material.occlusion_texture.as_ref().map_or(1.0, |info| info.strength.0),
        alpha_mode: alpha_mode(document, material, &here, reader.warnings),
        double_sided: material.double_sided,
        unlit: extensions.is_some_and(|extensions| extensions.unlit.is_some()),
        base_color_texture,
        metallic_roughness_texture,
        normal_texture,
        occlusion_texture,
        emissive_texture,
        lobes: None,
        toon: None,
    };
    if let Some(others) = others {
        lobes::read(others, &mut read, &mut reader)?;
        mtoon::read(others, &mut read, &mut reader)?;
    }
    let vrm_0 = document.root.extensions.as_ref().and_then(|extensions| extensions.others.get("VRM"));
    if let Some(properties) = vrm_0.and_then(|vrm| vrm["materialProperties"].get(index)) {
        let place = format!("extensions.VRM.materialProperties[{index}]");
        let mut reader = TextureReader { root: &document.root, material: &place, warnings: reader.warnings };
        vrm::mtoon::read_0(properties, &mut read, &mut reader)?;
    }
    Ok(read)
}

fn alpha_mode(document: &Document, material: &json::Material, here: &str, warnings: &mut Warnings) -> AlphaMode {
    match material.alpha_mode {
        Checked::Valid(JsonAlphaMode::Opaque) => AlphaMode::Opaque,
        Checked::Valid(JsonAlphaMode::Mask) => AlphaMode::Mask { cutoff: material.alpha_cutoff.unwrap_or_default().0 },
        Checked::Valid(JsonAlphaMode::Blend) => AlphaMode::Blend,
        Checked::Invalid => {
            let found = document.text_at(&format!("{here}.alphaMode"));
            // An empty string counts as missing.
            if !found.is_empty() {
                let problem = format!("alpha mode “{found}” is not known; it is drawn opaque");
                warnings.push(Warning::Other { code: "alpha-mode", place: here.to_owned(), problem });
            }
            AlphaMode::Opaque
        }
    }
}

/// Reads the textures of one material. The crate has a type for KHR_texture_transform of colour textures, but not of
/// normal and occlusion textures.
pub struct TextureReader<'a> {
    root: &'a Root,
    /// The material's place in the file.
    pub material: &'a str,
    pub warnings: &'a mut Warnings,
}

/// Texture index, UV set, extensions.
type DataTexture<'a> = (usize, u32, Option<&'a Map<String, Value>>);

impl TextureReader<'_> {
    fn color(&mut self, info: &Option<json::texture::Info>, name: &str) -> Result<Option<TextureRef>, Problem> {
        let Some(info) = info else { return Ok(None) };
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.clone());
        self.texture(info.index.value(), info.tex_coord, transform, format!("{}.{name}", self.material))
    }

    fn data(&mut self, info: Option<DataTexture>, name: &str) -> Result<Option<TextureRef>, Problem> {
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
            let problem = format!("TEXCOORD_{uv_set} is asked for; only sets 0 and 1 are read, so set 0 is used");
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

/// A texture whose image is not there is empty; one whose sampler is not there has the default.
pub fn textures(document: &Document, warnings: &mut Warnings) -> Result<Vec<Texture>, Problem> {
    let root = &document.root;
    let mut textures = Vec::with_capacity(root.textures.len());
    for (index, texture) in root.textures.iter().enumerate() {
        let here = format!("textures[{index}]");
        let image = match image_of(root, texture, &here) {
            Ok(image) => image,
            Err(problem) => {
                problem.leave_out("texture", "the texture is left out", warnings)?;
                None
            }
        };
        let sampler = texture.sampler.map(|sampler| {
            get(&root.samplers, sampler.value(), &format_args!("{here}.sampler"), "samplers").map(read_sampler)
        });
        let sampler = match sampler.transpose() {
            Ok(sampler) => sampler.unwrap_or_default(),
            Err(problem) => {
                problem.leave_out("texture", "the usual sampler is used", warnings)?;
                Sampler::default()
            }
        };
        textures.push(Texture { image, sampler });
    }
    Ok(textures)
}

fn image_of(root: &Root, texture: &json::Texture, here: &str) -> Result<Option<usize>, Problem> {
    #[derive(serde::Deserialize)]
    struct Other {
        source: Option<usize>,
    }
    let source = |name: &str| -> Result<Option<usize>, Problem> {
        let extensions = texture.extensions.as_ref();
        let other: Option<Other> = extensions.map_or(Ok(None), |all| extension(&all.others, name, here))?;
        Ok(other.and_then(|other| other.source))
    };
    let [ktx2, avif, webp] = [source("KHR_texture_basisu")?, source("EXT_texture_avif")?, source("EXT_texture_webp")?];
    // Only a browser decodes AVIF, so elsewhere it comes last.
    let in_browser = avif.filter(|_| cfg!(target_arch = "wasm32"));
    let image = ktx2.or(in_browser).or(webp).or(present(texture.source)).or(avif);
    image.map_or(Ok(None), |image| {
        get(&root.images, image, &format_args!("{here}.source"), "images").map(|_| Some(image))
    })
}

/// Unknown codes become the default.
fn read_sampler(sampler: &JsonSampler) -> Sampler {
    let wrap = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    };
    let (min, mip) = match sampler.min_filter {
        Some(Checked::Valid(MinFilter::Nearest)) => (Filter::Nearest, MipFilter::None),
        Some(Checked::Valid(MinFilter::Linear)) => (Filter::Linear, MipFilter::None),
        Some(Checked::Valid(MinFilter::NearestMipmapNearest)) => (Filter::Nearest, MipFilter::Nearest),
        Some(Checked::Valid(MinFilter::LinearMipmapNearest)) => (Filter::Linear, MipFilter::Nearest),
        Some(Checked::Valid(MinFilter::NearestMipmapLinear)) => (Filter::Nearest, MipFilter::Linear),
        _ => (Filter::Linear, MipFilter::Linear),
    };
    let mag = match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        _ => Filter::Linear,
    };
    Sampler { mag, min, mip, wrap_u: wrap(sampler.wrap_s), wrap_v: wrap(sampler.wrap_t) }
}
