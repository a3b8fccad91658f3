//! Chooses what to draw of a frame's meshes, in which order and with which pipeline.
//!
//! The palette entries of a mesh's copies are consecutive, so that one instanced call draws them. Blended surfaces draw the
//! depth of their nearly opaque parts first, each right before its colour: triangles aren't sorted, but hair and lashes hide
//! what is behind them. Masks use alpha to coverage in front of an opaque background, which keeps the picture's alpha.

use gaitway_character::mesh::Topology;
use gaitway_scene::frame::{Character, Draw, Frame};
use gaitway_scene::state::{Background, Channel, ToneMap};

use super::layouts::Layouts;
use super::model::{GpuModel, GpuPrimitive};
use super::palette::PaletteTexture;
use super::pipelines::{Features, MeshKey, MeshPipeline, Pipelines, Shading};
use super::shaders::SurfacePermutation;
use super::uniforms::DrawUniform;

/// Stride of the draw uniforms: the alignment WebGPU and WebGL2 require of dynamic offsets.
const ALIGNMENT: usize = 256;
const WIREFRAME_OVER_MESH: [f32; 4] = [0.0, 0.0, 0.0, 0.2];
const WIREFRAME_ALONE: [f32; 4] = [0.15, 0.25, 0.38, 0.75];
/// Opaque, so that edges that two primitives share are not darker.
const WIREFRAME_CHANNEL: [f32; 4] = [0.1, 0.2, 0.34, 1.0];

/// One draw call.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    /// See [`Character::pane`].
    pub pane: Option<u32>,
    model: usize,
    mesh: usize,
    primitive: usize,
    /// The character's material variant.
    variant: Option<usize>,
    pub pipeline: MeshPipeline,
    /// Byte offset of the draw's uniform in the dynamic buffer.
    pub offset: u32,
    /// Number of copies to draw, each with its own palette entry.
    pub copies: u32,
    /// Draws the edges instead of the triangles.
    pub edges: bool,
    /// Writes depth but no colour.
    pub depth_only: bool,
    /// View depth, for sorting.
    distance: f32,
}

/// Maximum number of blended draws. Copies of a blended mesh beyond it share one draw and aren't sorted.
const MAX_SORTED: usize = 1 << 14;

impl Item {
    pub fn primitive<'a>(&self, models: &'a [GpuModel]) -> Option<&'a GpuPrimitive> {
        let primitive = models.get(self.model)?.meshes.get(self.mesh)?.get(self.primitive)?.as_ref()?;
        // Edges have no material.
        Some(if self.edges { primitive } else { primitive.in_variant(self.variant) })
    }
}

/// Whether the edges of triangles are drawn.
fn shows_edges(frame: &Frame) -> bool {
    frame.look.wireframe || frame.look.channel == Channel::Wireframe
}

/// What the primitives of a mesh instance and its copies have in common.
struct Instance<'a> {
    frame: &'a Frame,
    character: &'a Character,
    draw: &'a Draw,
    /// Number of copies, including `draw`.
    copies: u32,
    /// Index into the renderer's models.
    model: usize,
    /// First entry in the palette texture.
    palette: u32,
    /// First texel and number of the active morph weights.
    morph_weights: (u32, u32),
    /// Features that depend on the frame's lights.
    lighting: Features,
    multisampled: bool,
    /// A shadow map is drawn.
    shadow: bool,
    distance: f32,
}

