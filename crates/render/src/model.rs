//! A model on the GPU: its primitives with their materials.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{
    AlphaMode, Geometry, Lobes, Material, Sampler, TextureRef, Topology, UvTransform, smooth_normals,
};
use gaitway_character::sort::collect_map;
use gaitway_scene::library::{Model, ModelId};
use wgpu::util::DeviceExt;

use super::geometry::{GpuGeometry, InfluenceSource, Pools, edges};
use super::layouts::primitive_layout;
use super::lobes::{self, write_lobes, write_toon};
use super::pipelines::{Features, Shading};
use super::shaders::SurfacePermutation;
use super::texture::{ImageUploader, sampler, single_texel, texture_bytes};
use super::uniform_buffer::UniformBuffer;
use super::uniforms::{MaterialUniform, UvTransformUniform};
use super::upload_error::UploadError;

/// A material's maps by slot.
type Maps = [Option<(wgpu::TextureView, wgpu::Sampler)>; TextureSlot::ALL.len()];

/// Minimum alpha at which a blended surface counts as opaque; must match surface.wgsl.
const OPAQUE_ALPHA: f32 = 0.9;

pub(super) struct GpuModel {
    pub id: ModelId,
    asset: Arc<Asset>,
    /// The primitives of each mesh; none for one with nothing to draw.
    pub meshes: Vec<Vec<Option<GpuPrimitive>>>,
    /// The uniforms of the file's materials that primitives use, by index.
    materials: BTreeMap<usize, UniformBuffer<MaterialUniform>>,
    /// The images that materials use, by their index in the asset and whether they are decoded from sRGB.
    images: BTreeMap<(usize, bool), wgpu::TextureView>,
    /// Materials whose uniform currently holds animated values.
    animated: Vec<usize>,
    /// Memory of vertices, indices and morph targets, and of images with their mip levels, in bytes.
    pub device_bytes: [u64; 2],
}

pub(super) struct GpuPrimitive {
    pub geometry: GpuGeometry,
    pub bind_group: wgpu::BindGroup,
    pub shading: Shading,
    pub features: Features,
    pub permutation: SurfacePermutation,
    pub double_sided: bool,
    /// Whether it has an outline.
    pub outlined: bool,
    /// Index in the asset; `None` is the default material.
    pub material: Option<usize>,
    /// Index buffer of the edges and its length; built when the wireframe is first shown.
    pub edges: Option<(wgpu::Buffer, u32)>,
    /// The same geometry with the materials of material variants, by the variant's index.
    variants: Vec<(usize, GpuPrimitive)>,
}

impl GpuPrimitive {
    /// Whether copies can share a draw call. Blended ones must be sorted; skinned ones need more than a palette entry
    /// each.
    pub fn can_be_instanced(&self) -> bool {
        !self.features.has(Features::BLEND) && self.geometry.influences == InfluenceSource::None
    }

    /// Returns the primitive with its material in a variant.
    pub fn in_variant(&self, variant: Option<usize>) -> &Self {
        let found = self.variants.iter().find(|&&(index, _)| Some(index) == variant);
        found.map_or(self, |(_, primitive)| primitive)
    }
}

/// Uploads models. Holds the uploader of images and placeholders for missing maps and vertex data.
pub(super) struct ModelUploader {
    pub images: ImageUploader,
    white: wgpu::TextureView,
    no_numbers: wgpu::TextureView,
    anisotropy: u16,
}

