//! Pipelines, created on first use.

use std::collections::HashMap;

use gaitway_character::mesh::{SkinningMode, Topology};
use gaitway_scene::state::{Background, ToneMap};

use super::flush;
use super::geometry::{InfluenceSource, vertex_buffers};
use super::layouts::{Layouts, pipeline_layout, primitive_layout};
use super::shaders::{self, Shader, SurfacePermutation};
use super::shadow::SHADOW_FORMAT;
use super::targets::{DEPTH_FORMAT, SCENE_FORMAT};

/// How a mesh is shaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Shading {
    Lit,
    Unlit,
    Heat,
    /// A single input of shading.
    Channel,
    Wireframe,
    /// Depth only: hides the edges behind the surface.
    Occluder,
    /// Depth only: the opaque parts of a blended surface.
    Depth,
    /// Depth only, into the shadow map.
    Shadow,
}

/// Features of surface.wgsl that a primitive needs, as bits named by [`OVERRIDES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(super) struct Features(pub u16);

impl Features {
    pub const BASE_COLOR_MAP: Self = Self(1);
    pub const METALLIC_ROUGHNESS_MAP: Self = Self(1 << 1);
    pub const NORMAL_MAP: Self = Self(1 << 2);
    pub const OCCLUSION_MAP: Self = Self(1 << 3);
    pub const EMISSIVE_MAP: Self = Self(1 << 4);
    pub const VERTEX_COLORS: Self = Self(1 << 5);
    pub const FLAT: Self = Self(1 << 6);
    pub const TANGENTS: Self = Self(1 << 7);
    pub const MASK: Self = Self(1 << 8);
    pub const BLEND: Self = Self(1 << 9);
    pub const SHADOW: Self = Self(1 << 10);
    pub const FILE_LIGHTS: Self = Self(1 << 11);
    pub const OUTLINE: Self = Self(1 << 12);
    /// Only for channels.
    pub const UVS: Self = Self(1 << 13);

    pub fn with(self, other: Self, wanted: bool) -> Self {
        if wanted { Self(self.0 | other.0) } else { self }
    }

    pub fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    pub fn only(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

const OVERRIDES: [&str; 13] = [
    "BASE_COLOR_MAP",
    "METALLIC_ROUGHNESS_MAP",
    "NORMAL_MAP",
    "OCCLUSION_MAP",
    "EMISSIVE_MAP",
    "VERTEX_COLORS",
    "FLAT",
    "TANGENTS",
    "MASK",
    "BLEND",
    "SHADOW",
    "FILE_LIGHTS",
    "OUTLINE",
];

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct MeshKey {
    pub shading: Shading,
    pub permutation: SurfacePermutation,
    pub influences: InfluenceSource,
    pub skinning: SkinningMode,
    pub topology: Topology,
    pub features: Features,
    pub cull: Option<wgpu::Face>,
    pub mirrored: bool,
    pub tone_map: ToneMap,
    /// Alpha to coverage: masks cut out individual samples of a pixel.
    pub coverage: bool,
}

/// Index of the pipeline for a [`MeshKey`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct MeshPipeline(usize);

pub(super) struct Pipelines {
    queue: wgpu::Queue,
    samples: u32,
    /// Shader module and layout of meshes.
    modules: HashMap<SurfacePermutation, (wgpu::ShaderModule, wgpu::PipelineLayout)>,
    /// Layouts of groups 0 to 2 of meshes.
    mesh_groups: [wgpu::BindGroupLayout; 3],
    by_key: HashMap<MeshKey, MeshPipeline>,
    meshes: Vec<wgpu::RenderPipeline>,
    /// Created for the first picture.
    pub ground: Option<GroundPipelines>,
    /// Draws the studio's background. Created for the first picture, too.
    pub backdrop: Option<wgpu::RenderPipeline>,
    /// Sharp and blurred, with the tone mapping they were made for.
    sky: Option<(ToneMap, [wgpu::RenderPipeline; 2])>,
}

pub(super) struct GroundPipelines {
    pub grid: wgpu::RenderPipeline,
    pub shadow: wgpu::RenderPipeline,
}

const BLENDED: Option<wgpu::BlendState> = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);

/// Masked surfaces output coverage as alpha, which must not replace the alpha of the background.
const COVERED: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent::REPLACE,
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

/// A pipeline that draws into the scene with one of the simple shaders.
pub(super) struct ScenePipeline<'a> {
    pub label: &'a str,
    pub module: &'a wgpu::ShaderModule,
    pub layout: &'a wgpu::PipelineLayout,
    pub vertex: &'a str,
    pub fragment: &'a str,
    pub constants: &'a [(&'a str, f64)],
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub depth_write: bool,
    pub depth_compare: wgpu::CompareFunction,
    pub writes: wgpu::ColorWrites,
    pub blend: Option<wgpu::BlendState>,
    pub cull: Option<wgpu::Face>,
}

