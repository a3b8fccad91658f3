// KHR_materials_iridescence: thin-film interference (Belcour and Barla 2017, "A Practical Extension to
// Microfacet Theory for the Modeling of Varying Iridescence"), as in the extension's specification.

#if IRIDESCENCE

// Sensitivity of the eye to an optical path difference: the Fourier transform of the CIE colour matching functions, in
// linear Rec. 709.
fn interference(path_nanometres: f32, shift: vec3f) -> vec3f {
    let rec709_from_xyz = mat3x3f(
        3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252);
    let phase = 2.0 * PI * path_nanometres * 1e-9;
    let squared = phase * phase;
    var xyz = vec3f(0.84659, 1.00022, 1.00112) * cos(vec3f(1.6810e6, 1.7953e6, 2.2084e6) * phase + shift)
        * exp(-squared * vec3f(4.3278e9, 9.3046e9, 6.6121e9));
    xyz.x += 0.153869 * cos(2.2399e6 * phase + shift.x) * exp(-4.5282e9 * squared);
    return rec709_from_xyz * xyz;
}

fn reflectance_between(a: vec3f, b: vec3f) -> vec3f {
    let ratio = (a - b) / (a + b);
    return ratio * ratio;
}

// Reflectance of a film over a base, given the base's reflectance at normal incidence.
fn film_reflectance(film_ior: f32, cosine: f32, nanometres: f32, base: vec3f) -> vec3f {
    let ior = mix(1.0, film_ior, smoothstep(0.0, 0.03, nanometres));
    let cosine_squared = 1.0 - (1.0 - cosine * cosine) / (ior * ior);
    if cosine_squared < 0.0 {
        return vec3f(1.0);
    }
    let inside = sqrt(cosine_squared);
    let top = mix(reflectance_between(vec3f(ior), vec3f(1.0)).x, 1.0, schlick(cosine));
    let through = 1.0 - top;
    let root = sqrt(clamp(base, vec3f(0.0), vec3f(0.9999)));
    let base_ior = (1.0 + root) / (1.0 - root);
    let bottom = mix(reflectance_between(base_ior, vec3f(ior)), vec3f(1.0), schlick(inside));
    let shift = select(vec3f(PI), vec3f(0.0), ior < 1.0) + select(vec3f(0.0), vec3f(PI), base_ior < vec3f(ior));
    let both = clamp(top * bottom, vec3f(1e-5), vec3f(0.9999));
    let repeated = through * through * bottom / (1.0 - both);
    var sum = top + repeated;
    var order = repeated - through;
    for (var m = 1.0; m < 3.0; m += 1.0) {
        order *= sqrt(both);
        sum += 2.0 * order * interference(m * 2.0 * ior * nanometres * inside, m * shift);
    }
    return clamp(sum, vec3f(0.0), vec3f(1.0));
}
#endif
