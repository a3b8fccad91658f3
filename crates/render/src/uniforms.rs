//! Rust mirrors of the uniform structs in `shaders/`. A test compares names, offsets and sizes with the WGSL.

use bytemuck::{Pod, Zeroable};
use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::MAX_LIGHTS;

/// `Light` in frame.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct LightUniform {
    /// World space, metres.
    pub position: [f32; 3],
    /// Distance in metres at which the light ends; 0 for unlimited.
    pub range: f32,
    /// Linear colour times intensity: lux for a directional light, else candela.
    pub color: [f32; 3],
    /// 0 directional, 1 point, 2 spot.
    pub kind: u32,
    /// World-space unit vector in which the light travels.
    pub direction: [f32; 3],
    /// `lightAngleScale` of KHR_lights_punctual; 0 unless a spot light.
    pub spot_scale: f32,
    /// `lightAngleOffset` of KHR_lights_punctual; 0 unless a spot light.
    pub spot_offset: f32,
    /// Unused, zero.
    pub padding: [f32; 3],
}

/// `Frame` in frame.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct FrameUniform {
    /// The camera's view and projection; in the shadow pass, the light's.
    pub projection_from_world: [[f32; 4]; 4],
    /// World space to the clip space of the shadow map.
    pub shadow_from_world: [[f32; 4]; 4],
    /// The camera's position in world space.
    pub eye: [f32; 3],
    /// Factor on linear colours before tone mapping, above 0.
    pub exposure: f32,
    /// Width and height of a pane.
    pub viewport_pixels: [f32; 2],
    /// Number of used elements of `lights`.
    pub light_count: u32,
    /// Index of the environment's roughest level.
    pub environment_last_level: f32,
    /// Cosine and sine of the environment's rotation about Y.
    pub environment: [f32; 2],
    /// Size of a shadow-map texel in metres; 0 without a shadow.
    pub shadow_texel: f32,
    /// Index into `lights` of the light whose shadow falls on meshes; `u32::MAX` for none. 0 if the key light is used.
    pub shadow_light: u32,
    /// World-space unit vector towards the key light.
    pub key_direction: [f32; 3],
    /// Opacity of the shadow on the ground.
    pub ground_shadow: f32,
    /// Linear colour times intensity of the key light, which replaces missing file lights.
    pub key_color: [f32; 3],
    /// Distance in metres between thin grid lines; every tenth line is thick.
    pub grid_spacing: f32,
    /// World-space center of the ground; w is the radius in metres at which it has faded out, 0 for no ground.
    pub ground: [f32; 4],
    /// X and z in metres from the center of the ground to the center of the area that the shadow map covers.
    pub shadow_center: [f32; 2],
    /// X and z of half that area's edge along the shadow map's x axis. The area is a parallelogram.
    pub shadow_x: [f32; 2],
    /// X and z of half that area's edge along the shadow map's y axis.
    pub shadow_y: [f32; 2],
    /// Time within the clip.
    pub time_secs: f32,
    /// Unused, zero.
    pub padding: f32,
    /// sRGB colour of the studio background at its brightest point.
    pub background_center: [f32; 4],
    /// sRGB colour of the studio background at its edge.
    pub background_edge: [f32; 4],
    /// Direction at the center of a pane in the environment; w is unused.
    pub sky_ahead: [f32; 4],
    /// Added to it per unit of x in normalized device coordinates.
    pub sky_right: [f32; 4],
    /// Added to it per unit of y in normalized device coordinates.
    pub sky_up: [f32; 4],
    /// The file's lights; unused elements are zero.
    pub lights: [LightUniform; MAX_LIGHTS],
}

/// `Draw` in skinning.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct DrawUniform {
    /// First entry in the palette texture.
    pub palette: u32,
    /// First texel of the non-zero morph weights in the palette texture.
    pub morph_weights: u32,
    /// Number of non-zero morph weights.
    pub morph_count: u32,
    /// Texels per vertex and morph target: 1 position, 2 also normal, 3 also tangent.
    pub morph_attributes: u32,
    /// Number of vertices, the stride of the morph targets.
    pub vertices: u32,
    /// Influences per vertex, 0 if unskinned.
    pub influence_stride: u32,
    /// Joint of the heat map as an index into the draw's palette; `u32::MAX` for none.
    pub heat_joint: u32,
    /// The [`Channel`](gaitway_scene::state::Channel) that the surface shows, as a number.
    pub channel: u32,
    /// Wireframe colour, sRGB with straight alpha.
    pub color: [f32; 4],
}

