//! Chooses what to draw of a frame's meshes, in which order and with which pipeline.

use super::model::{GpuModel, GpuPrimitive};
use super::palette::PaletteTexture;
use super::pipelines::{Features, Layouts, MeshKey, MeshPipeline, Pipelines, Shading};
use super::shaders::SurfaceVariant;
use super::uniforms::DrawUniform;
use crate::frame::{Character, Draw, Frame};
use crate::mesh::Topology;
use crate::state::{Background, ToneMap};

/// Stride of the draw uniforms: the alignment WebGPU and WebGL2 require of dynamic offsets.
const ALIGNMENT: usize = 256;
const WIREFRAME_OVER_MESH: [f32; 4] = [0.0, 0.0, 0.0, 0.2];
const WIREFRAME_ALONE: [f32; 4] = [0.15, 0.25, 0.38, 0.75];

/// One draw call.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    /// See [`Character::pane`].
    pub pane: Option<u32>,
    model: usize,
    mesh: usize,
    primitive: usize,
    variant: Option<usize>,
    pub pipeline: MeshPipeline,
    /// Byte offset of the draw's uniform in the dynamic buffer.
    pub offset: u32,
    /// How many copies to draw; each has a palette entry.
    pub copies: u32,
    /// Draws the edges instead of the triangles.
    pub edges: bool,
    /// Draws no colour.
    pub depth_only: bool,
    /// View depth, for sorting.
    distance: f32,
}

/// Draws that are sorted by distance; the instances of a blended mesh that exceed them share one draw.
const MAX_SORTED: usize = 1 << 14;

impl Item {
    pub fn primitive<'a>(&self, models: &'a [GpuModel]) -> Option<&'a GpuPrimitive> {
        let primitive = models.get(self.model)?.meshes.get(self.mesh)?.get(self.primitive)?.as_ref()?;
        // Edges have no material.
        Some(if self.edges { primitive } else { primitive.in_variant(self.variant) })
    }
}

/// What the primitives of one mesh instance, or of several copies of one, have in common.
struct Instance<'a> {
    frame: &'a Frame,
    character: &'a Character,
    draw: &'a Draw,
    /// The draw and its copies that follow.
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
        DrawUniform {
            palette: self.palette,
            morph_weights,
            morph_count: if geometry.morph_view.is_some() { morph_count } else { 0 },
            morph_attributes: geometry.morph_attributes,
            vertices: geometry.vertices,
            influence_stride: geometry.influence_stride,
            heat_joint: self.draw.heat_joint.unwrap_or(u32::MAX),
            padding: 0,
            color: if self.frame.look.mesh { WIREFRAME_OVER_MESH } else { WIREFRAME_ALONE },
        }
    }

    fn mesh_key(&self, primitive: &GpuPrimitive) -> MeshKey {
        let geometry = &primitive.geometry;
        let shading = if self.draw.heat_joint.is_some() { Shading::Heat } else { primitive.shading };
        let mut features = primitive.features.with(self.lighting, shading == Shading::Lit);
        if self.frame.look.smooth && geometry.topology == Topology::Triangles {
            features = features.without(Features::FLAT);
        }
        MeshKey {
            shading,
            surface: primitive.surface,
            influences: geometry.influences,
            skinning: self.character.skinning,
            topology: geometry.topology,
            features,
            cull: (!primitive.double_sided).then_some(wgpu::Face::Back),
            mirrored: self.draw.mirrored,
            // The other kinds of shading have no use for it.
            tone_map: if shading == Shading::Lit { self.frame.look.tone_map } else { ToneMap::default() },
            // In front of nothing, the alpha of the picture would be wrong.
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
    let tone_map = ToneMap::default();
    MeshKey { shading: Shading::Shadow, features, cull: None, mirrored: false, tone_map, coverage: false, ..key }
}

/// The key that draws the depth of a blended surface's opaque parts.
fn depth_key(key: MeshKey) -> MeshKey {
    let features = key.features.only(Features::BASE_COLOR_MAP.with(Features::VERTEX_COLORS, true));
    MeshKey { shading: Shading::Depth, features, tone_map: ToneMap::default(), ..key }
}

/// The key that draws an MToon surface's outline; `None` if it has none. Blended surfaces would show it through themselves,
/// and flat shading would tear it apart.
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
    MeshKey {
        shading: Shading::Wireframe,
        topology: Topology::Lines,
        features: Features::default(),
        cull: None,
        mirrored: false,
        tone_map: ToneMap::default(),
        coverage: false,
        ..key
    }
}

