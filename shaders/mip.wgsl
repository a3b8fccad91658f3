// Downsamples a mip level. The hardware decodes sRGB, so averages are linear.

@group(0) @binding(0) var above: texture_2d<f32>;
@group(0) @binding(1) var above_sampler: sampler;

struct MipOut {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn full_screen(@builtin(vertex_index) vertex: u32) -> MipOut {
    let at = vec2f(f32(vertex & 1u), f32(vertex >> 1u));
    return MipOut(vec4f(at * 4.0 - 1.0, 0.0, 1.0), vec2f(2.0 * at.x, 1.0 - 2.0 * at.y));
}

@fragment
fn halve(in: MipOut) -> @location(0) vec4f {
    return textureSample(above, above_sampler, in.uv);
}