impl Instance<'_> {
    fn uniform(&self, primitive: &GpuPrimitive) -> DrawUniform {
        let geometry = &primitive.geometry;
        let (morph_weights, morph_count) = self.morph_weights;
        let look = &self.frame.look;
        DrawUniform {
            palette: self.palette,
            morph_weights,
            morph_count: if geometry.morph_view.is_some() { morph_count } else { 0 },
            morph_attributes: geometry.morph_attributes,
            vertices: geometry.vertices,
            influence_stride: geometry.influence_stride,
            heat_joint: self.draw.heat_joint.unwrap_or(u32::MAX),
            channel: look.channel as u32,
            color: match (look.mesh, look.channel) {
                (true, Channel::Wireframe) => WIREFRAME_CHANNEL,
                (true, _) => WIREFRAME_OVER_MESH,
                (false, _) => WIREFRAME_ALONE,
            },
        }
    }

    fn mesh_key(&self, primitive: &GpuPrimitive) -> MeshKey {
        let geometry = &primitive.geometry;
        let shows_channel = self.frame.look.channel != Channel::Shaded;
        let shading = match self.draw.heat_joint {
            _ if shows_channel => Shading::Channel,
            Some(_) => Shading::Heat,
            None => primitive.shading,
        };
        let mut features = primitive.features.with(self.lighting, shading == Shading::Lit);
        if !shows_channel {
            features = features.without(Features::UVS);
        }
        if self.frame.look.smooth && geometry.topology == Topology::Triangles {
            features = features.without(Features::FLAT);
        }
        MeshKey {
            shading,
            permutation: if shows_channel { primitive.permutation.of_channels() } else { primitive.permutation },
            influences: geometry.influences,
            skinning: self.character.skinning,
            topology: geometry.topology,
            features,
            cull: (!primitive.double_sided).then_some(wgpu::Face::Back),
            mirrored: self.draw.mirrored,
            // The other kinds of shading have no use for it.
            tone_map: if shading == Shading::Lit { self.frame.look.tone_map } else { ToneMap::default() },
            // A transparent background needs the alpha that coverage replaces.
            coverage: self.multisampled
                && features.has(Features::MASK)
                && self.frame.look.background != Background::Transparent,
        }
    }
}

/// The key that draws the same surface into the shadow map.
fn shadow_key(key: MeshKey) -> MeshKey {
    let has_holes = key.features.has(Features::MASK) || key.features.has(Features::BLEND);
    let alpha_sources = Features::BASE_COLOR_MAP.with(Features::VERTEX_COLORS, true);
    let features =
        if has_holes { key.features.only(alpha_sources).with(Features::MASK, true) } else { Features::default() };
    MeshKey { shading: Shading::Shadow, features, ..plain_key(key) }
}

/// The key that draws the depth of the opaque parts of a blended surface.
fn depth_key(key: MeshKey) -> MeshKey {
    let features = key.features.only(Features::BASE_COLOR_MAP.with(Features::VERTEX_COLORS, true));
    let permutation = key.permutation.without_channels();
    MeshKey { shading: Shading::Depth, permutation, features, tone_map: ToneMap::default(), ..key }
}

/// The key that draws an MToon surface's outline, if it has one. Blended surfaces get none, because it would show
/// through them; nor do flat-shaded ones, because it would tear at the edges.
fn outline_key(primitive: &GpuPrimitive, key: MeshKey) -> Option<MeshKey> {
    let has_outline = primitive.outlined
        && key.shading == Shading::Lit
        && key.topology == Topology::Triangles
        && !key.features.has(Features::BLEND)
        && !key.features.has(Features::FLAT);
    let features = key.features.with(Features::OUTLINE, true);
    has_outline.then_some(MeshKey { features, cull: Some(wgpu::Face::Front), ..key })
}

/// The key that draws the surface's edges.
fn wireframe_key(key: MeshKey) -> MeshKey {
    MeshKey { shading: Shading::Wireframe, topology: Topology::Lines, ..plain_key(key) }
}

/// The key that draws the depth of the whole surface, without holes, so that it hides the edges behind it.
fn occluder_key(key: MeshKey) -> MeshKey {
    MeshKey { shading: Shading::Occluder, ..plain_key(key) }
}

/// A key without anything that only materials need.
fn plain_key(key: MeshKey) -> MeshKey {
    MeshKey {
        permutation: key.permutation.without_channels(),
        features: Features::default(),
        cull: None,
        mirrored: false,
        tone_map: ToneMap::default(),
        coverage: false,
        ..key
    }
}

/// Depth-only draws of a primitive.
#[derive(Clone, Copy)]
struct DepthDraws {
    /// Into the shadow map.
    shadow: bool,
    /// Into the scene, for the opaque parts of a blended surface.
    opaque_parts: bool,
}

