//! Texts of the Info tab about materials, images and influences, made once per model.

use gaitway_character::anim::{JointIndex, TextureSlot};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{AlphaMode, Material};
use gaitway_scene::library::{Model, ModelId};
use gaitway_scene::state::{title, used_materials};

use crate::ui::text;

/// Maximum number of names in a line.
const MAX_NAMES: usize = 3;

/// Texts about one model.
#[derive(Debug, Default)]
pub struct Lists {
    model: Option<ModelId>,
    pub materials: Vec<MaterialText>,
    pub images: Vec<ImageText>,
    /// Influences per vertex.
    pub influences: String,
}

#[derive(Debug)]
pub struct MaterialText {
    /// `None` is the default material.
    pub index: Option<usize>,
    pub name: String,
    /// A line each for alpha mode and maps, extensions, and the nodes that use it.
    pub facts: String,
}

#[derive(Debug)]
pub struct ImageText {
    pub name: String,
    /// Format, size, memory and the maps it is used as.
    pub line: String,
}

impl Lists {
    /// Returns the texts about a model, made again only for another one.
    pub fn of(&mut self, model: &Model) -> &Self {
        if self.model != Some(model.id) {
            let asset = &model.asset;
            let materials = used_materials(asset).into_iter().map(|index| material_text(asset, index)).collect();
            let images = (0..asset.images.len()).map(|image| image_text(model, image)).collect();
            *self = Self { model: Some(model.id), materials, images, influences: influences(asset) };
        }
        self
    }
}

fn influences(asset: &Asset) -> String {
    let (mut max, mut over_four) = (0, 0);
    for geometry in asset.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        let influences = &geometry.influences;
        for weights in influences.weights.chunks(influences.stride.max(1)) {
            let count = weights.iter().filter(|&&weight| weight > 0.0).count();
            max = max.max(count);
            over_four += usize::from(count > 4);
        }
    }
    text::influences(max, over_four)
}

fn material_text(asset: &Asset, index: Option<usize>) -> MaterialText {
    let default = Material::default();
    let material = index.and_then(|index| asset.materials.get(index)).unwrap_or(&default);
    let alpha = match material.alpha_mode {
        AlphaMode::Opaque => text::OPAQUE,
        AlphaMode::Mask { .. } => text::MASKED,
        AlphaMode::Blend => text::BLENDED,
    };
    let sides = material.double_sided.then_some(text::DOUBLE_SIDED);
    let maps = TextureSlot::ALL.into_iter().filter(|&slot| material.texture(slot).is_some()).map(text::map_name);
    let first = std::iter::once(alpha).chain(sides).chain(maps).collect::<Vec<_>>().join(", ");
    let extensions = material.extensions().join(", ");
    let lines = [first, extensions, text::used_by(&users(asset, index), MAX_NAMES)];
    MaterialText {
        index,
        name: text::material(index, &material.name),
        facts: lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n"),
    }
}

/// The names of the nodes that draw surfaces with a material, in any variant.
fn users(asset: &Asset, material: Option<usize>) -> Vec<String> {
    let uses = |mesh: usize| {
        asset.meshes[mesh].primitives.iter().any(|geometry| {
            geometry.material == material || geometry.variants.iter().any(|&(_, other)| Some(other) == material)
        })
    };
    let mut joints: Vec<JointIndex> =
        asset.instances.iter().filter(|instance| uses(instance.mesh)).map(|instance| instance.joint).collect();
    joints.dedup();
    joints.into_iter().map(|joint| title(None, asset, joint).into_owned()).collect()
}

fn image_text(model: &Model, index: usize) -> ImageText {
    let image = &model.asset.images[index];
    let is_used_as = |slot: &TextureSlot| {
        let textures = model.asset.materials.iter().filter_map(|material| material.texture(*slot));
        let mut textures = textures.filter_map(|reference| model.asset.textures.get(reference.texture));
        textures.any(|texture| texture.image == Some(index))
    };
    let maps: Vec<&str> = TextureSlot::ALL.into_iter().filter(is_used_as).map(text::map_name).collect();
    let bytes = model.images.shown().get(index).and_then(Option::as_ref).map_or(0, |data| data.device_bytes());
    let name = if image.name.is_empty() { text::image(index) } else { image.name.clone() };
    ImageText { name, line: text::image_facts(image.mime, [image.width, image.height], bytes, &maps) }
}
