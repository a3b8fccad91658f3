// Fragment stages of meshes: metallic-roughness with lobes, unlit, heat map, wireframe, depth, shadow; MToon is in
// toon.wgsl, single inputs of shading in channel.wgsl. Overrides remove unused features; crates/render/src/shaders.rs explains
// `#if`, `#maps`, `#heat` and `#influences`.

override BASE_COLOR_MAP: bool = false;
override METALLIC_ROUGHNESS_MAP: bool = false;
override NORMAL_MAP: bool = false;
override OCCLUSION_MAP: bool = false;
override EMISSIVE_MAP: bool = false;
override VERTEX_COLORS: bool = false;
// Derives normals from the drawn triangles.
override FLAT: bool = false;
override TANGENTS: bool = false;
override MASK: bool = false;
// Masks set the pixel's coverage instead of discarding it.
override COVERAGE: bool = false;
override BLEND: bool = false;
override SHADOW: bool = false;
// Uses the file's lights instead of the key light.
override FILE_LIGHTS: bool = false;
// Draws MToon's outline: the inflated mesh's back faces.
override OUTLINE: bool = false;

// Minimum alpha at which a blended surface counts as opaque; must match model.rs.
const OPAQUE_ALPHA: f32 = 0.9;

struct UvTransform {
    // Columns of the 2×2 matrix.
    matrix: vec4f,
    offset: vec2f,
    // 0 or 1.
    uv_set: u32,
}

struct Material {
    base_color: vec4f,
    emissive: vec3f,
    alpha_cutoff: f32,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    // Reflectance of the dielectric at normal incidence, and its weight.
    specular_color: vec3f,
    specular: f32,
    sheen_color: vec3f,
    sheen_roughness: f32,
    // Absorption per metre.
    absorption: vec3f,
    thickness: f32,
    diffuse_transmission_color: vec3f,
    diffuse_transmission: f32,
    clearcoat: f32,
    clearcoat_roughness: f32,
    clearcoat_normal_scale: f32,
    ior: f32,
    iridescence: f32,
    iridescence_ior: f32,
    // Nanometres.
    iridescence_thickness: vec2f,
    // Unit vector in tangent space.
    anisotropy_direction: vec2f,
    anisotropy: f32,
    transmission: f32,
    dispersion: f32,
    // MToon.
    shading_shift: f32,
    shading_shift_scale: f32,
    shading_toony: f32,
    shade_color: vec3f,
    gi_equalization: f32,
    matcap_color: vec3f,
    rim_lighting_mix: f32,
    rim_color: vec3f,
    rim_fresnel_power: f32,
    outline_color: vec3f,
    outline_lighting_mix: f32,
    rim_lift: f32,
    outline_width: f32,
    outline_on_screen: u32,
    // Per second.
    uv_rotation: f32,
    uv_scroll: vec2f,
    // In the order of the maps' bindings.
    uvs: array<UvTransform, 25>,
}

@group(3) @binding(0) var<uniform> material: Material;

fn map_uv(slot: u32, uv: vec4f) -> vec2f {
    let transform = material.uvs[slot];
    let chosen = select(uv.xy, uv.zw, transform.uv_set == 1u);
    return transform.matrix.xy * chosen.x + transform.matrix.zw * chosen.y + transform.offset;
}

#maps

fn base_color(in: VertexOut) -> vec4f {
    var color = material.base_color;
    if BASE_COLOR_MAP {
#if TOON
        color *= base_color_texel(animated_uv(in.uv));
#else
        color *= base_color_texel(in.uv);
#endif
    }
    if VERTEX_COLORS {
        color *= in.color;
    }
    return color;
}

fn emissive(in: VertexOut) -> vec3f {
    if EMISSIVE_MAP {
        return material.emissive * emissive_texel(in.uv).rgb;
    }
    return material.emissive;
}

// Coverage of a pixel by a mask whose edge is a pixel wide (Golus 2017, "Anti-aliased Alpha Test").
fn mask_coverage(alpha: f32) -> f32 {
    let smallest = 1e-4;
    return clamp((alpha - material.alpha_cutoff + smallest) / max(fwidth(alpha), smallest) + 0.5, 0.0, 1.0);
}

