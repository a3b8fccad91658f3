//! Rust mirrors of the uniform structs in `shaders/`. A test compares names, offsets and sizes with the WGSL.

use bytemuck::{Pod, Zeroable};

/// Lights of a file beyond this number are ignored.
pub const MAX_LIGHTS: usize = 8;

/// `Light` in frame.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct LightUniform {
    pub position: [f32; 3],
    pub range: f32,
    pub color: [f32; 3],
    pub kind: u32,
    pub direction: [f32; 3],
    pub spot_scale: f32,
    pub spot_offset: f32,
    pub padding: [f32; 3],
}

/// `Frame` in frame.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct FrameUniform {
    pub projection_from_world: [[f32; 4]; 4],
    pub shadow_from_world: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub exposure: f32,
    pub viewport_pixels: [f32; 2],
    pub light_count: u32,
    pub padding: u32,
    pub environment: [f32; 2],
    pub shadow_texel: f32,
    pub shadow_light: u32,
    pub key_direction: [f32; 3],
    pub ground_shadow: f32,
    pub key_color: [f32; 3],
    pub grid_spacing: f32,
    pub ground: [f32; 4],
    pub shadow_center: [f32; 2],
    pub shadow_x: [f32; 2],
    pub shadow_y: [f32; 2],
    pub padding_2: [f32; 2],
    pub background_center: [f32; 4],
    pub background_edge: [f32; 4],
    pub irradiance: [[f32; 4]; 9],
    pub lights: [LightUniform; MAX_LIGHTS],
}

/// `Draw` in skinning.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct DrawUniform {
    pub palette: u32,
    pub morph_weights: u32,
    pub morph_count: u32,
    pub morph_attributes: u32,
    pub vertices: u32,
    pub influence_stride: u32,
    pub heat_joint: u32,
    pub padding: u32,
    pub color: [f32; 4],
}

/// `UvTransform` in surface.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct UvTransformUniform {
    pub matrix: [f32; 4],
    pub offset: [f32; 2],
    pub uv_set: u32,
    pub padding: u32,
}

/// `Material` in surface.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialUniform {
    pub base_color: [f32; 4],
    pub emissive: [f32; 3],
    pub alpha_cutoff: f32,
    pub metallic: f32,
    pub roughness: f32,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub uvs: [UvTransformUniform; 5],
}
