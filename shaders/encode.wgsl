// From the scene's light to the picture: tone mapping, background, sRGB curve, in one pass.

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
    let light = textureLoad(scene, vec2i(position.xy), 0);
    let alpha = clamp(light.a, 0.0, 1.0);
    var color = vec3f(0.0);
    if alpha > 0.0 {
        color = clamp(tone_map(light.rgb * (frame.exposure / alpha)), vec3f(0.0), vec3f(1.0));
    }
    if frame.background_center.w == 0.0 {
        return vec4f(srgb_from_linear(color) * alpha, alpha);
    }
    let offset = (position.xy / frame.viewport_pixels - vec2f(0.5, 0.45)) * vec2f(1.1, 1.25);
    let background = mix(frame.background_center.rgb, frame.background_edge.rgb, smoothstep(0.0, 0.7, dot(offset, offset)));
    let display = srgb_from_linear(mix(background, color, alpha));
    return vec4f(display + (1.0 - alpha) * frame.background_edge.w * dither(position.xy), 1.0);
}
