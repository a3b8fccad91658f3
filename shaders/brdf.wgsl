// The BRDF of a surface times the cosine, for one light direction.

struct Surface {
    normal: vec3f,
    to_eye: vec3f,
    // Diffuse reflectance, less what metal absorbs and what is transmitted.
    diffuse: vec3f,
    // Reflectance at normal and at grazing incidence: of the whole surface, and of its dielectric part.
    specular: vec3f,
    grazing: f32,
    dielectric: vec3f,
    dielectric_grazing: f32,
    roughness: f32,
    normal_view: f32,
#if CLEARCOAT
    coat_normal: vec3f,
    coat_roughness: f32,
    // Weight of the coat towards the viewer.
    coat: f32,
#endif
#if SHEEN
    sheen_color: vec3f,
    sheen_roughness: f32,
#endif
#if ANISOTROPY
    // Directions along and across the anisotropic highlight.
    tangent: vec3f,
    bitangent: vec3f,
    anisotropy: f32,
#endif
#if IRIDESCENCE
    iridescence: f32,
    // Reflectance of the film over the dielectric, and over its mixture with metal.
    film_dielectric: vec3f,
    film: vec3f,
#endif
#if TRANSMISSION
    // Tint and roughness of transmitted light.
    transmitted: vec3f,
    transmission_roughness: f32,
#endif
#if DIFFUSE_TRANSMISSION
    diffuse_transmitted: vec3f,
#endif
}

const DIELECTRIC: f32 = 0.04;
// Punctual lights have no size: below this roughness, their highlights would be too small to see.
const MIN_ROUGHNESS: f32 = 0.045;

fn max3(color: vec3f) -> f32 {
    return max(color.r, max(color.g, color.b));
}

// GGX distribution times height-correlated Smith visibility.
fn ggx(roughness: f32, normal_half: f32, normal_light: f32, normal_view: f32) -> f32 {
    let bounded = max(roughness, MIN_ROUGHNESS);
    let alpha = bounded * bounded;
    let alpha_squared = alpha * alpha;
    let f = normal_half * normal_half * (alpha_squared - 1.0) + 1.0;
    let distribution = alpha_squared / (PI * f * f);
    let cosines = vec2f(normal_light, normal_view);
    let masked = cosines.yx * sqrt(cosines * cosines * (1.0 - alpha_squared) + alpha_squared);
    return min(distribution * 0.5 / (masked.x + masked.y), 64.0);
}

// Reflection of everything below sheen and clearcoat, with Schlick's Fresnel term.
fn reflect_base(surface: Surface, to_light: vec3f) -> vec3f {
    let normal_light = dot(surface.normal, to_light);
    if normal_light <= 0.0 {
#if TRANSMISSIVE
        return transmit_light(surface, to_light);
#else
        return vec3f(0.0);
#endif
    }
    let half_way = normalize(to_light + surface.to_eye);
    let grazing = schlick(max(dot(surface.to_eye, half_way), 0.0));
#if ANISOTROPY
    let lobe = anisotropic_ggx(surface, half_way, to_light, normal_light);
#else
    let lobe = ggx(surface.roughness, max(dot(surface.normal, half_way), 0.0), normal_light, surface.normal_view);
#endif
    let dielectric = mix(surface.dielectric, vec3f(surface.dielectric_grazing), grazing);
    let specular = mix(surface.specular, vec3f(surface.grazing), grazing);
    var color = (1.0 - dielectric) * surface.diffuse / PI + lobe * specular;
#if IRIDESCENCE
    let film = (1.0 - max3(surface.film_dielectric)) * surface.diffuse / PI + lobe * surface.film;
    color = mix(color, film, surface.iridescence);
#endif
    return normal_light * color;
}

#if TRANSMISSIVE
// Transmission of light from behind, computed like reflection of the light mirrored to the front.
fn transmit_light(surface: Surface, to_light: vec3f) -> vec3f {
    let cosine = -dot(surface.normal, to_light);
    let half_way = normalize(to_light + 2.0 * cosine * surface.normal + surface.to_eye);
    let grazing = schlick(max(dot(surface.to_eye, half_way), 0.0));
    var color = vec3f(0.0);
#if DIFFUSE_TRANSMISSION
    color += surface.diffuse_transmitted / PI;
#endif
#if TRANSMISSION
    let normal_half = max(dot(surface.normal, half_way), 0.0);
    color += surface.transmitted * ggx(surface.transmission_roughness, normal_half, cosine, surface.normal_view);
#endif
    return cosine * (1.0 - mix(surface.dielectric, vec3f(surface.dielectric_grazing), grazing)) * color;
}
#endif

fn reflect_light(surface: Surface, to_light: vec3f) -> vec3f {
    var color = reflect_base(surface, to_light);
#if SHEEN
    color = sheen_light(surface, color, to_light);
#endif
#if CLEARCOAT
    color = mix(color, coat_light(surface, to_light), surface.coat);
#endif
    return color;
}