// Encodes and premultiplies.
fn finish(display: vec3f, alpha: f32) -> vec4f {
    return finish_encoded(srgb_from_linear(display), alpha);
}

// The alpha test comes last, because textures must be sampled in uniform control flow.
fn finish_encoded(color: vec3f, alpha: f32) -> vec4f {
    if MASK && COVERAGE {
        return vec4f(color, mask_coverage(alpha));
    }
    if MASK && alpha < material.alpha_cutoff {
        discard;
    }
    if BLEND {
        let share = clamp(alpha, 0.0, 1.0);
        return vec4f(color * share, share);
    }
    return vec4f(color, 1.0);
}

fn flat_normal(in: VertexOut) -> vec3f {
    let normal = cross(dpdx(in.to_eye), dpdy(in.to_eye));
    return normalize_or_zero(select(normal, -normal, dot(normal, in.to_eye) < 0.0));
}

fn geometric_normal(in: VertexOut, front: bool) -> vec3f {
    if FLAT {
        return flat_normal(in);
    }
    return select(-1.0, 1.0, front) * normalize_or_zero(in.normal);
}

// Columns: tangent, bitangent, normal.
fn tangent_frame(in: VertexOut, normal: vec3f, front: bool, uv: vec2f) -> mat3x3f {
    if TANGENTS {
        let side = select(-1.0, 1.0, front || FLAT);
        let tangent = side * normalize_or_zero(in.tangent.xyz);
        return mat3x3f(tangent, in.tangent.w * cross(normal, tangent), normal);
    }
    // Cotangent frame from screen-space derivatives (Schüler, "Followup: Normal Mapping Without Precomputed Tangents"),
    // negated because the screen's y axis points down.
    let across = -dpdx(in.to_eye);
    let down = -dpdy(in.to_eye);
    let uv_across = dpdx(uv);
    let uv_down = dpdy(uv);
    let a = cross(down, normal);
    let b = cross(normal, across);
    let tangent = -(a * uv_across.x + b * uv_down.x);
    // glTF's v axis points down, its bitangent up.
    let bitangent = a * uv_across.y + b * uv_down.y;
    let scale = inverseSqrt(max(max(dot(tangent, tangent), dot(bitangent, bitangent)), 1e-38));
    return mat3x3f(scale * tangent, scale * bitangent, normal);
}

// Transforms a texel of a normal map to world space.
fn mapped_normal(basis: mat3x3f, texel: vec4f, scale: f32) -> vec3f {
    let sample = 2.0 * texel.xyz - 1.0;
    return normalize_or_zero(basis * vec3f(sample.xy * scale, sample.z));
}

fn surface_normal(in: VertexOut, front: bool) -> vec3f {
    let normal = geometric_normal(in, front);
    if NORMAL_MAP {
        let basis = tangent_frame(in, normal, front, map_uv(2u, in.uv));
        return mapped_normal(basis, normal_texel(in.uv), material.normal_scale);
    }
    return normal;
}

