// KHR_materials_transmission, with refraction, absorption (KHR_materials_volume) and dispersion. The scene behind the
// surface is sampled from a copy of everything opaque, at a mip level that matches the roughness.

#if TRANSMISSION

// Inverts any tone mapping by iteration, from display colours to radiance times exposure.
fn scene_from_display(display: vec3f) -> vec3f {
    var scene = display;
    for (var step = 0u; step < 8u; step++) {
        scene = min(scene * sqrt(display / max(tone_map(scene), vec3f(1e-4))), vec3f(16.0));
    }
    return scene;
}

// The pixel at which a refracted ray leaves the volume. Everything behind is assumed to be at that depth.
fn exit_pixel(in: VertexOut, ray: vec3f) -> vec2f {
    let here = frame.projection_from_world * vec4f(frame.eye - in.to_eye, 1.0);
    let there = here + frame.projection_from_world * vec4f(ray, 0.0);
    let moved = there.xy / there.w - here.xy / here.w;
    return in.position.xy + 0.5 * frame.viewport_pixels * vec2f(moved.x, -moved.y);
}

// Samples the transmission buffer within the surface's pane.
fn opaque_scene(pixel: vec2f, surface: vec2f, roughness: f32) -> vec4f {
    let size = vec2f(textureDimensions(transmission_buffer));
    let level = log2(size.x) * roughness;
    let pane = frame.viewport_pixels / size;
    let corner = floor(surface / frame.viewport_pixels) * pane;
    let border = min(0.5 * exp2(level) / size, 0.5 * pane);
    let at = clamp(pixel / size, corner + border, corner + pane - border);
    return textureSampleLevel(transmission_buffer, environment_sampler, at, level);
}

// Less refraction means less blur.
fn transmission_roughness(roughness: f32) -> f32 {
    return roughness * clamp(2.0 * material.ior - 2.0, 0.0, 1.0);
}

#if VOLUME
// The opaque scene seen along a ray through the volume, refracted with this index. `thickness` is in metres.
fn refracted_scene(in: VertexOut, surface: Surface, ior: f32, thickness: f32) -> vec4f {
    let ray = thickness * refract(-surface.to_eye, surface.normal, 1.0 / max(ior, 1.0));
    return opaque_scene(exit_pixel(in, ray), in.position.xy, surface.transmission_roughness);
}
#endif

// The linear display colour behind the surface, and its coverage. `thickness` is in metres.
fn color_behind(in: VertexOut, surface: Surface, thickness: f32) -> vec4f {
#if VOLUME
    var found = refracted_scene(in, surface, material.ior, thickness);
#if DISPERSION
    let spread = (material.ior - 1.0) * 0.025 * material.dispersion;
    found.r = refracted_scene(in, surface, material.ior - spread, thickness).r;
    found.b = refracted_scene(in, surface, material.ior + spread, thickness).b;
#endif
#else
    let found = opaque_scene(in.position.xy, in.position.xy, surface.transmission_roughness);
#endif
    return found;
}
#endif