impl ModelUploader {
    /// `anisotropy` should be 1 on software adapters.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, anisotropy: u16) -> Self {
        Self {
            images: ImageUploader::new(device),
            white: single_texel(device, queue, wgpu::TextureFormat::Rgba8Unorm, &[255; 4]),
            no_numbers: single_texel(device, queue, wgpu::TextureFormat::Rgba32Float, &[0; 16]),
            anisotropy,
        }
    }

    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        model: &Model,
    ) -> Result<GpuModel, UploadError> {
        let asset = &model.asset;
        let mut materials = Materials {
            uploader: self,
            device,
            queue,
            model,
            images: HashMap::new(),
            samplers: HashMap::new(),
            layouts: HashMap::new(),
            created: HashMap::new(),
        };
        let is_drawable = |geometry: &Geometry| geometry.indices.len() >= geometry.topology.indices_per_element();
        let primitives = asset.meshes.iter().flat_map(|mesh| &mesh.primitives);
        let mut pools = Pools::new(device, primitives.filter(|geometry| is_drawable(geometry)));
        let mut meshes = Vec::with_capacity(asset.meshes.len());
        for (mesh_index, mesh) in asset.meshes.iter().enumerate() {
            let mut primitives = Vec::with_capacity(mesh.primitives.len());
            let smooth = smooth_normals(&mesh.primitives);
            for (primitive_index, (geometry, smooth)) in mesh.primitives.iter().zip(&smooth).enumerate() {
                let place = [mesh_index, primitive_index];
                primitives.push(match is_drawable(geometry) {
                    false => None,
                    true => {
                        let gpu = GpuGeometry::new(device, queue, &mut pools, geometry, smooth, place)?;
                        Some(materials.primitive_and_variants(geometry, gpu))
                    }
                });
            }
            meshes.push(primitives);
        }
        let uploaded = materials.images.drain().filter_map(|(key, view)| Some((key, view?)));
        let images = collect_map(uploaded);
        let of_file = |(index, material): (Option<usize>, GpuMaterial)| Some((index?, material.uniform));
        let materials = collect_map(materials.created.into_iter().filter_map(of_file));
        let primitives = meshes.iter().flatten().flatten();
        let geometry_bytes = primitives.map(|primitive| primitive.geometry.device_bytes()).sum();
        let device_bytes = [geometry_bytes, images.values().map(texture_bytes).sum()];
        Ok(GpuModel {
            id: model.id,
            asset: asset.clone(),
            meshes,
            materials,
            images,
            animated: Vec::new(),
            device_bytes,
        })
    }
}

impl GpuModel {
    /// Whether this is the model with the images that it has now.
    pub fn is_of(&self, model: &Model) -> bool {
        self.id == model.id && Arc::ptr_eq(&self.asset, &model.asset)
    }

    /// Returns the images of the asset, and whether sampling decodes them from sRGB; `None` for those that no material uses.
    pub fn images(&self) -> impl Iterator<Item = Option<(&wgpu::TextureView, bool)>> {
        let find =
            |image: usize| [true, false].into_iter().find_map(|srgb| Some((self.images.get(&(image, srgb))?, srgb)));
        (0..self.asset.images.len()).map(find)
    }

    /// Applies animated materials, given with their indices, and resets all others to the file's.
    pub fn animate(&mut self, queue: &wgpu::Queue, materials: &[(usize, Material)]) {
        for &index in &self.animated {
            let is_animated = materials.iter().any(|&(other, _)| other == index);
            if let (Some(uniform), false) = (self.materials.get_mut(&index), is_animated) {
                uniform.write(queue, material_uniform(&self.asset.materials[index]));
            }
        }
        self.animated.clear();
        for (index, material) in materials {
            if let Some(uniform) = self.materials.get_mut(index) {
                uniform.write(queue, material_uniform(material));
                self.animated.push(*index);
            }
        }
    }

    /// Blended and transmissive surfaces cast a shadow only if they are more than half opaque.
    pub fn casts_shadow(&self, primitive: &GpuPrimitive) -> bool {
        let is_faint = primitive.features.has(Features::BLEND) && self.alpha(primitive) <= 0.5;
        let transmission = self.uniform(primitive).map_or(0.0, |uniform| uniform.transmission);
        let is_clear = primitive.permutation.has(SurfacePermutation::TRANSMISSION) && transmission >= 0.5;
        primitive.geometry.topology == Topology::Triangles && !is_faint && !is_clear
    }

    /// Whether a blended surface may have parts that hide everything behind them.
    pub fn has_opaque_parts(&self, primitive: &GpuPrimitive) -> bool {
        primitive.geometry.topology == Topology::Triangles && self.alpha(primitive) >= OPAQUE_ALPHA
    }

    /// Returns the material's alpha, without its texture.
    fn alpha(&self, primitive: &GpuPrimitive) -> f32 {
        self.uniform(primitive).map_or(1.0, |uniform| uniform.base_color[3])
    }

    fn uniform(&self, primitive: &GpuPrimitive) -> Option<&MaterialUniform> {
        primitive.material.and_then(|index| self.materials.get(&index)).map(UniformBuffer::written)
    }

    /// Builds the edge lists of a mesh on first use.
    pub fn prepare_edges(&mut self, device: &wgpu::Device, mesh: usize) {
        let (Some(mesh), Some(primitives)) = (self.asset.meshes.get(mesh), self.meshes.get_mut(mesh)) else { return };
        for (geometry, primitive) in mesh.primitives.iter().zip(primitives) {
            let Some(primitive) = primitive.as_mut().filter(|primitive| primitive.edges.is_none()) else { continue };
            let indices = edges(&geometry.indices);
            let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("edges"),
                contents: bytemuck::cast_slice(&indices),
                usage: wgpu::BufferUsages::INDEX,
            });
            self.device_bytes[0] += buffer.size();
            primitive.edges = Some((buffer, indices.len() as u32));
        }
    }
}

