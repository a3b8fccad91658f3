// Fragment stages of meshes: metallic-roughness, unlit, heat map, wireframe, shadow. Overrides remove unused features.

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
// Masks set the coverage of the pixel's samples instead of discarding it.
override COVERAGE: bool = false;
override BLEND: bool = false;
override SHADOW: bool = false;
// Uses the file's lights instead of the key light.
override FILE_LIGHTS: bool = false;

// Alpha from which a blended surface counts as opaque; must match model.rs.
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
    // Base colour, metallic-roughness, normal, occlusion, emissive.
    uvs: array<UvTransform, 5>,
}

@group(3) @binding(0) var<uniform> material: Material;
@group(3) @binding(1) var base_color_map: texture_2d<f32>;
@group(3) @binding(2) var base_color_sampler: sampler;
@group(3) @binding(3) var metallic_roughness_map: texture_2d<f32>;
@group(3) @binding(4) var metallic_roughness_sampler: sampler;
@group(3) @binding(5) var normal_map: texture_2d<f32>;
@group(3) @binding(6) var normal_sampler: sampler;
@group(3) @binding(7) var occlusion_map: texture_2d<f32>;
@group(3) @binding(8) var occlusion_sampler: sampler;
@group(3) @binding(9) var emissive_map: texture_2d<f32>;
@group(3) @binding(10) var emissive_sampler: sampler;

fn map_uv(slot: u32, uv: vec4f) -> vec2f {
    let transform = material.uvs[slot];
    let chosen = select(uv.xy, uv.zw, transform.uv_set == 1u);
    return transform.matrix.xy * chosen.x + transform.matrix.zw * chosen.y + transform.offset;
}

fn base_color(in: VertexOut) -> vec4f {
    var color = material.base_color;
    if BASE_COLOR_MAP {
        color *= textureSample(base_color_map, base_color_sampler, map_uv(0u, in.uv));
    }
    if VERTEX_COLORS {
        color *= in.color;
    }
    return color;
}

fn emissive(in: VertexOut) -> vec3f {
    if EMISSIVE_MAP {
        return material.emissive * textureSample(emissive_map, emissive_sampler, map_uv(4u, in.uv)).rgb;
    }
    return material.emissive;
}

// Coverage of a pixel by a mask: its edge, as wide as a pixel (Golus 2017, "Anti-aliased Alpha Test").
fn mask_coverage(alpha: f32) -> f32 {
    let smallest = 1e-4;
    return clamp((alpha - material.alpha_cutoff + smallest) / max(fwidth(alpha), smallest) + 0.5, 0.0, 1.0);
}

// Encodes and premultiplies. The alpha test comes last, because textures must be sampled in uniform control flow.
fn finish(display: vec3f, alpha: f32) -> vec4f {
    let color = srgb_from_linear(display);
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

fn surface_normal(in: VertexOut, front: bool) -> vec3f {
    var normal: vec3f;
    var side = 1.0;
    if FLAT {
        normal = flat_normal(in);
    } else {
        side = select(-1.0, 1.0, front);
        normal = side * normalize_or_zero(in.normal);
    }
    if NORMAL_MAP {
        let uv = map_uv(2u, in.uv);
        var sample = 2.0 * textureSample(normal_map, normal_sampler, uv).xyz - 1.0;
        sample = vec3f(sample.xy * material.normal_scale, sample.z);
        var tangent: vec3f;
        var bitangent: vec3f;
        if TANGENTS {
            tangent = side * normalize_or_zero(in.tangent.xyz);
            bitangent = in.tangent.w * cross(normal, tangent);
        } else {
            // Cotangent frame from screen-space derivatives (Schüler, "Followup: Normal Mapping Without Precomputed
            // Tangents"), negated because the screen's y axis points down.
            let across = -dpdx(in.to_eye);
            let down = -dpdy(in.to_eye);
            let uv_across = dpdx(uv);
            let uv_down = dpdy(uv);
            let a = cross(down, normal);
            let b = cross(normal, across);
            tangent = -(a * uv_across.x + b * uv_down.x);
            // glTF's v axis points down, its bitangent up.
            bitangent = a * uv_across.y + b * uv_down.y;
            let scale = inverseSqrt(max(max(dot(tangent, tangent), dot(bitangent, bitangent)), 1e-38));
            tangent *= scale;
            bitangent *= scale;
        }
        normal = normalize_or_zero(sample.x * tangent + sample.y * bitangent + sample.z * normal);
    }
    return normal;
}

@fragment
fn lit(in: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let base = base_color(in);
    var metallic = material.metallic;
    var roughness = material.roughness;
    if METALLIC_ROUGHNESS_MAP {
        let sample = textureSample(metallic_roughness_map, metallic_roughness_sampler, map_uv(1u, in.uv));
        metallic *= sample.b;
        roughness *= sample.g;
    }
    var occlusion = 1.0;
    if OCCLUSION_MAP {
        let sample = textureSample(occlusion_map, occlusion_sampler, map_uv(3u, in.uv)).r;
        occlusion = 1.0 + material.occlusion_strength * (sample - 1.0);
    }
    let emitted = emissive(in);

    var surface: Surface;
    surface.normal = surface_normal(in, front);
    surface.to_eye = normalize(in.to_eye);
    metallic = clamp(metallic, 0.0, 1.0);
    surface.roughness = clamp(roughness, 0.0, 1.0);
    surface.diffuse = base.rgb * (1.0 - metallic);
    surface.specular = mix(vec3f(DIELECTRIC), base.rgb, metallic);
    let facing = dot(surface.normal, surface.to_eye);
    surface.normal_view = clamp(facing, 0.001, 1.0);

    let reflected = 2.0 * facing * surface.normal - surface.to_eye;
    let specular_light = environment_specular(reflected, surface.roughness);
    let albedo = directional_albedo(surface.roughness, surface.normal_view);
    let metal = environment_reflectance(base.rgb, albedo, surface.roughness, surface.normal_view);
    let dielectric = environment_reflectance(vec3f(DIELECTRIC), albedo, surface.roughness, surface.normal_view);
    var color = mix(base.rgb * environment_diffuse(surface.normal), specular_light, dielectric);
    color = mix(color, metal * specular_light, metallic);
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
    return finish(tone_map(frame.exposure * (color + emitted)), base.a);
}

@fragment
fn unlit(in: VertexOut) -> @location(0) vec4f {
    let base = base_color(in);
    return finish(base.rgb + emissive(in), base.a);
}

// Grey-blue for no weight, then blue, green, yellow, red.
fn heat_color(weight: f32) -> vec3f {
    let blue = vec3f(0.03, 0.16, 0.75);
    let green = vec3f(0.04, 0.55, 0.16);
    let yellow = vec3f(0.95, 0.75, 0.03);
    let red = vec3f(0.80, 0.03, 0.02);
    var color = mix(blue, green, clamp(3.0 * weight, 0.0, 1.0));
    color = mix(color, yellow, clamp(3.0 * weight - 1.0, 0.0, 1.0));
    color = mix(color, red, clamp(3.0 * weight - 2.0, 0.0, 1.0));
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

// What a blended surface hides of itself: all that is behind its opaque parts.
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
