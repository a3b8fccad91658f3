// KHR_materials_clearcoat: a clear layer over everything else, with an index of refraction of 1.5.

#if CLEARCOAT

// Blended over what is below with a weight of `surface.coat`.
fn coat_light(surface: Surface, to_light: vec3f) -> vec3f {
    let normal_light = max(dot(surface.coat_normal, to_light), 0.0);
    let normal_half = max(dot(surface.coat_normal, normalize(to_light + surface.to_eye)), 0.0);
    let normal_view = clamp(dot(surface.coat_normal, surface.to_eye), 0.001, 1.0);
    return vec3f(normal_light * ggx(surface.coat_roughness, normal_half, normal_light, normal_view));
}
#endif