impl<'a> ScenePipeline<'a> {
    /// Depth-tested and alpha-blended by default. The last argument names the vertex and fragment entry points.
    pub fn new(
        label: &'a str,
        module: &'a wgpu::ShaderModule,
        layout: &'a wgpu::PipelineLayout,
        [vertex, fragment]: [&'a str; 2],
    ) -> Self {
        Self {
            label,
            module,
            layout,
            vertex,
            fragment,
            constants: &[],
            buffers: &[],
            depth_write: false,
            depth_compare: wgpu::CompareFunction::LessEqual,
            writes: wgpu::ColorWrites::ALL,
            blend: BLENDED,
            cull: None,
        }
    }

    pub fn create(&self, device: &wgpu::Device, samples: u32) -> wgpu::RenderPipeline {
        let options =
            || wgpu::PipelineCompilationOptions { constants: self.constants, zero_initialize_workgroup_memory: false };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: options(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState { cull_mode: self.cull, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(self.depth_write),
                depth_compare: Some(self.depth_compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(self.fragment),
                compilation_options: options(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: SCENE_FORMAT,
                    blend: self.blend,
                    write_mask: self.writes,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Pipelines {
    pub fn new(queue: &wgpu::Queue, layouts: &Layouts, samples: u32) -> Self {
        Self {
            queue: queue.clone(),
            samples,
            modules: HashMap::new(),
            mesh_groups: [&layouts.frame, &layouts.light, &layouts.draw].map(Clone::clone),
            by_key: HashMap::new(),
            meshes: Vec::new(),
            ground: None,
            backdrop: None,
            sky: None,
        }
    }

    /// Creates what draws grid and shadow on the ground, unless it exists.
    pub fn prepare_ground(&mut self, device: &wgpu::Device, layouts: &Layouts) {
        if self.ground.is_some() {
            return;
        }
        let samples = self.samples;
        let module = shaders::GROUND_PLANE.module(device);
        let layout = pipeline_layout(device, "ground", &[Some(&layouts.frame), Some(&layouts.light)]);
        let taps = [("SHADOW_TAPS", if samples > 1 { 16.0 } else { 4.0 })];
        let create = |label, vertex, fragment| {
            ScenePipeline { constants: &taps, ..ScenePipeline::new(label, &module, &layout, [vertex, fragment]) }
                .create(device, samples)
        };
        let grid = create("grid", "grid_vertex", "grid_fragment");
        let shadow = create("ground shadow", "shadow_vertex", "shadow_fragment");
        self.ground = Some(GroundPipelines { grid, shadow });
        flush(&self.queue);
    }

    /// Creates what draws the studio's background, unless it exists.
    pub fn prepare_backdrop(&mut self, device: &wgpu::Device, layouts: &Layouts) {
        if self.backdrop.is_some() {
            return;
        }
        let module = shaders::BACKDROP.module(device);
        let layout = pipeline_layout(device, "frame only", &[Some(&layouts.frame)]);
        // Drawn behind everything, so only visible pixels are shaded.
        let pipeline = ScenePipeline {
            blend: None,
            ..ScenePipeline::new("background", &module, &layout, ["full_screen", "backdrop"])
        };
        self.backdrop = Some(pipeline.create(device, self.samples));
        flush(&self.queue);
    }

    fn prepare_module(&mut self, device: &wgpu::Device, permutation: SurfacePermutation) {
        let groups = &self.mesh_groups;
        self.modules.entry(permutation).or_insert_with(|| {
            let primitive = primitive_layout(device, permutation);
            let [frame, light, draw] = groups.each_ref().map(Some);
            let layout = pipeline_layout(device, "mesh", &[frame, light, draw, Some(&primitive)]);
            (Shader::mesh(permutation).module(device), layout)
        });
    }

    /// Creates the pipelines that draw the environment as a background, unless they exist.
    pub fn prepare_sky(&mut self, device: &wgpu::Device, layouts: &Layouts, tone_map: ToneMap) {
        if self.sky.as_ref().is_some_and(|(made_for, _)| *made_for == tone_map) {
            return;
        }
        let module = shaders::SKY.module(device);
        let layout = pipeline_layout(device, "sky", &[Some(&layouts.frame), Some(&layouts.sky)]);
        let constants = [tone_constant(tone_map)];
        let pipelines = ["sky_sharp", "sky_blurred"].map(|fragment| {
            ScenePipeline {
                blend: None,
                constants: &constants,
                ..ScenePipeline::new("sky", &module, &layout, ["sky_vertex", fragment])
            }
            .create(device, self.samples)
        });
        self.sky = Some((tone_map, pipelines));
    }

    /// The pipeline of a background that shows the environment; `None` for others, and before [`Self::prepare_sky`].
    pub fn sky(&self, background: Background) -> Option<&wgpu::RenderPipeline> {
        let (_, [sharp, blurred]) = self.sky.as_ref()?;
        match background {
            Background::Environment => Some(sharp),
            Background::Blurred => Some(blurred),
            Background::Studio | Background::Color(_) | Background::Transparent => None,
        }
    }

    pub fn mesh(&mut self, device: &wgpu::Device, key: MeshKey) -> MeshPipeline {
        if let Some(&pipeline) = self.by_key.get(&key) {
            return pipeline;
        }
        self.prepare_module(device, key.permutation);
        let pipeline = MeshPipeline(self.meshes.len());
        self.meshes.push(self.create_mesh(device, key));
        self.by_key.insert(key, pipeline);
        flush(&self.queue);
        pipeline
    }

    pub fn is_multisampled(&self) -> bool {
        self.samples > 1
    }

    pub fn get(&self, pipeline: MeshPipeline) -> &wgpu::RenderPipeline {
        &self.meshes[pipeline.0]
    }

    fn create_mesh(&self, device: &wgpu::Device, key: MeshKey) -> wgpu::RenderPipeline {
        let shadow = key.shading == Shading::Shadow;
        let blended = key.shading == Shading::Wireframe || key.features.has(Features::BLEND);
        let constants = mesh_constants(key);
        let (module, layout) = &self.modules[&key.permutation];
        let options =
            || wgpu::PipelineCompilationOptions { constants: &constants, zero_initialize_workgroup_memory: false };
        let fragment = fragment_entry_point(key);
        let color = [Some(wgpu::ColorTargetState {
            format: SCENE_FORMAT,
            blend: match (blended, key.coverage) {
                (true, _) => BLENDED,
                (false, true) => Some(COVERED),
                (false, false) => None,
            },
            write_mask: match key.shading {
                Shading::Depth | Shading::Occluder => wgpu::ColorWrites::empty(),
                _ => wgpu::ColorWrites::ALL,
            },
        })];
        let bias = wgpu::DepthBiasState { constant: 2, slope_scale: 2.0, clamp: 0.0 };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("mesh"),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(key.influences.entry_point(shadow && fragment.is_none())),
                compilation_options: options(),
                buffers: &vertex_buffers(key.influences),
            },
            primitive: wgpu::PrimitiveState {
                topology: match key.topology {
                    Topology::Points => wgpu::PrimitiveTopology::PointList,
                    Topology::Lines => wgpu::PrimitiveTopology::LineList,
                    Topology::Triangles => wgpu::PrimitiveTopology::TriangleList,
                },
                front_face: if key.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
                cull_mode: key.cull,
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: if shadow { SHADOW_FORMAT } else { DEPTH_FORMAT },
                depth_write_enabled: Some(!blended),
                depth_compare: Some(wgpu::CompareFunction::LessEqual),
                stencil: Default::default(),
                bias: if shadow && key.topology == Topology::Triangles { bias } else { Default::default() },
            }),
            multisample: wgpu::MultisampleState {
                count: if shadow { 1 } else { self.samples },
                alpha_to_coverage_enabled: key.coverage,
                ..Default::default()
            },
            fragment: fragment.map(|entry_point| wgpu::FragmentState {
                module,
                entry_point: Some(entry_point),
                compilation_options: options(),
                targets: if shadow { &[] } else { &color },
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Values of the shader's overrides.
fn mesh_constants(key: MeshKey) -> Vec<(&'static str, f64)> {
    let mut constants: Vec<(&str, f64)> =
        OVERRIDES.iter().enumerate().map(|(bit, name)| (*name, f64::from(key.features.0 >> bit & 1))).collect();
    if key.shading == Shading::Channel {
        constants.push(("UVS", f64::from(u8::from(key.features.has(Features::UVS)))));
    }
    let skinning = match key.skinning {
        SkinningMode::Linear => 0.0,
        SkinningMode::Rigid => 1.0,
        SkinningMode::DualQuaternion => 2.0,
    };
    constants.push(("SKINNING", skinning));
    constants.push(tone_constant(key.tone_map));
    constants.push(("COVERAGE", f64::from(u8::from(key.coverage))));
    let depth_offset = match key.shading {
        Shading::Wireframe => 3e-5,
        // Behind the surface, also where the outline's width is 0.
        _ if key.features.has(Features::OUTLINE) => -1e-6,
        _ => 0.0,
    };
    constants.push(("DEPTH_OFFSET", depth_offset));
    constants
}

fn tone_constant(tone_map: ToneMap) -> (&'static str, f64) {
    let number = match tone_map {
        ToneMap::Neutral => 0.0,
        ToneMap::Aces => 1.0,
        ToneMap::Agx => 2.0,
        ToneMap::None => 3.0,
    };
    ("TONE_MAP", number)
}

fn fragment_entry_point(key: MeshKey) -> Option<&'static str> {
    match key.shading {
        Shading::Lit => Some("lit"),
        Shading::Unlit => Some("unlit"),
        Shading::Heat => Some("heat"),
        Shading::Channel => Some("channel"),
        Shading::Wireframe | Shading::Occluder => Some("wireframe"),
        Shading::Depth => Some("depth_mask"),
        Shading::Shadow => key.features.has(Features::MASK).then_some("shadow_mask"),
    }
}
