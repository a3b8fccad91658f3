// Copies the finished picture to the screen, pixel for pixel.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;

// Whether the target format encodes sRGB on write; the picture is already encoded, so it is decoded first.
override ENCODING_TARGET: bool = false;

struct BlitOut {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn full_viewport(@builtin(vertex_index) vertex: u32) -> BlitOut {
    let at = vec2f(f32(vertex & 1u), f32(vertex >> 1u));
    return BlitOut(vec4f(at * 4.0 - 1.0, 0.0, 1.0), vec2f(2.0 * at.x, 1.0 - 2.0 * at.y));
}

@fragment
fn blit(in: BlitOut) -> @location(0) vec4f {
    let color = textureSampleLevel(picture, picture_sampler, in.uv, 0.0);
    if ENCODING_TARGET {
        let linear = select(pow((color.rgb + 0.055) / 1.055, vec3f(2.4)), color.rgb / 12.92, color.rgb <= vec3f(0.04045));
        return vec4f(linear, color.a);
    }
    return color;
}
