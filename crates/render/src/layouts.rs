//! Bind group layouts, and the pipeline layouts that they make.

use super::shaders::SurfacePermutation;
use super::uniforms::{DrawUniform, FrameUniform, MaterialUniform};

/// Bind group layouts in the order of their group numbers. No pipeline skips a number: software Vulkan drops the groups
/// after a gap.
pub(super) struct Layouts {
    /// Group 0: frame, palette.
    pub frame: wgpu::BindGroupLayout,
    /// Group 1 of meshes and ground: environment, shadow map, reflectance table, transmission buffer.
    pub light: wgpu::BindGroupLayout,
    /// Group 1 of the environment as a background: environment, panorama.
    pub sky: wgpu::BindGroupLayout,
    /// Group 2 of meshes: draw, with a dynamic offset.
    pub draw: wgpu::BindGroupLayout,
}

fn texture_binding(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

fn uniform_binding(size: usize, has_dynamic_offset: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset,
        min_binding_size: wgpu::BufferSize::new(size as u64),
    }
}

fn entry(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

const FILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: true };
const UNFILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };

/// Creates the layout of group 3 of meshes: material, its maps, morph deltas, influences. Layouts with the same maps
/// are interchangeable.
pub(super) fn primitive_layout(device: &wgpu::Device, permutation: SurfacePermutation) -> wgpu::BindGroupLayout {
    use wgpu::{ShaderStages as Stages, TextureViewDimension as Dimension};
    let mut entries = vec![entry(0, Stages::VERTEX_FRAGMENT, uniform_binding(size_of::<MaterialUniform>(), false))];
    for map in permutation.maps() {
        let binding = SurfacePermutation::binding(map);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let stage = if SurfacePermutation::is_vertex_map(map) { Stages::VERTEX } else { Stages::FRAGMENT };
        entries.push(entry(binding, stage, texture_binding(FILTERED, Dimension::D2)));
        entries.push(entry(binding + 1, stage, sampler));
    }
    entries.extend([11, 12].map(|binding| entry(binding, Stages::VERTEX, texture_binding(UNFILTERED, Dimension::D2))));
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("primitive"), entries: &entries })
}

impl Layouts {
    pub fn new(device: &wgpu::Device) -> Self {
        use wgpu::{ShaderStages as Stages, TextureViewDimension as Dimension};
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let filter = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        Self {
            frame: layout(
                "frame",
                &[
                    entry(0, Stages::VERTEX_FRAGMENT, uniform_binding(size_of::<FrameUniform>(), false)),
                    entry(1, Stages::VERTEX, texture_binding(UNFILTERED, Dimension::D2)),
                ],
            ),
            draw: layout("draw", &[entry(0, Stages::VERTEX_FRAGMENT, uniform_binding(size_of::<DrawUniform>(), true))]),
            sky: layout(
                "sky",
                &[
                    entry(0, Stages::FRAGMENT, texture_binding(FILTERED, Dimension::Cube)),
                    entry(1, Stages::FRAGMENT, filter),
                    entry(2, Stages::FRAGMENT, texture_binding(FILTERED, Dimension::D2)),
                ],
            ),
            light: layout(
                "light",
                &[
                    entry(0, Stages::FRAGMENT, texture_binding(FILTERED, Dimension::Cube)),
                    entry(1, Stages::FRAGMENT, filter),
                    entry(2, Stages::FRAGMENT, texture_binding(wgpu::TextureSampleType::Depth, Dimension::D2)),
                    entry(3, Stages::FRAGMENT, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison)),
                    entry(4, Stages::FRAGMENT, texture_binding(FILTERED, Dimension::D2)),
                    entry(5, Stages::FRAGMENT, texture_binding(FILTERED, Dimension::Cube)),
                    entry(6, Stages::FRAGMENT, texture_binding(FILTERED, Dimension::D2)),
                ],
            ),
        }
    }
}

pub(super) fn pipeline_layout(
    device: &wgpu::Device,
    label: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::PipelineLayout {
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: groups,
        immediate_size: 0,
    })
}
