//! Materials as metallic-roughness, and their textures.
//!
//! FBX materials are Lambert or Phong, or one of a dozen physically based models that ufbx maps to common names. A
//! connected texture replaces the value it is connected to, as in the FBX SDK and Blender. Colours are taken as linear,
//! as in Blender and Godot.

use gaitway_glb::{Glb, Object, Warnings, base_name, number, numbers, percent_encoded, push, roughness_of_exponent};
use ufbx::{Material, MaterialMap, Scene, ShaderType, Texture};

const REPEAT: usize = 10497;
const CLAMP_TO_EDGE: usize = 33071;

/// Writes all materials; a mesh part refers to them by their number in the scene.
pub fn write(scene: &Scene, glb: &mut Glb, warnings: &mut Warnings) -> Vec<UvNames> {
    let mut textures =
        Textures { files: Vec::new(), samplers: Vec::new(), written: Vec::new(), webp: Vec::new(), glb, warnings };
    scene.materials.into_iter().map(|material| write_material(material, &mut textures)).collect()
}

/// Names of the UV sets that a material's `texCoord`s 0, 1, … mean. A mesh arranges its sets accordingly.
pub type UvNames = Vec<String>;

/// What has been written so far.
struct Textures<'a> {
    /// Index into `images` per file of the scene, or none if it can't be used.
    files: Vec<(u32, Option<usize>)>,
    samplers: Vec<[usize; 2]>,
    /// Image and sampler of each glTF texture.
    written: Vec<(usize, usize)>,
    /// The images that need an extension.
    webp: Vec<usize>,
    glb: &'a mut Glb,
    warnings: &'a mut Warnings,
}

fn write_material(material: &Material, textures: &mut Textures) -> UvNames {
    let mut uv_names = UvNames::new();
    let mut json = Object::new();
    let name = &*material.element.name;
    if !name.is_empty() {
        json.set("name", name);
    }
    let mut surface = Object::new();
    let pbr = &material.pbr;
    let base = used(&pbr.base_color).and_then(|texture| textures.reference(texture, &mut uv_names));
    let factor = if pbr.base_factor.has_value { unit(pbr.base_factor.value_vec4.x) } else { 1.0 };
    let color = pbr.base_color.value_vec4;
    let color = match base {
        Some(texture) => {
            surface.set("baseColorTexture", texture);
            [factor; 3]
        }
        None if pbr.base_color.has_value => [color.x, color.y, color.z].map(|c| unit(c * factor)),
        None => [0.8; 3],
    };
    let (opacity, blend) = opacity(material, textures.warnings);
    surface.set("baseColorFactor", numbers(&[color[0], color[1], color[2], opacity]));
    add_metal_and_roughness(material, &mut surface, textures, &mut uv_names);
    json.set("pbrMetallicRoughness", surface);
    if blend {
        json.set("alphaMode", "BLEND");
    }
    add_details(material, &mut json, textures, &mut uv_names);
    textures.glb.materials.push(json.into());
    uv_names
}

/// Adds normal, occlusion and emission.
fn add_details(material: &Material, json: &mut Object, textures: &mut Textures, uv_names: &mut UvNames) {
    let name = &*material.element.name;
    let pbr = &material.pbr;
    if let Some(texture) = used(&pbr.normal_map).and_then(|texture| textures.reference(texture, uv_names)) {
        json.set("normalTexture", texture);
    } else if used(&material.fbx.bump).is_some() {
        textures.warnings.add(format!("Material \"{name}\": bump map left out; glTF has normal maps only."));
    }
    if let Some(texture) = used(&pbr.ambient_occlusion).and_then(|texture| textures.reference(texture, uv_names)) {
        json.set("occlusionTexture", texture);
    }
    let emission = &pbr.emission_color;
    let strength = if pbr.emission_factor.has_value { pbr.emission_factor.value_vec4.x } else { 1.0 };
    let strength = if strength.is_finite() { strength.clamp(0.0, 1e6) } else { 1.0 };
    let texture = used(emission).filter(|_| strength > 0.0).and_then(|texture| textures.reference(texture, uv_names));
    let color = emission.value_vec4;
    let color = if texture.is_some() { [1.0; 3] } else { [color.x, color.y, color.z] };
    let color = color.map(|c| if c.is_finite() { c.max(0.0) * strength } else { 0.0 });
    let brightest = color[0].max(color[1]).max(color[2]);
    if brightest > 0.0 {
        let scale = brightest.max(1.0);
        json.set("emissiveFactor", numbers(&color.map(|c| c / scale)));
        if let Some(texture) = texture {
            json.set("emissiveTexture", texture);
        }
        if scale > 1.0 {
            textures.glb.use_extension("KHR_materials_emissive_strength");
            json.set(
                "extensions",
                Object::new()
                    .with("KHR_materials_emissive_strength", Object::new().with("emissiveStrength", number(scale))),
            );
        }
    }
    if material.features.double_sided.enabled {
        json.set("doubleSided", true);
    }
}

