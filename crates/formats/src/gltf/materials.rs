//! Materials, textures and samplers (§3.9, §3.8.4), with the extensions that change them.

use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::{AlphaMode, Filter, Material, MipFilter, Sampler, Texture, Wrap};
use glam::{Vec3, Vec4};
use gltf::json::material::AlphaMode as JsonAlphaMode;
use gltf::json::texture::{MagFilter, MinFilter, Sampler as JsonSampler, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{self, Root};

use super::accessor::get;
use super::document::{Document, present};
use super::material_reader::{TextureReader, extension};
use super::{lobes, mtoon, vrm};
use crate::error::Problem;

/// Maximum number of textures of a material. WebGL2 has 16 texture units, of which lighting, skinning and transmission
/// take eight.
const MAX_TEXTURES: usize = 8;
/// The textures to drop first if a material has too many, least noticeable first.
const DISPENSABLE: [TextureSlot; 12] = [
    TextureSlot::ShadingShift,
    TextureSlot::IridescenceThickness,
    TextureSlot::SheenRoughness,
    TextureSlot::Specular,
    TextureSlot::Thickness,
    TextureSlot::ClearcoatRoughness,
    TextureSlot::ClearcoatNormal,
    TextureSlot::Iridescence,
    TextureSlot::DiffuseTransmissionColor,
    TextureSlot::Anisotropy,
    TextureSlot::SheenColor,
    TextureSlot::Clearcoat,
];

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
        drop_surplus_textures(&mut read, &mut reader);
    }
    let vrm_0 = document.root.extensions.as_ref().and_then(|extensions| extensions.others.get("VRM"));
    if let Some(properties) = vrm_0.and_then(|vrm| vrm["materialProperties"].get(index)) {
        let place = format!("extensions.VRM.materialProperties[{index}]");
        let mut reader = TextureReader { root: &document.root, material: &place, warnings: reader.warnings };
        vrm::mtoon::read_0(properties, &mut read, &mut reader)?;
    }
    Ok(read)
}

/// Keeps at most [`MAX_TEXTURES`] textures, with a warning that names the others.
fn drop_surplus_textures(material: &mut Material, reader: &mut TextureReader<'_>) {
    let count = TextureSlot::ALL.into_iter().filter(|&slot| material.texture(slot).is_some()).count();
    let surplus = count.saturating_sub(MAX_TEXTURES);
    let dispensable = DISPENSABLE.into_iter().filter(|&slot| material.texture(slot).is_some());
    let dropped: Vec<TextureSlot> = dispensable.take(surplus).collect();
    for &slot in &dropped {
        material.set_texture(slot, None);
    }
    if surplus > 0 {
        let names: Vec<&str> = lobes::TEXTURES
            .iter()
            .chain(&mtoon::TEXTURES)
            .filter(|(_, slot)| dropped.contains(slot))
            .map(|(path, _)| *path)
            .collect();
        let problem =
            format!("{count} textures, of which only {MAX_TEXTURES} can be shown; shown without {}", names.join(", "));
        reader.warnings.push(Warning::Other { code: "texture-count", place: reader.material.to_owned(), problem });
    }
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

/// A texture whose image is missing is empty; one whose sampler is missing gets the default.
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
                problem.leave_out("texture", "the default sampler is used", warnings)?;
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
