// The studio's backdrop: a soft gradient, already in the picture's sRGB.

@vertex
fn full_screen(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 1.0, 1.0);
}

// A little noise hides the steps of the gradient in eight bits (Jimenez 2014, "interleaved gradient noise").
fn dither(pixel: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

@fragment
fn backdrop(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let offset = (position.xy / frame.viewport_pixels - vec2f(0.5, 0.45)) * vec2f(1.1, 1.25);
    let color = mix(frame.background_center.rgb, frame.background_edge.rgb, smoothstep(0.0, 0.7, dot(offset, offset)));
    return vec4f(color + dither(position.xy), 1.0);
}