/// Adds metalness and roughness. glTF reads roughness from green and metalness from blue of one texture: a map
/// connected to both is assumed to be packed that way, and a grey roughness map works for a non-metallic surface. A map
/// that is left out is replaced by a medium value, since the value beside a texture is meaningless.
fn add_metal_and_roughness(material: &Material, surface: &mut Object, textures: &mut Textures, uv_names: &mut UvNames) {
    let pbr = &material.pbr;
    let (metal_map, rough_map) = (used(&pbr.metalness), used(&pbr.roughness));
    let metal = if pbr.metalness.has_value { unit(pbr.metalness.value_vec4.x) } else { 0.0 };
    let packed = metal_map.zip(rough_map).is_some_and(|(metal, rough)| same_file(metal, rough));
    let name = &*material.element.name;
    let mut left_out = |map: &str| {
        textures
            .warnings
            .add(format!("Material \"{name}\": {map} map left out; glTF needs roughness and metalness in one image."));
    };
    if metal_map.is_some() && !packed {
        left_out("metalness");
    }
    let inverted = used(&pbr.glossiness).is_some();
    if inverted {
        left_out("glossiness");
    }
    let needs_metal = metal_map.is_none() && metal > 0.0;
    if rough_map.is_some() && needs_metal {
        left_out("roughness");
    }
    let texture = rough_map.filter(|_| !needs_metal).and_then(|texture| textures.reference(texture, uv_names));
    let metallic = match metal_map {
        Some(_) if packed && texture.is_some() => 1.0,
        Some(_) => 0.0,
        None => metal,
    };
    let rough = match (&texture, rough_map.is_some() || inverted) {
        (Some(_), _) => 1.0,
        (None, true) => 0.5,
        (None, false) => roughness(material),
    };
    surface.set("metallicFactor", number(metallic));
    surface.set("roughnessFactor", number(rough));
    if let Some(texture) = texture {
        surface.set("metallicRoughnessTexture", texture);
    }
}

/// Returns the roughness. For Phong, the exponent's; a surface without specular reflection is rough.
fn roughness(material: &Material) -> f64 {
    match material.shader_type {
        ShaderType::FbxLambert | ShaderType::Unknown => 1.0,
        ShaderType::FbxPhong => {
            let fbx = &material.fbx;
            let color = fbx.specular_color.value_vec4;
            let strength = fbx.specular_factor.value_vec4.x * color.x.max(color.y).max(color.z);
            let exponent = fbx.specular_exponent.value_vec4.x;
            if strength > 0.0 && exponent > 0.0 { roughness_of_exponent(exponent) } else { 1.0 }
        }
        _ if material.pbr.roughness.has_value => unit(material.pbr.roughness.value_vec4.x),
        _ => 1.0,
    }
}

/// Returns the opacity and whether the surface needs alpha blending.
fn opacity(material: &Material, warnings: &mut Warnings) -> (f64, bool) {
    let pbr = &material.pbr;
    let map =
        if pbr.opacity.has_value || pbr.opacity.texture.is_some() { &pbr.opacity } else { &pbr.transmission_color };
    let phong = matches!(material.shader_type, ShaderType::FbxLambert | ShaderType::FbxPhong | ShaderType::Unknown);
    let is_opacity = std::ptr::eq(map, &raw const pbr.opacity);
    if let Some(texture) = used(map).filter(|_| is_opacity || phong) {
        if used(&pbr.base_color).is_some_and(|base| same_file(base, texture)) {
            return (1.0, true);
        }
        warnings.add(format!(
            "Material \"{}\": separate transparency map left out; glTF needs it in the base colour's alpha.",
            &*material.element.name
        ));
        return (1.0, false);
    }
    let opacity = if is_opacity {
        unit(map.value_vec4.x)
    } else if phong && map.has_value {
        1.0 - phong_transparency(material)
    } else {
        1.0
    };
    (opacity, opacity < 1.0)
}

/// FBX multiplies a colour and a factor. Exporters disagree about what is transparent, so that a product of 1 mostly means an
/// opaque surface; then the value that some add, `Opacity`, decides.
fn phong_transparency(material: &Material) -> f64 {
    let color = material.pbr.transmission_color.value_vec4;
    let factor = &material.pbr.transmission_factor;
    let factor = if factor.has_value { unit(factor.value_vec4.x) } else { 0.0 };
    let product = unit(factor * (color.x + color.y + color.z) / 3.0);
    if product < 1.0 {
        return product;
    }
    ufbx::find_prop(&material.element.props, "Opacity").map_or(0.0, |opacity| 1.0 - unit(opacity.value_vec4.x))
}

