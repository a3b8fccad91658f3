// KHR_materials_anisotropy: brushed metal, hair, grooves.

#if ANISOTROPY

// GGX distribution times Smith visibility with different roughness along and across the tangent (Burley 2012,
// "Physically Based Shading at Disney").
fn anisotropic_ggx(surface: Surface, half_way: vec3f, to_light: vec3f, normal_light: f32) -> f32 {
    let roughness = max(surface.roughness, MIN_ROUGHNESS);
    let alpha = roughness * roughness;
    let along = mix(alpha, 1.0, surface.anisotropy * surface.anisotropy);
    let product = along * alpha;
    let h = vec3f(
        alpha * dot(surface.tangent, half_way),
        along * dot(surface.bitangent, half_way),
        product * dot(surface.normal, half_way));
    let spread = product / dot(h, h);
    let scale = vec3f(along, alpha, 1.0);
    let view = vec3f(dot(surface.tangent, surface.to_eye), dot(surface.bitangent, surface.to_eye), surface.normal_view);
    let light = vec3f(dot(surface.tangent, to_light), dot(surface.bitangent, to_light), normal_light);
    let masked = normal_light * length(scale * view) + surface.normal_view * length(scale * light);
    return min(product * spread * spread / PI * 0.5 / masked, 64.0);
}

// The normal to reflect about when looking up the environment, which approximates the stretched lobe.
fn bent_normal(surface: Surface) -> vec3f {
    let across = cross(cross(surface.bitangent, surface.to_eye), surface.bitangent);
    let bend = 1.0 - surface.anisotropy * (1.0 - surface.roughness);
    return normalize_or_zero(mix(across, surface.normal, bend * bend * bend * bend));
}
#endif