/// A material's uniform buffer and maps, shared by the primitives that use it.
struct GpuMaterial {
    uniform: UniformBuffer<MaterialUniform>,
    maps: Maps,
}

/// Materials of a model during upload. An image is uploaded once as sRGB and once as linear, as its uses require.
struct Materials<'a> {
    uploader: &'a mut ModelUploader,
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    model: &'a Model,
    images: HashMap<(usize, bool), Option<wgpu::TextureView>>,
    samplers: HashMap<Sampler, wgpu::Sampler>,
    layouts: HashMap<SurfacePermutation, wgpu::BindGroupLayout>,
    created: HashMap<Option<usize>, GpuMaterial>,
}

impl Materials<'_> {
    fn primitive_and_variants(&mut self, geometry: &Geometry, gpu: GpuGeometry) -> GpuPrimitive {
        let mut primitive = self.primitive(geometry, gpu.clone(), geometry.material);
        for &(variant, material) in &geometry.variants {
            let of_variant = self.primitive(geometry, gpu.clone(), Some(material));
            primitive.variants.push((variant, of_variant));
        }
        primitive
    }

    fn primitive(&mut self, geometry: &Geometry, gpu: GpuGeometry, material: Option<usize>) -> GpuPrimitive {
        let default = Material::default();
        let asset = self.model.asset.clone();
        let found = material.and_then(|index| asset.materials.get(index));
        let key = found.and(material);
        let material = found.unwrap_or(&default);
        if !self.created.contains_key(&key) {
            let created = self.create(material);
            self.created.insert(key, created);
        }
        let plain = self
            .samplers
            .entry(Sampler::default())
            .or_insert_with(|| sampler(self.device, &Sampler::default(), self.uploader.anisotropy));
        let gpu_material = &self.created[&key];
        // Points and lines without normals have no side to light (glTF 2.0 §3.7.2.1).
        let unlit = material.unlit || (geometry.topology != Topology::Triangles && geometry.normals.is_empty());
        // A map without texture coordinates is ignored; otherwise its first texel would colour everything.
        let has_map = |slot: TextureSlot| {
            let reference = material.texture(slot).filter(|_| gpu_material.maps[slot as usize].is_some());
            // A matcap is looked up by the normal instead.
            let has_uvs = |uv_set: usize| slot == TextureSlot::Matcap || !geometry.uvs[uv_set & 1].is_empty();
            reference.is_some_and(|reference| has_uvs(reference.uv_set))
        };
        let mut lobes = if unlit { 0 } else { lobes::visible(&asset, key, material) };
        // Anisotropy needs a tangent direction.
        if geometry.uvs.iter().all(Vec::is_empty) && geometry.tangents.is_empty() {
            lobes &= !SurfacePermutation::ANISOTROPY;
        }
        let permutation = lobes::permutation(lobes, has_map);
        let layout = self.layouts.entry(permutation).or_insert_with(|| primitive_layout(self.device, permutation));
        let entries = primitive_entries(permutation, gpu_material, &gpu, plain, self.uploader);
        let bind_group = wgpu::BindGroupDescriptor { label: Some("primitive"), layout, entries: &entries };
        GpuPrimitive {
            bind_group: self.device.create_bind_group(&bind_group),
            shading: if unlit { Shading::Unlit } else { Shading::Lit },
            features: features(material, has_map, geometry),
            permutation,
            double_sided: material.double_sided,
            outlined: material.toon.as_ref().is_some_and(|toon| toon.has_outline()),
            material: key,
            edges: None,
            variants: Vec::new(),
            geometry: gpu,
        }
    }

    fn create(&mut self, material: &Material) -> GpuMaterial {
        let mut uniform = UniformBuffer::new(self.device, "material");
        uniform.write(self.queue, material_uniform(material));
        GpuMaterial { uniform, maps: TextureSlot::ALL.map(|slot| self.map(material.texture(slot)?, slot.is_color())) }
    }

    fn map(&mut self, reference: TextureRef, srgb: bool) -> Option<(wgpu::TextureView, wgpu::Sampler)> {
        let texture = self.model.asset.textures.get(reference.texture)?;
        let image = texture.image?;
        let view = self
            .images
            .entry((image, srgb))
            .or_insert_with(|| {
                let data = self.model.images.shown().get(image)?.as_ref()?;
                self.uploader.images.upload(self.device, self.queue, data, srgb)
            })
            .clone()?;
        let sampler = self
            .samplers
            .entry(texture.sampler)
            .or_insert_with(|| sampler(self.device, &texture.sampler, self.uploader.anisotropy))
            .clone();
        Some((view, sampler))
    }
}

