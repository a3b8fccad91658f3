//! Materials as metallic-roughness.
//!
//! DirectX multiplies the sum of lighting and emission by the texture in display values, so colours are sRGB. As in
//! FBX, a texture replaces the colour: modelling programs leave a grey there that they don't show.

use gaitway_glb::{Glb, Object, base_name, linear, number, numbers, percent_encoded, push, roughness_of_exponent};

use crate::document::{Document, Names, text};

/// The materials and images that have been written.
pub struct Materials<'a> {
    /// glTF material of each object that is one.
    of_object: Vec<Option<usize>>,
    names: Names<'a>,
    /// Names of image files in ascending order, with the textures that were written for them.
    textures: Vec<(String, usize)>,
}

impl<'a> Materials<'a> {
    /// Writes all materials.
    pub fn write(document: &Document<'a>, glb: &mut Glb) -> Result<Materials<'a>, String> {
        let of_object = vec![None; document.objects.len()];
        let mut materials = Materials { of_object, names: Names::of(document, "Material"), textures: Vec::new() };
        materials.write_textures(document, glb);
        for (index, _) in document.all("Material") {
            materials.of_object[index] = Some(materials.write_one(document, index, glb)?);
        }
        Ok(materials)
    }

    /// Returns the materials of a `MeshMaterialList`, in order.
    pub fn of_list(&self, document: &Document, list: usize) -> Vec<Option<usize>> {
        let children = document.objects[list].children.iter().map(|&child| (child, &document.objects[child]));
        let materials = children.filter(|(_, object)| object.is("Material") || object.is_reference());
        let found = |(index, object): (usize, &crate::document::Object)| {
            let index = if object.is_reference() { self.names.find(object.name) } else { Some(index) };
            self.of_object[index?]
        };
        materials.map(found).collect()
    }

    /// Writes an image and a texture for each file that is named.
    fn write_textures(&mut self, document: &Document, glb: &mut Glb) {
        let mut files: Vec<String> =
            document.all("TextureFilename").filter_map(|(index, _)| texture_file(document, index)).collect();
        files.sort_unstable();
        files.dedup();
        for file in files {
            let image = push(&mut glb.images, Object::new().with("name", &*file).with("uri", percent_encoded(&file)));
            let texture = push(&mut glb.textures, Object::new().with("source", image));
            self.textures.push((file, texture));
        }
    }

    fn texture(&self, document: &Document, material: usize) -> Option<Object> {
        let (index, _) = document.children(material, "TextureFilename").next()?;
        let file = texture_file(document, index)?;
        let at = self.textures.partition_point(|(other, _)| *other < file);
        let (_, texture) = self.textures.get(at)?;
        Some(Object::new().with("index", *texture))
    }

    fn write_one(&self, document: &Document, index: usize, glb: &mut Glb) -> Result<usize, String> {
        let mut values = document.numbers(index);
        let [red, green, blue, alpha] = values.array("a colour")?;
        let [exponent] = values.array("an exponent")?;
        let specular: [f64; 3] = values.array("a specular colour")?;
        let emission = values.array::<3>("an emissive colour")?.map(|value| f64::from(linear(value)));
        let texture = self.texture(document, index);
        let mut surface = Object::new();
        let color = match &texture {
            Some(texture) => {
                surface.set("baseColorTexture", texture.clone());
                [1.0; 3]
            }
            None => [red, green, blue].map(|value| f64::from(linear(value))),
        };
        let alpha = alpha.clamp(0.0, 1.0);
        surface.set("baseColorFactor", numbers(&[color[0], color[1], color[2], alpha]));
        let shines = exponent > 0.0 && specular.iter().any(|&value| value > 0.0);
        let roughness = if shines { roughness_of_exponent(exponent) } else { 1.0 };
        surface.set("metallicFactor", 0);
        surface.set("roughnessFactor", number(roughness));
        let mut json = Object::new();
        let name = document.objects[index].name;
        if !name.is_empty() {
            json.set("name", text(name));
        }
        json.set("pbrMetallicRoughness", surface);
        if alpha < 1.0 {
            json.set("alphaMode", "BLEND");
        }
        if emission.iter().any(|&value| value > 0.0) {
            json.set("emissiveFactor", numbers(&emission));
            if let Some(texture) = texture {
                json.set("emissiveTexture", texture);
            }
        }
        Ok(push(&mut glb.materials, json))
    }
}

fn texture_file(document: &Document, index: usize) -> Option<String> {
    let path = text(document.objects[index].strings.first()?);
    Some(base_name(&path).to_owned()).filter(|name| !name.is_empty())
}
