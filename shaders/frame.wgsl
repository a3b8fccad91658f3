// Uniforms of a frame. Mirrored by crates/render/src/uniforms.rs; a test compares the layouts.

const MAX_LIGHTS: u32 = 8u;

struct Light {
    position: vec3f,
    // 0: unlimited.
    range: f32,
    color: vec3f,
    // 0 directional, 1 point, 2 spot.
    kind: u32,
    // Direction in which the light travels.
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
    // Index of the roughest level of the environment.
    environment_last_level: f32,
    // Cosine and sine of the environment's rotation about Y.
    environment: vec2f,
    // Size of a shadow-map texel in metres.
    shadow_texel: f32,
    // Index into `lights` of the light that casts the shadow; 0xffffffff for none.
    shadow_light: u32,
    // Direction to the key light.
    key_direction: vec3f,
    // Opacity of the shadow on the ground.
    ground_shadow: f32,
    key_color: vec3f,
    grid_spacing: f32,
    // Center on the ground plane; w is the radius at which the grid has faded out (0: no ground).
    ground: vec4f,
    // The shadow map covers a parallelogram of the ground plane: x and z of its center, relative to the ground's, and
    // of half its two edges.
    shadow_center: vec2f,
    shadow_x: vec2f,
    shadow_y: vec2f,
    time_secs: f32,
    padding: f32,
    // sRGB.
    background_center: vec4f,
    background_edge: vec4f,
    // The direction of a pixel in the environment: at the center, and what x and y in normalized device coordinates
    // add.
    sky_ahead: vec4f,
    sky_right: vec4f,
    sky_up: vec4f,
    lights: array<Light, 8>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