fn unit(value: f64) -> f64 {
    if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
}

/// Returns the image of a map: of several layers or a shader graph, the first.
fn used(map: &MaterialMap) -> Option<&Texture> {
    map.texture.as_ref().and_then(|texture| texture.file_textures.into_iter().next())
}

fn same_file(a: &Texture, b: &Texture) -> bool {
    a.has_file && b.has_file && a.file_index == b.file_index
}

impl Textures<'_> {
    /// Returns a `textureInfo`; none if the image can't be used.
    fn reference(&mut self, texture: &Texture, uv_names: &mut UvNames) -> Option<Object> {
        let image = self.image(texture)?;
        let sampler = self.sampler(texture);
        let index = self.written.iter().position(|&pair| pair == (image, sampler)).unwrap_or_else(|| {
            self.written.push((image, sampler));
            let mut json = Object::new();
            json.set("sampler", sampler);
            if self.webp.contains(&image) {
                self.glb.use_extension("EXT_texture_webp");
                json.set("extensions", Object::new().with("EXT_texture_webp", Object::new().with("source", image)));
            } else {
                json.set("source", image);
            }
            push(&mut self.glb.textures, json)
        });
        let mut json = Object::new();
        json.set("index", index);
        let set = &*texture.uv_set;
        let number = uv_names.iter().position(|name| name == set).unwrap_or_else(|| {
            uv_names.push(set.to_owned());
            uv_names.len() - 1
        });
        if number > 0 {
            json.set("texCoord", number);
        }
        if texture.has_uv_transform {
            self.add_transform(texture, &mut json);
        }
        Some(json)
    }

    fn sampler(&mut self, texture: &Texture) -> usize {
        let wrap = [texture.wrap_u, texture.wrap_v].map(|wrap| match wrap {
            ufbx::WrapMode::Clamp => CLAMP_TO_EDGE,
            ufbx::WrapMode::Repeat => REPEAT,
        });
        self.samplers.iter().position(|&other| other == wrap).unwrap_or_else(|| {
            self.samplers.push(wrap);
            push(&mut self.glb.samplers, Object::new().with("wrapS", wrap[0]).with("wrapT", wrap[1]))
        })
    }

    /// FBX measures V upwards, glTF downwards: (u, 1 - v) is mapped to (u', 1 - v').
    fn add_transform(&mut self, texture: &Texture, json: &mut Object) {
        let m = &texture.uv_to_texture;
        let (a, b, c, d) = (m.m00, -m.m01, -m.m10, m.m11);
        let offset = [m.m03 + m.m01, 1.0 - m.m13 - m.m11];
        let scale = [(a * a + c * c).sqrt(), (a * d - b * c) / (a * a + c * c).sqrt()];
        if (a * b + c * d).abs() > 1e-6 || !offset.iter().chain(&scale).all(|value| value.is_finite()) {
            let name = &*texture.element.name;
            self.warnings.add(format!("Texture \"{name}\": skewed texture coordinates left out."));
            return;
        }
        self.glb.use_extension("KHR_texture_transform");
        json.set(
            "extensions",
            Object::new().with(
                "KHR_texture_transform",
                Object::new()
                    .with("offset", numbers(&offset))
                    .with("scale", numbers(&scale))
                    .with("rotation", number(libm::atan2(-c, a))),
            ),
        );
    }

    fn image(&mut self, texture: &Texture) -> Option<usize> {
        if let Some(&(_, image)) = self.files.iter().find(|(file, _)| texture.has_file && *file == texture.file_index) {
            return image;
        }
        let image = self.write_image(texture);
        if texture.has_file {
            self.files.push((texture.file_index, image));
        }
        image
    }

    fn write_image(&mut self, texture: &Texture) -> Option<usize> {
        let path = [&texture.relative_filename, &texture.filename, &texture.absolute_filename];
        let name = path.into_iter().map(|path| base_name(path)).find(|name| !name.is_empty()).unwrap_or_default();
        let mut json = Object::new();
        if !name.is_empty() {
            json.set("name", name);
        }
        let content: &[u8] = &texture.content;
        match media_type(content) {
            Some(media_type) => {
                let view = self.glb.view(content, None);
                json.set("bufferView", view);
                json.set("mimeType", media_type);
            }
            None if !content.is_empty() => {
                self.warnings.add(format!(
                    "Embedded texture \"{name}\" left out: expected PNG, JPEG or WebP. Convert it before exporting."
                ));
                return None;
            }
            None if name.is_empty() => return None,
            None => {
                json.set("uri", percent_encoded(name));
            }
        }
        let image = push(&mut self.glb.images, json);
        if media_type(content) == Some("image/webp") {
            self.webp.push(image);
        }
        Some(image)
    }
}

fn media_type(content: &[u8]) -> Option<&'static str> {
    match content {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        _ => None,
    }
}
