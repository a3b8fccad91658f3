//! Materials as Phong, whose values importers of Unity, Unreal and Blender turn into those of their own, and textures inside the
//! file.

use gaitway_character::asset::{Asset, Image};
use gaitway_character::mesh::{AlphaMode, Geometry, Material, TextureRef, UvTransform, Wrap};

use crate::FbxRecipient;
use crate::mesh::UV_SETS;
use crate::names::Names;
use crate::objects::{Id, Objects};
use crate::record::{Properties, Record};

/// Blender and most others take twice of this for the reflection of a dielectric, of which 0.5 is ordinary.
const SPECULAR_FACTOR: f64 = 0.25;
/// The largest exponent, of a mirror.
const MAX_EXPONENT: f64 = 10_000.0;

/// Objects of materials and textures that were written.
#[derive(Debug)]
pub struct Materials {
    of_asset: Vec<Option<Id>>,
    default: Option<Id>,
    /// Texture and video by texture of the asset and set of coordinates.
    textures: Vec<((usize, usize), Option<Id>)>,
    videos: Vec<Option<(Id, String)>>,
    names: Names,
    video_names: Names,
    /// Names of images that FBX readers don't know.
    pub unknown_images: Vec<String>,
    /// Names of materials with maps that Phong doesn't have.
    pub simplified: Vec<String>,
    recipient: FbxRecipient,
}

/// Returns the transform of a primitive's texture coordinates that all of its textures agree about.
pub fn uv_transform(asset: &Asset, geometry: &Geometry, set: usize) -> UvTransform {
    let material = geometry.material.and_then(|material| asset.materials.get(material));
    let mut transforms = material.into_iter().flat_map(|material| {
        let textures = maps(material).into_iter().filter_map(|(texture, _)| texture);
        textures.filter(|texture| texture.uv_set == set).map(|texture| texture.uv_transform)
    });
    let Some(first) = transforms.next() else { return UvTransform::IDENTITY };
    if transforms.all(|other| other == first) { first } else { UvTransform::IDENTITY }
}

