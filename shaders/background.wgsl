// The studio backdrop: a soft gradient, already encoded as sRGB.

struct BackdropOut {
    @builtin(position) position: vec4f,
    // From the brightest point.
    @location(0) offset: vec2f,
}

@vertex
fn full_screen(@builtin(vertex_index) vertex: u32) -> BackdropOut {
    let at = vec2f(f32(vertex & 1u), f32(vertex >> 1u));
    let offset = (vec2f(2.0 * at.x, 1.0 - 2.0 * at.y) - vec2f(0.5, 0.45)) * vec2f(1.1, 1.25);
    return BackdropOut(vec4f(at * 4.0 - 1.0, 1.0, 1.0), offset);
}

// Hides 8-bit banding (Jimenez 2014, "interleaved gradient noise").
fn dither(pixel: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

@fragment
fn backdrop(in: BackdropOut) -> @location(0) vec4f {
    let share = smoothstep(0.0, 0.7, dot(in.offset, in.offset));
    let color = mix(frame.background_center.rgb, frame.background_edge.rgb, share);
    return vec4f(color + dither(in.position.xy), 1.0);
}
