// KHR_materials_transmission, with refraction, absorption (KHR_materials_volume) and dispersion: what is behind the surface is
// looked up in a picture of everything opaque, in a mip level that fits the roughness.

#if TRANSMISSION

// Inverts tone mapping, whatever it is: what the opaque picture shows becomes light again, times exposure.
fn scene_from_display(display: vec3f) -> vec3f {
    var scene = display;
    for (var step = 0u; step < 8u; step++) {
        scene = min(scene * sqrt(display / max(tone_map(scene), vec3f(1e-4))), vec3f(16.0));
    }
    return scene;
}

// Where a refracted ray leaves the volume. Everything behind is taken to be there.
fn exit_pixel(in: VertexOut, ray: vec3f) -> vec2f {
    let here = frame.projection_from_world * vec4f(frame.eye - in.to_eye, 1.0);
    let there = here + frame.projection_from_world * vec4f(ray, 0.0);
    let moved = there.xy / there.w - here.xy / here.w;
    return in.position.xy + 0.5 * frame.viewport_pixels * vec2f(moved.x, -moved.y);
}

// Of the picture, only the pane of the surface.
fn behind(pixel: vec2f, surface: vec2f, roughness: f32) -> vec4f {
    let size = vec2f(textureDimensions(opaque_picture));
    let level = log2(size.x) * roughness;
    let pane = frame.viewport_pixels / size;
    let corner = floor(surface / frame.viewport_pixels) * pane;
    let border = min(0.5 * exp2(level) / size, 0.5 * pane);
    let at = clamp(pixel / size, corner + border, corner + pane - border);
    return textureSampleLevel(opaque_picture, environment_sampler, at, level);
}

// Little refraction means little blur.
fn transmission_roughness(roughness: f32) -> f32 {
    return roughness * clamp(2.0 * material.ior - 2.0, 0.0, 1.0);
}

fn refracted(surface: Surface, ior: f32) -> vec3f {
    return refract(-surface.to_eye, surface.normal, 1.0 / max(ior, 1.0));
}

// What is shown behind, linear, and its coverage. `thickness` in metres.
fn shown_behind(in: VertexOut, surface: Surface, thickness: f32) -> vec4f {
    let roughness = surface.transmission_roughness;
#if VOLUME
    let ray = thickness * refracted(surface, material.ior);
    var found = behind(exit_pixel(in, ray), in.position.xy, roughness);
#if DISPERSION
    let spread = (material.ior - 1.0) * 0.025 * material.dispersion;
    found.r = behind(exit_pixel(in, thickness * refracted(surface, material.ior - spread)), in.position.xy, roughness).r;
    found.b = behind(exit_pixel(in, thickness * refracted(surface, material.ior + spread)), in.position.xy, roughness).b;
#endif
#else
    let found = behind(in.position.xy, in.position.xy, roughness);
#endif
    return found;
}
#endif
