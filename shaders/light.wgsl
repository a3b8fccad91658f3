// Lighting: the studio environment, the key light with its shadow, and the file's own lights.

@group(1) @binding(0) var environment: texture_cube<f32>;
@group(1) @binding(1) var environment_sampler: sampler;
@group(1) @binding(2) var shadow_map: texture_depth_2d;
@group(1) @binding(3) var shadow_sampler: sampler_comparison;

const PI: f32 = 3.14159265;
// Mip levels of the environment, roughness 0 to 1.
const ENVIRONMENT_LAST_LEVEL: f32 = 5.0;

fn environment_from_world(direction: vec3f) -> vec3f {
    let c = frame.environment.x;
    let s = frame.environment.y;
    return vec3f(c * direction.x - s * direction.z, direction.y, s * direction.x + c * direction.z);
}

// Radiance reflected by a white diffuse surface.
fn environment_diffuse(normal: vec3f) -> vec3f {
    let n = environment_from_world(normal);
    let sum = frame.irradiance[0].rgb
        + frame.irradiance[1].rgb * n.y
        + frame.irradiance[2].rgb * n.z
        + frame.irradiance[3].rgb * n.x
        + frame.irradiance[4].rgb * (n.x * n.y)
        + frame.irradiance[5].rgb * (n.y * n.z)
        + frame.irradiance[6].rgb * (3.0 * n.z * n.z - 1.0)
        + frame.irradiance[7].rgb * (n.x * n.z)
        + frame.irradiance[8].rgb * (n.x * n.x - n.y * n.y);
    return max(sum, vec3f(0.0));
}

fn environment_specular(reflected: vec3f, roughness: f32) -> vec3f {
    let direction = environment_from_world(reflected);
    return textureSampleLevel(environment, environment_sampler, direction, roughness * ENVIRONMENT_LAST_LEVEL).rgb;
}

// Scale and bias of the reflectance at normal incidence (Karis 2014, "Physically Based Shading on Mobile").
fn environment_brdf(roughness: f32, normal_view: f32) -> vec2f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * normal_view)) * r.x + r.y;
    return vec2f(-1.04, 1.04) * a + r.zw;
}

fn shadow_tap(at: vec3f, offset: vec2f) -> f32 {
    return textureSampleCompareLevel(shadow_map, shadow_sampler, at.xy + offset, at.z);
}

// Texture coordinates and depth in the shadow map.
fn shadow_coordinates(world: vec3f) -> vec3f {
    let at = frame.shadow_from_world * vec4f(world, 1.0);
    return vec3f(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, min(at.z, 1.0));
}

// Fraction of the shadow-casting light that reaches a point on a mesh.
fn mesh_shadow(world: vec3f, normal: vec3f) -> f32 {
    let at = shadow_coordinates(world + 1.5 * frame.shadow_texel * normal);
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    let sum = shadow_tap(at, texel * vec2f(-0.25, -0.75)) + shadow_tap(at, texel * vec2f(0.75, -0.25))
        + shadow_tap(at, texel * vec2f(0.25, 0.75)) + shadow_tap(at, texel * vec2f(-0.75, 0.25));
    return 0.25 * sum;
}

struct Surface {
    normal: vec3f,
    to_eye: vec3f,
    diffuse: vec3f,
    // Reflectance at normal incidence.
    specular: vec3f,
    roughness: f32,
    normal_view: f32,
}

// BRDF times the cosine for a light direction: GGX distribution, height-correlated Smith visibility (Hammon's
// approximation), Schlick Fresnel.
fn reflect_light(surface: Surface, to_light: vec3f) -> vec3f {
    let normal_light = dot(surface.normal, to_light);
    if normal_light <= 0.0 {
        return vec3f(0.0);
    }
    let half_way = normalize(to_light + surface.to_eye);
    let normal_half = max(dot(surface.normal, half_way), 0.0);
    let view_half = max(dot(surface.to_eye, half_way), 0.0);
    let alpha = surface.roughness * surface.roughness;
    let alpha_squared = alpha * alpha;
    let f = normal_half * normal_half * (alpha_squared - 1.0) + 1.0;
    let distribution = alpha_squared / (PI * f * f);
    let visibility = 0.5 / mix(2.0 * normal_light * surface.normal_view, normal_light + surface.normal_view, alpha);
    let grazing = 1.0 - view_half;
    let grazing_squared = grazing * grazing;
    let fresnel = surface.specular + (1.0 - surface.specular) * (grazing_squared * grazing_squared * grazing);
    let diffuse = (1.0 - fresnel) * surface.diffuse / PI;
    return normal_light * (diffuse + min(distribution * visibility, 64.0) * fresnel);
}

// Radiance from one of the file's lights at a point; sets `to_light` to the direction to it.
fn light_at(light: Light, world: vec3f, to_light: ptr<function, vec3f>) -> vec3f {
    if light.kind == 0u {
        *to_light = -light.direction;
        return light.color;
    }
    let offset = light.position - world;
    let squared = max(dot(offset, offset), 1e-12);
    *to_light = offset * inverseSqrt(squared);
    var attenuation = 1.0 / squared;
    if light.range > 0.0 {
        let part = squared / (light.range * light.range);
        let window = clamp(1.0 - part * part, 0.0, 1.0);
        attenuation *= window;
    }
    if light.kind == 2u {
        let cone = clamp(dot(-*to_light, light.direction) * light.spot_scale + light.spot_offset, 0.0, 1.0);
        attenuation *= cone * cone;
    }
    return light.color * attenuation;
}