/// The textures that Phong has, and the properties that they replace.
fn maps(material: &Material) -> [(Option<TextureRef>, &'static str); 4] {
    let is_clear = material.alpha_mode != AlphaMode::Opaque;
    [
        (material.base_color_texture, "DiffuseColor"),
        (material.base_color_texture.filter(|_| is_clear), "TransparentColor"),
        (material.normal_texture, "NormalMap"),
        (material.emissive_texture, "EmissiveColor"),
    ]
}

impl Materials {
    pub fn new(asset: &Asset, recipient: FbxRecipient) -> Materials {
        Materials {
            of_asset: vec![None; asset.materials.len()],
            default: None,
            textures: Vec::new(),
            videos: vec![None; asset.images.len()],
            names: Names::default(),
            video_names: Names::default(),
            unknown_images: Vec::new(),
            simplified: Vec::new(),
            recipient,
        }
    }

    /// Returns the object of a material, which is written at the first call.
    pub fn get(&mut self, asset: &Asset, material: Option<usize>, objects: &mut Objects) -> Id {
        let known = match material {
            Some(material) => self.of_asset[material],
            None => self.default,
        };
        known.unwrap_or_else(|| {
            let id = match material {
                Some(material) => self.write(asset, &asset.materials[material], objects),
                None => self.write(asset, &Material { name: "default".to_owned(), ..Material::default() }, objects),
            };
            match material {
                Some(material) => self.of_asset[material] = Some(id),
                None => self.default = Some(id),
            }
            id
        })
    }

    fn write(&mut self, asset: &Asset, material: &Material, objects: &mut Objects) -> Id {
        let name = self.names.unique(if material.name.is_empty() { "material" } else { &material.name });
        let properties = properties(material, self.recipient).record();
        let id = objects.add("Material", (&name, "Material", ""), |record| {
            record
                .with(Record::new("Version").i32(102))
                .with(Record::new("ShadingModel").text("phong"))
                .with(Record::new("MultiLayer").i32(0))
                .with(properties)
        });
        for (texture, property) in maps(material) {
            let Some(texture) = texture else { continue };
            if let Some(texture) = self.texture(asset, texture, objects) {
                objects.connect_property(texture, id, property);
            }
        }
        if material.metallic_roughness_texture.is_some() || material.occlusion_texture.is_some() {
            self.simplified.push(name);
        }
        id
    }

    fn texture(&mut self, asset: &Asset, reference: TextureRef, objects: &mut Objects) -> Option<Id> {
        let key = (reference.texture, reference.uv_set);
        if let Some(&(_, known)) = self.textures.iter().find(|(other, _)| *other == key) {
            return known;
        }
        let texture = &asset.textures[reference.texture];
        let video = texture.image.and_then(|image| self.video(&asset.images[image], image, objects));
        let id = video.map(|(video, file)| {
            let wrap = |wrap: Wrap| i32::from(wrap == Wrap::ClampToEdge);
            let properties = Properties::new()
                .text("UVSet", UV_SETS[reference.uv_set.min(UV_SETS.len() - 1)])
                .choice("WrapModeU", wrap(texture.sampler.wrap_u))
                .choice("WrapModeV", wrap(texture.sampler.wrap_v))
                .flag("UseMaterial", true);
            let stem = file.rsplit_once('.').map_or(&*file, |(stem, _)| stem);
            let id = objects.add("Texture", (stem, "Texture", ""), |record| {
                record
                    .with(Record::new("Type").text("TextureVideoClip"))
                    .with(Record::new("Version").i32(202))
                    .with(Record::new("TextureName").object_name(stem, "Texture"))
                    .with(properties.record())
                    .with(Record::new("Media").object_name(stem, "Video"))
                    .with(Record::new("FileName").text(&file))
                    .with(Record::new("RelativeFilename").text(&file))
                    .with(Record::new("ModelUVTranslation").f64(0.0).f64(0.0))
                    .with(Record::new("ModelUVScaling").f64(1.0).f64(1.0))
                    .with(Record::new("Texture_Alpha_Source").text("None"))
                    .with(Record::new("Cropping").i32(0).i32(0).i32(0).i32(0))
            });
            objects.connect(video, id);
            id
        });
        self.textures.push((key, id));
        id
    }

    /// Embeds an image.
    fn video(&mut self, image: &Image, index: usize, objects: &mut Objects) -> Option<(Id, String)> {
        if let Some(known) = &self.videos[index] {
            return Some(known.clone());
        }
        let whole = image.name.rsplit(['/', '\\']).next().unwrap_or_default();
        let known = [".png", ".jpg", ".jpeg"];
        let lower = whole.to_lowercase();
        let stem = known.iter().find(|end| lower.ends_with(**end));
        let stem = stem.and_then(|end| whole.get(..whole.len() - end.len())).unwrap_or(whole);
        let extension = match &image.bytes[..] {
            [0x89, b'P', b'N', b'G', ..] => "png",
            [0xff, 0xd8, 0xff, ..] => "jpg",
            _ => {
                let name = if stem.is_empty() { format!("#{index}") } else { stem.to_owned() };
                if !self.unknown_images.contains(&name) {
                    self.unknown_images.push(name);
                }
                return None;
            }
        };
        let stem = self.video_names.unique(if stem.is_empty() { "texture" } else { stem });
        let file = format!("{stem}.{extension}");
        let video = objects.add("Video", (&stem, "Video", "Clip"), |record| {
            record
                .with(Record::new("Type").text("Clip"))
                .with(Properties::new().text("Path", &file).record())
                .with(Record::new("UseMipMap").i32(0))
                .with(Record::new("Filename").text(&file))
                .with(Record::new("RelativeFilename").text(&file))
                .with(Record::new("Content").raw(&image.bytes))
        });
        self.videos[index] = Some((video, file.clone()));
        Some((video, file))
    }
}

fn properties(material: &Material, recipient: FbxRecipient) -> Properties {
    let color = |rgb: [f32; 3]| rgb.map(f64::from);
    let alpha = match material.alpha_mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask { .. } | AlphaMode::Blend => f64::from(material.base_color.w.clamp(0.0, 1.0)),
    };
    let base = color(material.base_color.truncate().to_array());
    let exponent = exponent(f64::from(material.roughness), recipient);
    Properties::new()
        .color("DiffuseColor", base)
        .number("DiffuseFactor", 1.0)
        .color("AmbientColor", [0.0; 3])
        .color("EmissiveColor", color(material.emissive.to_array()))
        .number("EmissiveFactor", material.emissive_strength.into())
        .color("TransparentColor", [1.0; 3])
        .number("TransparencyFactor", 1.0 - alpha)
        .number("Opacity", alpha)
        .color("SpecularColor", [1.0; 3])
        .number("SpecularFactor", SPECULAR_FACTOR)
        .number("Shininess", exponent)
        .number("ShininessExponent", exponent)
        .color("ReflectionColor", [1.0; 3])
        .number("ReflectionFactor", material.metallic.into())
}

/// Returns Phong's exponent for a roughness: with the widest agreement, that of a highlight as wide as in Walter et al. 2007;
/// Blender has a rule of its own.
fn exponent(roughness: f64, recipient: FbxRecipient) -> f64 {
    let roughness = roughness.clamp(0.0, 1.0);
    if recipient == FbxRecipient::Blender {
        let part = 10.0 * (1.0 - roughness);
        return part * part;
    }
    (2.0 / (roughness * roughness) - 2.0).min(MAX_EXPONENT)
}
