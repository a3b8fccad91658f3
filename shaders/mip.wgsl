// Downsamples a mip level, or a whole image to a thumbnail. The hardware decodes sRGB, so averages are linear.

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

// Encodes colours again, since the target holds display values.
override ENCODE: bool = false;

@fragment
fn thumbnail(in: MipOut) -> @location(0) vec4f {
    let color = textureSample(above, above_sampler, in.uv).rgb;
    if ENCODE {
        let high = 1.055 * pow(color, vec3f(1.0 / 2.4)) - 0.055;
        return vec4f(select(high, 12.92 * color, color <= vec3f(0.0031308)), 1.0);
    }
    return vec4f(color, 1.0);
}