#if TOON
#else
@fragment
fn lit(in: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let base = base_color(in);
    var metallic = material.metallic;
    var roughness = material.roughness;
    if METALLIC_ROUGHNESS_MAP {
        let sample = metallic_roughness_texel(in.uv);
        metallic *= sample.b;
        roughness *= sample.g;
    }
    var occlusion = 1.0;
    if OCCLUSION_MAP {
        occlusion = 1.0 + material.occlusion_strength * (occlusion_texel(in.uv).r - 1.0);
    }
    var emitted = emissive(in);

    var surface: Surface;
    surface.normal = surface_normal(in, front);
    surface.to_eye = normalize(in.to_eye);
    metallic = clamp(metallic, 0.0, 1.0);
    let facing = dot(surface.normal, surface.to_eye);
    surface.normal_view = clamp(facing, 0.001, 1.0);
    var dielectric = vec3f(DIELECTRIC);
    var weight = 1.0;
#if SPECULAR
    let specular_color = specular_color_texel(in.uv);
    dielectric = min(material.specular_color * specular_color.rgb, vec3f(1.0));
    weight = material.specular * specular_texel(in.uv).a;
#endif
#if GLOSSINESS
    roughness = 1.0 - (1.0 - roughness) * specular_color.a;
#endif
    surface.roughness = clamp(roughness, 0.0, 1.0);
    surface.diffuse = base.rgb * (1.0 - metallic);
    surface.dielectric = weight * dielectric;
    surface.dielectric_grazing = weight;
    surface.specular = mix(surface.dielectric, base.rgb, metallic);
    surface.grazing = mix(weight, 1.0, metallic);

#if ANISOTROPY
    let basis = tangent_frame(in, surface.normal, front, map_uv(14u, in.uv));
    let turn = material.anisotropy_direction;
    var direction = turn;
    surface.anisotropy = clamp(material.anisotropy, 0.0, 1.0);
#if ANISOTROPY_MAP
    let offset = anisotropy_texel(in.uv).rgb;
    direction = mat2x2f(turn, vec2f(-turn.y, turn.x)) * (2.0 * offset.rg - 1.0);
    surface.anisotropy *= offset.b;
#endif
    surface.tangent = normalize_or_zero(basis * vec3f(direction, 0.0));
    surface.bitangent = cross(surface.normal, surface.tangent);
    let reflected = reflect(-surface.to_eye, bent_normal(surface));
#else
    let reflected = 2.0 * facing * surface.normal - surface.to_eye;
#endif
    let specular_light = environment_specular(reflected, surface.roughness);
    let albedo = directional_albedo(surface.roughness, surface.normal_view);
    let metal = environment_reflectance(base.rgb, 1.0, albedo, surface.roughness, surface.normal_view);
    let mirrored = environment_reflectance(dielectric, weight, albedo, surface.roughness, surface.normal_view);
    var diffuse = base.rgb * environment_diffuse(surface.normal);
#if VOLUME
    let thickness = material.thickness * thickness_texel(in.uv).g * in.scale;
    let transmittance = exp(-material.absorption * thickness);
#else
    let thickness = 0.0;
    let transmittance = vec3f(1.0);
#endif
#if DIFFUSE_TRANSMISSION
    let passed = clamp(material.diffuse_transmission * diffuse_transmission_texel(in.uv).a, 0.0, 1.0);
    let tint = transmittance * material.diffuse_transmission_color * diffuse_transmission_color_texel(in.uv).rgb;
    diffuse = mix(diffuse, tint * environment_diffuse(-surface.normal), passed);
    surface.diffuse *= 1.0 - passed;
    surface.diffuse_transmitted = (1.0 - metallic) * passed * tint;
#endif
#if TRANSMISSION
    let transmission = clamp(material.transmission * transmission_texel(in.uv).r, 0.0, 1.0);
    surface.transmission_roughness = transmission_roughness(surface.roughness);
    surface.diffuse *= 1.0 - transmission;
    surface.transmitted = (1.0 - metallic) * transmission * transmittance * base.rgb;
    let behind = color_behind(in, surface, thickness);
    let scene_behind = scene_from_display(behind.rgb);
    diffuse = mix(diffuse, transmittance * base.rgb * scene_behind / frame.exposure, transmission);
#if DIFFUSE_TRANSMISSION
    surface.diffuse_transmitted *= 1.0 - transmission;
#endif
#endif
    var color = mix(diffuse, specular_light, mirrored);
    color = mix(color, metal * specular_light, metallic);
#if IRIDESCENCE
    surface.iridescence = clamp(material.iridescence * iridescence_texel(in.uv).r, 0.0, 1.0);
    let range = material.iridescence_thickness;
    let nanometres = mix(range.x, range.y, iridescence_thickness_texel(in.uv).g);
    let film = film_reflectance(material.iridescence_ior, surface.normal_view, nanometres, dielectric);
    let metal_film = film_reflectance(material.iridescence_ior, surface.normal_view, nanometres, base.rgb);
    surface.film_dielectric = film;
    surface.film = mix(film, metal_film, metallic);
    let below = (1.0 - metallic) * (1.0 - max3(film)) * diffuse;
    color = mix(color, below + surface.film * specular_light, surface.iridescence);
#endif
#if SHEEN
    surface.sheen_color = material.sheen_color * sheen_color_texel(in.uv).rgb;
    surface.sheen_roughness = clamp(material.sheen_roughness * sheen_roughness_texel(in.uv).a, 0.07, 1.0);
    let sheen = sheen_albedo(surface.sheen_roughness, surface.normal_view);
    color = (1.0 - max3(surface.sheen_color) * sheen) * color
        + sheen * surface.sheen_color * environment_diffuse(surface.normal);
#endif
#if CLEARCOAT
    surface.coat_normal = geometric_normal(in, front);
#if CLEARCOAT_NORMAL_MAP
    let coat_basis = tangent_frame(in, surface.coat_normal, front, map_uv(9u, in.uv));
    surface.coat_normal = mapped_normal(coat_basis, clearcoat_normal_texel(in.uv), material.clearcoat_normal_scale);
#endif
    surface.coat_roughness = clamp(material.clearcoat_roughness * clearcoat_roughness_texel(in.uv).g, 0.0, 1.0);
    let coat_facing = clamp(dot(surface.coat_normal, surface.to_eye), 0.0, 1.0);
    let coat = clamp(material.clearcoat * clearcoat_texel(in.uv).r, 0.0, 1.0);
    surface.coat = coat * mix(DIELECTRIC, 1.0, schlick(coat_facing));
    let coat_reflected = reflect(-surface.to_eye, surface.coat_normal);
    color = mix(color, environment_specular(coat_reflected, surface.coat_roughness), surface.coat);
    emitted *= 1.0 - surface.coat;
#endif
    color *= occlusion;

    let world = frame.eye - in.to_eye;
    var shadow = 1.0;
    if SHADOW {
        shadow = mesh_shadow(world, surface.normal);
    }
    if FILE_LIGHTS {
        for (var index = 0u; index < frame.light_count; index++) {
            var to_light: vec3f;
            var light = light_at(frame.lights[index], world, &to_light);
            if index == frame.shadow_light {
                light *= shadow;
            }
            color += light * reflect_light(surface, to_light);
        }
    } else {
        color += shadow * frame.key_color * reflect_light(surface, frame.key_direction);
    }
    var display = tone_map(frame.exposure * (color + emitted));
#if TRANSMISSION
    // Keeps colours that tone mapping can't produce, such as unlit ones.
    display += surface.transmitted * (behind.rgb - tone_map(scene_behind));
    // A transparent background stays transparent; reflections are added to it.
    let finished = finish(display, base.a);
    return vec4f(finished.rgb, finished.a * mix(1.0, behind.a, transmission * (1.0 - metallic)));
#else
    return finish(display, base.a);
#endif
}

