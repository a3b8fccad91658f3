// Lighting: the environment, the key light with its shadow, and the file's own lights.

@group(1) @binding(0) var environment: texture_cube<f32>;
@group(1) @binding(1) var environment_sampler: sampler;
@group(1) @binding(2) var shadow_map: texture_depth_2d;
@group(1) @binding(3) var shadow_sampler: sampler_comparison;
@group(1) @binding(4) var reflectance: texture_2d<f32>;
@group(1) @binding(5) var irradiance: texture_cube<f32>;
@group(1) @binding(6) var transmission_buffer: texture_2d<f32>;

const PI: f32 = 3.14159265;
// Edge length of the reflectance table, environment/reflectance.rs.
const REFLECTANCE_SIZE: f32 = 24.0;

fn environment_from_world(direction: vec3f) -> vec3f {
    let c = frame.environment.x;
    let s = frame.environment.y;
    return vec3f(c * direction.x - s * direction.z, direction.y, s * direction.x + c * direction.z);
}

// Radiance reflected by a white diffuse surface.
fn environment_diffuse(normal: vec3f) -> vec3f {
    return textureSampleLevel(irradiance, environment_sampler, environment_from_world(normal), 0.0).rgb;
}

fn environment_specular(reflected: vec3f, roughness: f32) -> vec3f {
    let direction = environment_from_world(reflected);
    // Smooth surfaces, whose reflections are the sharpest, get most of the levels.
    let level = frame.environment_last_level * roughness * (2.0 - roughness);
    return textureSampleLevel(environment, environment_sampler, direction, level).rgb;
}

// Of white light from all directions, what the GGX lobe reflects towards the viewer: a factor of the reflectance at normal
// incidence, and an offset.
fn directional_albedo(roughness: f32, normal_view: f32) -> vec2f {
    let at = vec2f(sqrt(normal_view), roughness) * (REFLECTANCE_SIZE - 1.0) + 0.5;
    return textureSampleLevel(reflectance, environment_sampler, at / REFLECTANCE_SIZE, 0.0).rg;
}

// Reflected fraction of an environment, with light that leaves the surface after several reflections (Fdez-Agüera 2019, "A
// Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting", as in the Khronos glTF Sample Viewer). White
// reflects everything. `weight` is that of KHR_materials_specular.
fn environment_reflectance(specular: vec3f, weight: f32, albedo: vec2f, roughness: f32, normal_view: f32) -> vec3f {
    let grazing = max(vec3f(1.0 - roughness), specular) - specular;
    let once = weight * ((specular + grazing * schlick(normal_view)) * albedo.x + albedo.y);
    let lost = 1.0 - albedo.x - albedo.y;
    let average = weight * (specular + (1.0 - specular) / 21.0);
    return once + once * average * lost / (1.0 - average * lost);
}

// Schlick's Fresnel weight: 0 at normal incidence, 1 at grazing incidence.
fn schlick(cosine: f32) -> f32 {
    let grazing = 1.0 - cosine;
    let squared = grazing * grazing;
    return squared * squared * grazing;
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