/// Draw calls of a frame, reused between frames.
pub(super) struct DrawList {
    shadow: Vec<Item>,
    solid: Vec<Item>,
    transmissive: Vec<Item>,
    blended: Vec<Item>,
    has_transmission: bool,
    uniforms: Vec<u8>,
    uploaded: Vec<u8>,
    buffer: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

impl DrawList {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let (buffer, bind_group) = create(device, layouts, 16 * ALIGNMENT);
        Self {
            shadow: Vec::new(),
            solid: Vec::new(),
            transmissive: Vec::new(),
            blended: Vec::new(),
            has_transmission: false,
            uniforms: Vec::new(),
            uploaded: Vec::new(),
            buffer,
            bind_group,
        }
    }

    pub fn shadow(&self) -> &[Item] {
        &self.shadow
    }

    /// Front to back.
    pub fn solid(&self) -> &[Item] {
        &self.solid
    }

    /// Back to front, so that the front of a volume covers its back.
    pub fn transmissive(&self) -> &[Item] {
        &self.transmissive
    }

    /// Whether anything reads the transmission buffer.
    pub fn has_transmission(&self) -> bool {
        self.has_transmission
    }

    /// Back to front, then wireframes; without surfaces, their depth and then wireframes.
    pub fn blended(&self) -> &[Item] {
        &self.blended
    }

    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// Fills the lists and the palette. `shadow` says whether a shadow map is drawn.
    pub fn collect<'a>(
        &mut self,
        device: &wgpu::Device,
        frame: &'a Frame,
        models: &mut [GpuModel],
        pipelines: &mut Pipelines,
        palette: &mut PaletteTexture,
        shadow: bool,
    ) {
        self.shadow.clear();
        self.solid.clear();
        self.transmissive.clear();
        self.blended.clear();
        self.has_transmission = false;
        self.uniforms.clear();
        palette.clear();
        if !frame.look.mesh && !shows_edges(frame) {
            return;
        }
        for character in &frame.characters {
            palette.push_palette(&character.palette);
        }
        let lighting =
            Features::default().with(Features::SHADOW, shadow).with(Features::FILE_LIGHTS, !frame.lights.is_empty());
        let multisampled = pipelines.is_multisampled();
        let mut next_palette = 0;
        for character in &frame.characters {
            let first_palette = next_palette;
            next_palette += character.palette.len() as u32;
            let Some(model) = models.iter().position(|model| model.id == character.model) else { continue };
            for copies in character.draws.chunk_by(|draw, next| next.is_copy && next.mirrored == draw.mirrored) {
                let Some(draw) = copies.first().filter(|draw| draw.visible) else { continue };
                if shows_edges(frame) {
                    models[model].prepare_edges(device, draw.mesh);
                }
                let morph_weights = palette.push_morph_weights(character.morph_weights_of(draw));
                let instance = |draws: &'a [Draw]| Instance {
                    frame,
                    character,
                    draw: &draws[0],
                    copies: draws.len() as u32,
                    model,
                    palette: first_palette + draws[0].palette.start,
                    morph_weights,
                    lighting,
                    multisampled,
                    shadow,
                    distance: -frame.view.view_from_world.transform_point3(draws[0].center).z,
                };
                self.add_mesh(device, pipelines, &models[model], copies, instance);
            }
        }
        self.solid.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.offset.cmp(&b.offset)));
        // Stable sorts keep the file's order within a mesh.
        self.transmissive.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        self.blended.sort_by(|a, b| a.edges.cmp(&b.edges).then(b.distance.total_cmp(&a.distance)));
    }

    /// Adds the items of a mesh and its copies. `instance` combines adjacent copies into one instance.
    fn add_mesh<'a>(
        &mut self,
        device: &wgpu::Device,
        pipelines: &mut Pipelines,
        model: &GpuModel,
        copies: &'a [Draw],
        instance: impl Fn(&'a [Draw]) -> Instance<'a>,
    ) {
        let Some(primitives) = copies.first().and_then(|draw| model.meshes.get(draw.mesh)) else { return };
        for (index, primitive) in primitives.iter().enumerate() {
            let Some(primitive) = primitive else { continue };
            let combined = instance(copies);
            let shown = primitive.in_variant(combined.character.variant);
            if combined.character.hidden_materials.contains(&shown.material) {
                continue;
            }
            let depth_draws = DepthDraws {
                shadow: combined.shadow && model.casts_shadow(shown),
                opaque_parts: shown.features.has(Features::BLEND) && model.has_opaque_parts(shown),
            };
            if shown.can_be_instanced() || self.blended.len() + copies.len() > MAX_SORTED {
                self.add(device, pipelines, &combined, index, primitive, depth_draws);
                continue;
            }
            for draw in copies.chunks(1) {
                self.add(device, pipelines, &instance(draw), index, primitive, depth_draws);
            }
        }
    }

    /// Adds the items of one primitive, with the material of the character's variant.
    fn add(
        &mut self,
        device: &wgpu::Device,
        pipelines: &mut Pipelines,
        instance: &Instance<'_>,
        index: usize,
        primitive: &GpuPrimitive,
        depth_draws: DepthDraws,
    ) {
        let (look, pane) = (&instance.frame.look, instance.character.pane);
        let is_surface = primitive.geometry.topology == Topology::Triangles;
        let edges = shows_edges(instance.frame);
        let wireframe = wireframe_key(instance.mesh_key(primitive));
        let primitive = primitive.in_variant(instance.character.variant);
        let offset = self.push_uniform(&instance.uniform(primitive));
        let key = instance.mesh_key(primitive);
        let mut item = |key: MeshKey, edges| Item {
            pane,
            model: instance.model,
            mesh: instance.draw.mesh,
            primitive: index,
            variant: instance.character.variant,
            pipeline: pipelines.mesh(device, key),
            offset,
            copies: instance.copies,
            edges,
            depth_only: matches!(key.shading, Shading::Depth | Shading::Occluder),
            distance: instance.distance,
        };
        if look.mesh {
            // The nearest opaque layer of a blended surface hides the others, whatever the order of the triangles.
            if depth_draws.opaque_parts {
                self.blended.push(item(depth_key(key), false));
            }
            let is_transmissive = key.shading == Shading::Lit && key.permutation.has(SurfacePermutation::TRANSMISSION);
            self.has_transmission |= is_transmissive;
            if is_transmissive && !key.features.has(Features::BLEND) {
                self.transmissive.push(item(key, false));
            } else if !key.features.has(Features::BLEND) {
                self.solid.push(item(key, false));
                // An outline would hide the wireframe.
                if let Some(key) = outline_key(primitive, key).filter(|_| !edges) {
                    self.solid.push(item(key, false));
                }
            } else if primitive.double_sided && is_surface {
                // Back faces first, so that front faces blend over them.
                for cull in [wgpu::Face::Front, wgpu::Face::Back] {
                    self.blended.push(item(MeshKey { cull: Some(cull), ..key }, false));
                }
            } else {
                self.blended.push(item(key, false));
            }
            // All panes share one shadow map.
            if depth_draws.shadow && pane.is_none_or(|pane| pane == 0) {
                self.shadow.push(item(shadow_key(key), false));
            }
        }
        if edges && is_surface {
            // After the background, which is drawn only where nothing has written depth.
            if !look.mesh {
                self.blended.push(item(occluder_key(key), false));
            }
            self.blended.push(item(wireframe, true));
        }
    }

    fn push_uniform(&mut self, uniform: &DrawUniform) -> u32 {
        let offset = self.uniforms.len();
        self.uniforms.extend_from_slice(bytemuck::bytes_of(uniform));
        self.uniforms.resize(offset + ALIGNMENT, 0);
        offset as u32
    }

    /// Uploads the draws' uniforms if they changed.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, layouts: &Layouts) {
        if self.uniforms == self.uploaded {
            return;
        }
        if self.uniforms.len() as u64 > self.buffer.size() {
            (self.buffer, self.bind_group) = create(device, layouts, self.uniforms.len().next_power_of_two());
        }
        queue.write_buffer(&self.buffer, 0, &self.uniforms);
        self.uploaded.clone_from(&self.uniforms);
    }
}

fn create(device: &wgpu::Device, layouts: &Layouts, size: usize) -> (wgpu::Buffer, wgpu::BindGroup) {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("draws"),
        size: size as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("draws"),
        layout: &layouts.draw,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &buffer,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<DrawUniform>() as u64),
            }),
        }],
    });
    (buffer, bind_group)
}