#endif

@fragment
fn unlit(in: VertexOut) -> @location(0) vec4f {
    let base = base_color(in);
    return finish(base.rgb + emissive(in), base.a);
}

// Grey-blue for no weight, then blue, green, yellow, red.
#heat
fn heat_color(weight: f32) -> vec3f {
    var color = mix(HEAT_COLORS[0], HEAT_COLORS[1], clamp(3.0 * weight, 0.0, 1.0));
    color = mix(color, HEAT_COLORS[2], clamp(3.0 * weight - 1.0, 0.0, 1.0));
    color = mix(color, HEAT_COLORS[3], clamp(3.0 * weight - 2.0, 0.0, 1.0));
    return mix(vec3f(0.19, 0.23, 0.30), color, clamp(50.0 * weight, 0.0, 1.0));
}

@fragment
fn heat(in: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let alpha = base_color(in).a;
    let normal = surface_normal(in, front);
    // Just enough shading to convey the shape.
    let shade = 0.45 + 0.55 * clamp(dot(normal, normalize(in.to_eye)), 0.0, 1.0);
    return finish(shade * heat_color(in.heat), alpha);
}

@fragment
fn wireframe(in: VertexOut) -> @location(0) vec4f {
    return vec4f(draw.color.rgb * draw.color.a, draw.color.a);
}

// Depth of the opaque parts of a blended surface, which hide its layers behind them.
@fragment
fn depth_mask(in: VertexOut) -> @location(0) vec4f {
    if base_color(in).a < OPAQUE_ALPHA {
        discard;
    }
    return vec4f(0.0);
}

// Shadow pass: cuts out the holes of masked and blended materials.
@fragment
fn shadow_mask(in: VertexOut) {
    if base_color(in).a < material.alpha_cutoff {
        discard;
    }
}