fn material_uniform(material: &Material) -> MaterialUniform {
    let plain = TextureRef { texture: 0, uv_set: 0, uv_transform: UvTransform::IDENTITY };
    let uvs = |slot| uv_transform(material.texture(slot).unwrap_or(plain));
    let mut uniform = MaterialUniform {
        base_color: material.base_color.to_array(),
        // KHR_materials_unlit has no emission; points and lines without normals are unlit too, but keep theirs.
        emissive: if material.unlit { [0.0; 3] } else { (material.emissive * material.emissive_strength).to_array() },
        alpha_cutoff: match material.alpha_mode {
            AlphaMode::Mask { cutoff } => cutoff,
            // Cuts holes into the shadows of blended surfaces.
            AlphaMode::Opaque | AlphaMode::Blend => 0.5,
        },
        metallic: material.metallic,
        roughness: material.roughness,
        normal_scale: material.normal_scale,
        occlusion_strength: material.occlusion_strength,
        uvs: TextureSlot::ALL.map(uvs),
        ..Default::default()
    };
    write_lobes(material.lobes.as_deref().unwrap_or(&Lobes::default()), &mut uniform);
    if let Some(toon) = &material.toon {
        write_toon(toon, &mut uniform);
    }
    uniform
}

/// The parts of the surface shader that a primitive needs.
fn features(material: &Material, has_map: impl Fn(TextureSlot) -> bool, geometry: &Geometry) -> Features {
    Features::default()
        .with(Features::BASE_COLOR_MAP, has_map(TextureSlot::BaseColor))
        .with(Features::METALLIC_ROUGHNESS_MAP, has_map(TextureSlot::MetallicRoughness))
        .with(Features::NORMAL_MAP, has_map(TextureSlot::Normal))
        .with(Features::OCCLUSION_MAP, has_map(TextureSlot::Occlusion))
        .with(Features::EMISSIVE_MAP, !material.unlit && has_map(TextureSlot::Emissive))
        .with(Features::VERTEX_COLORS, !geometry.colors.is_empty() && material.toon.is_none())
        .with(Features::FLAT, geometry.normals.is_empty())
        .with(Features::TANGENTS, !geometry.tangents.is_empty())
        .with(Features::MASK, matches!(material.alpha_mode, AlphaMode::Mask { .. }))
        .with(Features::BLEND, material.alpha_mode == AlphaMode::Blend)
        .with(Features::UVS, !geometry.uvs[0].is_empty())
}

/// The entries of [`primitive_layout`]. `plain` is the sampler of the maps that the material does not have.
fn primitive_entries<'a>(
    permutation: SurfacePermutation,
    material: &'a GpuMaterial,
    geometry: &'a GpuGeometry,
    plain: &'a wgpu::Sampler,
    placeholders: &'a ModelUploader,
) -> Vec<wgpu::BindGroupEntry<'a>> {
    let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: material.uniform.binding() }];
    for map in permutation.maps() {
        let (view, sampler) =
            material.maps[map].as_ref().map_or((&placeholders.white, plain), |(view, sampler)| (view, sampler));
        let binding = SurfacePermutation::binding(map);
        entries.push(wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) });
        entries.push(wgpu::BindGroupEntry { binding: binding + 1, resource: wgpu::BindingResource::Sampler(sampler) });
    }
    let numbers = [(11, &geometry.morph_view), (12, &geometry.influence_view)];
    entries.extend(numbers.map(|(binding, numbers)| wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::TextureView(numbers.as_ref().unwrap_or(&placeholders.no_numbers)),
    }));
    entries
}

/// KHR_texture_transform: `offset · rotation · scale`. The rotation is counter-clockwise on the image, whose v axis
/// points down, hence its sign.
fn uv_transform(reference: TextureRef) -> UvTransformUniform {
    let transform = reference.uv_transform;
    let (sin, cos) = transform.rotation_radians.sin_cos();
    UvTransformUniform {
        matrix: [cos * transform.scale.x, -sin * transform.scale.x, sin * transform.scale.y, cos * transform.scale.y],
        offset: transform.offset.to_array(),
        uv_set: reference.uv_set as u32,
        padding: 0,
    }
}
