// KHR_materials_sheen: fibres on the surface, with the Charlie distribution (Estevez and Kulla 2017, "Production
// Friendly Microfacet Sheen BRDF").

#if SHEEN

fn charlie_fit(x: f32, alpha: f32) -> f32 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let a = mix(21.5473, 25.3245, t);
    let b = mix(3.82987, 3.32435, t);
    let c = mix(0.19823, 0.16801, t);
    let d = mix(-1.97760, -1.27393, t);
    let e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * pow(x, c)) + d * x + e;
}

fn charlie_masking(cosine: f32, alpha: f32) -> f32 {
    let near = charlie_fit(min(cosine, 1.0 - cosine), alpha);
    return exp(select(near, 2.0 * charlie_fit(0.5, alpha) - near, cosine >= 0.5));
}

// Directional albedo of white sheen. Fits the integral of the lobe with a mean error of 0.005 and a maximum of 0.02.
fn sheen_albedo(roughness: f32, cosine: f32) -> f32 {
    let inverse = 1.0 / roughness;
    let powers = vec4f(roughness, roughness * roughness, inverse, inverse * inverse);
    let a = dot(powers, vec4f(0.8964, -0.2046, 0.2439, -0.009195)) - 1.148;
    let b = dot(powers, vec4f(0.4373, -0.8, -1.556, 0.0502)) + 0.268;
    let c = dot(powers, vec4f(14.22, -6.291, 2.869, -0.2906)) - 10.52;
    return min(exp(a + cosine * (b + cosine * c)), 1.0);
}

// Adds the sheen, and attenuates what is below by its albedo.
fn sheen_light(surface: Surface, below: vec3f, to_light: vec3f) -> vec3f {
    let alpha = surface.sheen_roughness * surface.sheen_roughness;
    let normal_light = clamp(dot(surface.normal, to_light), 0.001, 1.0);
    let normal_half = dot(surface.normal, normalize(to_light + surface.to_eye));
    let distribution = (2.0 + 1.0 / alpha) * pow(max(1.0 - normal_half * normal_half, 1e-6), 0.5 / alpha) / (2.0 * PI);
    let masking = 1.0 + charlie_masking(surface.normal_view, alpha) + charlie_masking(normal_light, alpha);
    let visibility = min(1.0 / (masking * 4.0 * surface.normal_view * normal_light), 1.0);
    let albedo = max(
        sheen_albedo(surface.sheen_roughness, surface.normal_view),
        sheen_albedo(surface.sheen_roughness, normal_light));
    let is_lit = step(0.0, dot(surface.normal, to_light));
    return (1.0 - max3(surface.sheen_color) * albedo) * below
        + is_lit * normal_light * distribution * visibility * surface.sheen_color;
}
#endif