/// `UvTransform` in surface.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct UvTransformUniform {
    /// Columns of the 2×2 matrix of rotation and scale.
    pub matrix: [f32; 4],
    /// Added after the matrix.
    pub offset: [f32; 2],
    /// Index of the texture coordinates, 0 or 1.
    pub uv_set: u32,
    /// Unused, zero.
    pub padding: u32,
}

/// `Material` in surface.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialUniform {
    /// Linear base colour factor and alpha.
    pub base_color: [f32; 4],
    /// Linear emissive factor times emissive strength.
    pub emissive: [f32; 3],
    /// Alpha below which masked fragments are discarded; 0.5 otherwise, for the shadows of blended surfaces.
    pub alpha_cutoff: f32,
    /// Metallic factor.
    pub metallic: f32,
    /// Roughness factor.
    pub roughness: f32,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// 0 ignores the occlusion map, 1 applies it fully.
    pub occlusion_strength: f32,
    /// Linear reflectance of the dielectric at normal incidence; may exceed 1.
    pub specular_color: [f32; 3],
    /// Weight of the dielectric reflection.
    pub specular: f32,
    /// Linear colour of the sheen.
    pub sheen_color: [f32; 3],
    /// Roughness of the sheen.
    pub sheen_roughness: f32,
    /// Absorption of the volume per metre.
    pub absorption: [f32; 3],
    /// Thickness of the volume in the mesh's units.
    pub thickness: f32,
    /// Linear colour of diffusely transmitted light.
    pub diffuse_transmission_color: [f32; 3],
    /// Fraction of diffusely transmitted light.
    pub diffuse_transmission: f32,
    /// Weight of the clearcoat.
    pub clearcoat: f32,
    /// Roughness of the clearcoat.
    pub clearcoat_roughness: f32,
    /// Scale of X and Y of the clearcoat normal map.
    pub clearcoat_normal_scale: f32,
    /// Index of refraction.
    pub ior: f32,
    /// Weight of the thin film.
    pub iridescence: f32,
    /// Index of refraction of the thin film.
    pub iridescence_ior: f32,
    /// Minimum and maximum thickness of the thin film in nanometres.
    pub iridescence_thickness: [f32; 2],
    /// Cosine and sine of the angle from the tangent to the direction of anisotropy.
    pub anisotropy_direction: [f32; 2],
    /// Strength of the anisotropy.
    pub anisotropy: f32,
    /// Transmitted fraction of light.
    pub transmission: f32,
    /// 20 divided by the Abbe number.
    pub dispersion: f32,
    /// Added to MToon's cosine between normal and light.
    pub shading_shift: f32,
    /// Factor on the shading shift map.
    pub shading_shift_scale: f32,
    /// Sharpness of the boundary between MToon's lit and shade colour.
    pub shading_toony: f32,
    /// Linear colour where the surface is unlit.
    pub shade_color: [f32; 3],
    /// How far ambient light is averaged over all normals.
    pub gi_equalization: f32,
    /// Linear factor on the matcap.
    pub matcap_color: [f32; 3],
    /// How much rim and matcap depend on the light.
    pub rim_lighting_mix: f32,
    /// Linear colour of the rim.
    pub rim_color: [f32; 3],
    /// Exponent of the rim, above 0.
    pub rim_fresnel_power: f32,
    /// Linear colour of the outline.
    pub outline_color: [f32; 3],
    /// How much of the surface's shading the outline takes on.
    pub outline_lighting_mix: f32,
    /// Widens the rim.
    pub rim_lift: f32,
    /// Metres, or a fraction of the viewport's height.
    pub outline_width: f32,
    /// 1 if the outline's width is a fraction of the viewport's height, otherwise 0.
    pub outline_on_screen: u32,
    /// Speed at which texture coordinates turn, in radians per second.
    pub uv_rotation: f32,
    /// Speed at which texture coordinates move, in UV units per second.
    pub uv_scroll: [f32; 2],
    /// Unused, zero.
    pub padding: [f32; 2],
    /// Transforms of the maps, in the order of [`TextureSlot::ALL`].
    pub uvs: [UvTransformUniform; TextureSlot::ALL.len()],
}
