// From the scene to the picture: background and sRGB curve.

@group(1) @binding(0) var scene: texture_2d<f32>;

@vertex
fn full_screen(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 1.0, 1.0);
}

// A little noise hides the steps of the gradient in eight bits (Jimenez 2014, "interleaved gradient noise").
fn dither(pixel: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

@fragment
fn encode(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let shown = textureLoad(scene, vec2i(position.xy), 0);
    if frame.background_center.w == 0.0 {
        let color = shown.rgb / max(shown.a, 1e-6);
        return vec4f(srgb_from_linear(color) * shown.a, shown.a);
    }
    let offset = (position.xy / frame.viewport_pixels - vec2f(0.5, 0.45)) * vec2f(1.1, 1.25);
    let background = mix(frame.background_center.rgb, frame.background_edge.rgb, smoothstep(0.0, 0.7, dot(offset, offset)));
    let display = srgb_from_linear(shown.rgb + (1.0 - shown.a) * background);
    return vec4f(display + (1.0 - shown.a) * frame.background_edge.w * dither(position.xy), 1.0);
}
