//! Materials, textures and samplers (§3.9, §3.8.4), with the extensions that change them.

use glam::{Vec2, Vec3, Vec4};
use serde::de::DeserializeOwned;

use super::accessor::get;
use super::schema::{self, Extensions};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;
use crate::mesh::{AlphaMode, Filter, Material, MipFilter, Sampler, Texture, TextureRef, UvTransform, Wrap};

/// An extension's object, read as `T`; a malformed one is an error at `place`.
pub fn extension<T: DeserializeOwned>(map: &Extensions, name: &str, place: &str) -> Result<Option<T>, Problem> {
    match map.get(name) {
        None => Ok(None),
        Some(value) => T::deserialize(value).map(Some).map_err(|problem| {
            Problem::new(format!("{place}.extensions.{name}"), "what its specification says", problem)
        }),
    }
}

pub fn materials(root: &schema::Root, warnings: &mut Warnings) -> Result<Vec<Material>, Problem> {
    root.materials.iter().enumerate().map(|(index, material)| read(root, index, material, warnings)).collect()
}

fn read(
    root: &schema::Root,
    index: usize,
    material: &schema::Material,
    warnings: &mut Warnings,
) -> Result<Material, Problem> {
    #[derive(serde::Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct EmissiveStrength {
        emissive_strength: Option<f32>,
    }
    let here = format!("materials[{index}]");
    let pbr = &material.pbr_metallic_roughness;
    let mut texture = |info: &Option<schema::TextureInfo>, name: &str| {
        info.as_ref().map(|info| texture_ref(root, info, &format!("{here}.{name}"), warnings)).transpose()
    };
    let base_color_texture = texture(&pbr.base_color_texture, "pbrMetallicRoughness.baseColorTexture")?;
    let metallic_roughness_texture =
        texture(&pbr.metallic_roughness_texture, "pbrMetallicRoughness.metallicRoughnessTexture")?;
    let normal_texture = texture(&material.normal_texture, "normalTexture")?;
    let occlusion_texture = texture(&material.occlusion_texture, "occlusionTexture")?;
    let emissive_texture = texture(&material.emissive_texture, "emissiveTexture")?;
    let strength: Option<EmissiveStrength> = extension(&material.extensions, "KHR_materials_emissive_strength", &here)?;
    let strength = strength.and_then(|strength| strength.emissive_strength).unwrap_or(1.0);
    let alpha_mode = match material.alpha_mode.as_str() {
        "" | "OPAQUE" => AlphaMode::Opaque,
        "MASK" => AlphaMode::Mask { cutoff: material.alpha_cutoff.unwrap_or(0.5) },
        "BLEND" => AlphaMode::Blend,
        other => {
            let problem = format!("alpha mode “{other}” is not known; it is drawn opaque");
            warnings.push(Warning::Other { code: "alpha-mode", place: here, problem });
            AlphaMode::Opaque
        }
    };
    Ok(Material {
        name: material.name.clone(),
        base_color: Vec4::from(pbr.base_color_factor),
        metallic: pbr.metallic_factor,
        roughness: pbr.roughness_factor,
        emissive: Vec3::from(material.emissive_factor) * strength,
        normal_scale: material.normal_texture.as_ref().and_then(|info| info.scale).unwrap_or(1.0),
        occlusion_strength: material.occlusion_texture.as_ref().and_then(|info| info.strength).unwrap_or(1.0),
        alpha_mode,
        double_sided: material.double_sided,
        unlit: material.extensions.contains_key("KHR_materials_unlit"),
        base_color_texture,
        metallic_roughness_texture,
        normal_texture,
        occlusion_texture,
        emissive_texture,
    })
}

fn texture_ref(
    root: &schema::Root,
    info: &schema::TextureInfo,
    place: &str,
    warnings: &mut Warnings,
) -> Result<TextureRef, Problem> {
    get(&root.textures, info.index, &format!("{place}.index"), "textures")?;
    let transform: Option<schema::TextureTransform> = extension(&info.extensions, "KHR_texture_transform", place)?;
    let transform = transform.unwrap_or_default();
    let mut uv_set = transform.tex_coord.unwrap_or(info.tex_coord);
    if uv_set > 1 {
        let problem = format!("TEXCOORD_{uv_set} is asked for; only sets 0 and 1 are read, so set 0 is used");
        warnings.push(Warning::Other { code: "texcoord-set", place: place.to_owned(), problem });
        uv_set = 0;
    }
    let uv_transform = UvTransform {
        offset: transform.offset.map_or(Vec2::ZERO, Vec2::from),
        rotation_radians: transform.rotation.unwrap_or(0.0),
        scale: transform.scale.map_or(Vec2::ONE, Vec2::from),
    };
    Ok(TextureRef { texture: info.index, uv_set, uv_transform })
}

pub fn textures(root: &schema::Root) -> Result<Vec<Texture>, Problem> {
    #[derive(serde::Deserialize)]
    struct Webp {
        source: Option<usize>,
    }
    let mut textures = Vec::with_capacity(root.textures.len());
    for (index, texture) in root.textures.iter().enumerate() {
        let here = format!("textures[{index}]");
        let webp: Option<Webp> = extension(&texture.extensions, "EXT_texture_webp", &here)?;
        let image = webp.and_then(|webp| webp.source).or(texture.source);
        if let Some(image) = image {
            get(&root.images, image, &format!("{here}.source"), "images")?;
        }
        let sampler = match texture.sampler {
            None => Sampler::default(),
            Some(sampler) => read_sampler(get(&root.samplers, sampler, &format!("{here}.sampler"), "samplers")?),
        };
        textures.push(Texture { image, sampler });
    }
    Ok(textures)
}

/// Codes as in OpenGL; unknown ones get the default.
fn read_sampler(sampler: &schema::Sampler) -> Sampler {
    let wrap = |code: Option<u32>| match code {
        Some(33071) => Wrap::ClampToEdge,
        Some(33648) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    };
    let (min, mip) = match sampler.min_filter {
        Some(9728) => (Filter::Nearest, MipFilter::None),
        Some(9729) => (Filter::Linear, MipFilter::None),
        Some(9984) => (Filter::Nearest, MipFilter::Nearest),
        Some(9985) => (Filter::Linear, MipFilter::Nearest),
        Some(9986) => (Filter::Nearest, MipFilter::Linear),
        _ => (Filter::Linear, MipFilter::Linear),
    };
    let mag = if sampler.mag_filter == Some(9728) { Filter::Nearest } else { Filter::Linear };
    Sampler { mag, min, mip, wrap_u: wrap(sampler.wrap_s), wrap_v: wrap(sampler.wrap_t) }
}
