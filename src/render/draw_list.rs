//! What of a frame's meshes is drawn, in which order and with which pipeline.

use super::model::{GpuModel, GpuPrimitive};
use super::palette::PaletteTexture;
use super::pipelines::{Features, Layouts, MeshKey, MeshPipeline, Pipelines, Shading};
use super::uniforms::DrawUniform;
use crate::frame::Frame;
use crate::mesh::Topology;

/// Distance of draw uniforms: what WebGPU and WebGL2 ask of dynamic offsets.
const ALIGNMENT: usize = 256;
const WIREFRAME_OVER_MESH: [f32; 4] = [0.0, 0.0, 0.0, 0.2];
const WIREFRAME_ALONE: [f32; 4] = [0.15, 0.25, 0.38, 0.75];

/// One draw call.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    /// As [`crate::frame::Character::pane`].
    pub pane: Option<u32>,
    model: usize,
    mesh: usize,
    primitive: usize,
    pub pipeline: MeshPipeline,
    /// Of the draw's uniform.
    pub offset: u32,
    /// Edges are drawn instead of triangles.
    pub edges: bool,
    /// Along the view, for sorting.
    distance: f32,
}

impl Item {
    pub fn primitive<'a>(&self, models: &'a [GpuModel]) -> Option<&'a GpuPrimitive> {
        models.get(self.model)?.meshes.get(self.mesh)?.get(self.primitive)?.as_ref()
    }
}

/// Reused from frame to frame.
pub(super) struct DrawList {
    shadow: Vec<Item>,
    solid: Vec<Item>,
    blended: Vec<Item>,
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
            blended: Vec::new(),
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

    /// Back to front, then wireframes.
    pub fn blended(&self) -> &[Item] {
        &self.blended
    }

    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// Fills the lists and the palette. `shadow`: a shadow map is drawn.
    pub fn collect(
        &mut self,
        device: &wgpu::Device,
        frame: &Frame,
        models: &mut [GpuModel],
        pipelines: &mut Pipelines,
        palette: &mut PaletteTexture,
        shadow: bool,
    ) {
        self.shadow.clear();
        self.solid.clear();
        self.blended.clear();
        self.uniforms.clear();
        palette.clear();
        if !frame.look.mesh && !frame.look.wireframe {
            return;
        }
        let mut next_palette = 0;
        for character in &frame.characters {
            palette.push_palette(&character.palette);
        }
        let light_features =
            Features::default().with(Features::SHADOW, shadow).with(Features::FILE_LIGHTS, !frame.lights.is_empty());
        for character in &frame.characters {
            let first_palette = next_palette;
            next_palette += character.palette.len() as u32;
            let Some(model_index) = models.iter().position(|model| model.id == character.model) else { continue };
            for draw in &character.draws {
                let weights = draw.morph_weights.start as usize..draw.morph_weights.end as usize;
                let weights = character.morph_weights.get(weights).unwrap_or_default();
                let (morph_weights, morph_count) = palette.push_morph_weights(weights);
                let center = frame.view.view_from_world.transform_point3(draw.center);
                let primitives = models[model_index].meshes.get(draw.mesh).map_or(0, Vec::len);
                for primitive_index in 0..primitives {
                    if frame.look.wireframe {
                        models[model_index].prepare_edges(device, draw.mesh, primitive_index);
                    }
                    let Some(primitive) = &models[model_index].meshes[draw.mesh][primitive_index] else { continue };
                    let geometry = &primitive.geometry;
                    let uniform = DrawUniform {
                        palette: first_palette + draw.palette.start,
                        morph_weights,
                        morph_count: if geometry.morph_view.is_some() { morph_count } else { 0 },
                        morph_attributes: geometry.morph_attributes,
                        vertices: geometry.vertices,
                        influence_stride: geometry.influence_stride,
                        heat_joint: draw.heat_joint.unwrap_or(u32::MAX),
                        padding: 0,
                        color: if frame.look.mesh { WIREFRAME_OVER_MESH } else { WIREFRAME_ALONE },
                    };
                    let offset = self.push_uniform(&uniform);
                    let heat = draw.heat_joint.is_some();
                    let shading = if heat { Shading::Heat } else { primitive.shading };
                    let mut features = primitive.features.with(light_features, shading == Shading::Lit);
                    if frame.look.smooth && geometry.topology == Topology::Triangles {
                        features = features.without(Features::FLAT);
                    }
                    let key = MeshKey {
                        shading,
                        influences: geometry.influences,
                        skinning: character.skinning,
                        topology: geometry.topology,
                        features,
                        cull: (!primitive.double_sided).then_some(wgpu::Face::Back),
                        mirrored: draw.mirrored,
                    };
                    let mut item = |key: MeshKey, offset, edges| Item {
                        pane: character.pane,
                        model: model_index,
                        mesh: draw.mesh,
                        primitive: primitive_index,
                        pipeline: pipelines.mesh(device, key),
                        offset,
                        edges,
                        distance: -center.z,
                    };
                    if frame.look.mesh {
                        if !features.has(Features::BLEND) {
                            self.solid.push(item(key, offset, false));
                        } else if primitive.double_sided && geometry.topology == Topology::Triangles {
                            // The far side first, or it would be painted over the near one.
                            for cull in [wgpu::Face::Front, wgpu::Face::Back] {
                                self.blended.push(item(MeshKey { cull: Some(cull), ..key }, offset, false));
                            }
                        } else {
                            self.blended.push(item(key, offset, false));
                        }
                        // One shadow map serves all panes.
                        if shadow && primitive.casts_shadow && character.pane.is_none_or(|pane| pane == 0) {
                            let holes = features.has(Features::MASK) || features.has(Features::BLEND);
                            let kept = Features::BASE_COLOR_MAP.with(Features::VERTEX_COLORS, true);
                            let features = if holes {
                                features.only(kept).with(Features::MASK, true)
                            } else {
                                Features::default()
                            };
                            let key =
                                MeshKey { shading: Shading::Shadow, features, cull: None, mirrored: false, ..key };
                            self.shadow.push(item(key, offset, false));
                        }
                    }
                    if frame.look.wireframe && geometry.topology == Topology::Triangles {
                        let key = MeshKey {
                            shading: Shading::Wireframe,
                            topology: Topology::Lines,
                            features: Features::default(),
                            cull: None,
                            mirrored: false,
                            ..key
                        };
                        self.blended.push(item(key, offset, true));
                    }
                }
            }
        }
        self.solid.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.offset.cmp(&b.offset)));
        // Stable: parts of one mesh keep the file's order.
        self.blended.sort_by(|a, b| a.edges.cmp(&b.edges).then(b.distance.total_cmp(&a.distance)));
    }

    fn push_uniform(&mut self, uniform: &DrawUniform) -> u32 {
        let offset = self.uniforms.len();
        self.uniforms.extend_from_slice(bytemuck::bytes_of(uniform));
        self.uniforms.resize(offset + ALIGNMENT, 0);
        offset as u32
    }

    /// Brings the draws' uniforms to the GPU when they changed.
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
