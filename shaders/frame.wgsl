// What is the same for all of a picture. Mirrored by src/render/uniforms.rs; a test compares the layouts.

const MAX_LIGHTS: u32 = 8u;

struct Light {
    position: vec3f,
    // 0: unlimited.
    range: f32,
    color: vec3f,
    // 0 directional, 1 point, 2 spot.
    kind: u32,
    // The way the light travels.
    direction: vec3f,
    spot_scale: f32,
    spot_offset: f32,
}

struct Frame {
    projection_from_world: mat4x4f,
    shadow_from_world: mat4x4f,
    eye: vec3f,
    exposure: f32,
    viewport_pixels: vec2f,
    light_count: u32,
    padding: u32,
    // Cosine and sine of the environment's turn about Y.
    environment: vec2f,
    // Edge of a texel of the shadow map, in metres.
    shadow_texel: f32,
    // Index into `lights` of the light that casts the shadow; 0xffffffff: none of them.
    shadow_light: u32,
    // Towards the key light.
    key_direction: vec3f,
    // 0 to 1, on the ground.
    ground_shadow: f32,
    key_color: vec3f,
    grid_spacing: f32,
    // Centre on the ground plane, w: where the grid has faded out (0: no grid).
    ground: vec4f,
    // What the shadow map sees of the ground plane is a parallelogram: its middle, from the middle of the ground, and half
    // of its two edges. x and z.
    shadow_center: vec2f,
    shadow_x: vec2f,
    shadow_y: vec2f,
    padding_2: vec2f,
    // sRGB.
    background_center: vec4f,
    background_edge: vec4f,
    irradiance: array<vec4f, 9>,
    lights: array<Light, 8>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