/// What a primitive draws besides colours.
#[derive(Clone, Copy)]
struct Depths {
    /// It casts a shadow.
    shadow: bool,
    /// It is blended and hides what is behind it in places.
    surface: bool,
}

/// Draw calls of a frame, reused between frames.
pub(super) struct DrawList {
    shadow: Vec<Item>,
    solid: Vec<Item>,
    transmissive: Vec<Item>,
    blended: Vec<Item>,
    shows_behind: bool,
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
            shows_behind: false,
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

    /// Back to front, so that a volume's front is in front of its back.
    pub fn transmissive(&self) -> &[Item] {
        &self.transmissive
    }

    /// Whether anything shows what is behind it through the picture of opaque surfaces.
    pub fn shows_behind(&self) -> bool {
        self.shows_behind
    }

    /// Back to front, then wireframes.
    pub fn blended(&self) -> &[Item] {
        &self.blended
    }

    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// Fills the lists and the palette. `shadow`: a shadow map is drawn.
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
        self.shows_behind = false;
        self.uniforms.clear();
        palette.clear();
        if !frame.look.mesh && !frame.look.wireframe {
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
                if frame.look.wireframe {
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

    /// Adds the items of a mesh and its copies. `instance` makes one of several of them.
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
            let whole = instance(copies);
            let shown = primitive.in_variant(whole.character.variant);
            let depths = Depths {
                shadow: whole.shadow && model.casts_shadow(shown),
                surface: shown.features.has(Features::BLEND) && model.has_opaque_parts(shown),
            };
            if shown.can_repeat() || self.blended.len() + copies.len() > MAX_SORTED {
                self.add(device, pipelines, &whole, index, primitive, depths);
                continue;
            }
            for draw in copies.chunks(1) {
                self.add(device, pipelines, &instance(draw), index, primitive, depths);
            }
        }
    }

    /// Adds the items of one primitive, in the character's variant.
    fn add(
        &mut self,
        device: &wgpu::Device,
        pipelines: &mut Pipelines,
        instance: &Instance<'_>,
        index: usize,
        primitive: &GpuPrimitive,
        depths: Depths,
    ) {
        let (look, pane) = (&instance.frame.look, instance.character.pane);
        let is_surface = primitive.geometry.topology == Topology::Triangles;
        let edges = wireframe_key(instance.mesh_key(primitive));
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
            depth_only: key.shading == Shading::Depth,
            distance: instance.distance,
        };
        if look.mesh {
            // Of a blended surface, only the nearest of its opaque layers shows, whatever the order of its triangles.
            if depths.surface {
                self.blended.push(item(depth_key(key), false));
            }
            let is_transmissive = key.shading == Shading::Lit && key.surface.has(SurfaceVariant::TRANSMISSION);
            self.shows_behind |= is_transmissive;
            if is_transmissive && !key.features.has(Features::BLEND) {
                self.transmissive.push(item(key, false));
            } else if !key.features.has(Features::BLEND) {
                self.solid.push(item(key, false));
                // Wireframes are for looking at the mesh itself.
                if let Some(key) = outline_key(primitive, key).filter(|_| !look.wireframe) {
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
            if depths.shadow && pane.is_none_or(|pane| pane == 0) {
                self.shadow.push(item(shadow_key(key), false));
            }
        }
        if look.wireframe && is_surface {
            self.blended.push(item(edges, true));
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
