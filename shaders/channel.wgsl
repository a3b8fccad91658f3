// A single input of shading as a flat colour, in its own permutation: most views never compile it.

#if CHANNEL
override UVS: bool = false;

// In the order of `Channel` in crates/scene/src/state/channel.rs.
const BASE_COLOR: u32 = 1u;
const NORMAL: u32 = 2u;
const TANGENT: u32 = 3u;
const ROUGHNESS: u32 = 4u;
const METALLIC: u32 = 5u;
const OCCLUSION: u32 = 6u;
const EMISSIVE: u32 = 7u;
const UV: u32 = 8u;
const VERTEX_COLOR: u32 = 9u;
const INFLUENCES: u32 = 10u;

// sRGB. Shows that the surface lacks the attribute.
const MISSING: vec3f = vec3f(0.23, 0.22, 0.25);
// sRGB. Behind the edges of the wireframe.
const PLAIN: vec3f = vec3f(0.86, 0.87, 0.89);

// sRGB. `MISSING` without influences, then blue, cyan, green, orange, red for 1, 2, 4, 8, 16.
#influences
fn influence_color(count: f32) -> vec3f {
    var color = mix(MISSING, INFLUENCE_COLORS[0], clamp(count, 0.0, 1.0));
    let doubled = log2(max(count, 1.0));
    color = mix(color, INFLUENCE_COLORS[1], clamp(doubled, 0.0, 1.0));
    color = mix(color, INFLUENCE_COLORS[2], clamp(doubled - 1.0, 0.0, 1.0));
    color = mix(color, INFLUENCE_COLORS[3], clamp(doubled - 2.0, 0.0, 1.0));
    return mix(color, INFLUENCE_COLORS[4], clamp(doubled - 3.0, 0.0, 1.0));
}

// A checker with 16 fields per unit, each with a finer one of 8 × 8.
fn checker(uv: vec2f) -> vec3f {
    let coarse = floor(16.0 * uv);
    let fine = floor(128.0 * uv);
    let is_odd = fract(0.5 * (coarse.x + coarse.y)) > 0.25;
    let is_fine_odd = fract(0.5 * (fine.x + fine.y)) > 0.25;
    let shade = select(0.55, 1.0, is_odd) * select(0.9, 1.0, is_fine_odd);
    return shade * vec3f(fract(uv), 0.6);
}

@fragment
fn channel(at_rest: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let base = base_color(at_rest);
    var in = at_rest;
#if TOON
    in.uv = animated_uv(in.uv);
#endif
    var color = PLAIN;
    switch draw.channel {
        case BASE_COLOR: {
            color = srgb_from_linear(base.rgb);
        }
        case NORMAL: {
            color = 0.5 + 0.5 * surface_normal(in, front);
        }
        case TANGENT: {
            color = MISSING;
            if TANGENTS {
                color = 0.5 + 0.5 * normalize_or_zero(in.tangent.xyz);
            }
        }
        case ROUGHNESS: {
#if TOON
            color = MISSING;
#else
            var roughness = material.roughness;
            if METALLIC_ROUGHNESS_MAP {
                roughness *= metallic_roughness_texel(in.uv).g;
            }
#if GLOSSINESS
            roughness = 1.0 - (1.0 - roughness) * specular_color_texel(in.uv).a;
#endif
            color = vec3f(roughness);
#endif
        }
        case METALLIC: {
#if TOON
            color = MISSING;
#else
            var metallic = material.metallic;
            if METALLIC_ROUGHNESS_MAP {
                metallic *= metallic_roughness_texel(in.uv).b;
            }
            color = vec3f(metallic);
#endif
        }
        case OCCLUSION: {
#if TOON
            color = MISSING;
#else
            var occlusion = 1.0;
            if OCCLUSION_MAP {
                occlusion = 1.0 + material.occlusion_strength * (occlusion_texel(in.uv).r - 1.0);
            }
            color = vec3f(occlusion);
#endif
        }
        case EMISSIVE: {
            color = srgb_from_linear(emissive(in));
        }
        case UV: {
            color = MISSING;
            if UVS {
                color = checker(at_rest.uv.xy);
            }
        }
        case VERTEX_COLOR: {
            color = MISSING;
            if VERTEX_COLORS {
                color = srgb_from_linear(in.color.rgb);
            }
        }
        case INFLUENCES: {
            color = influence_color(in.heat);
        }
        default: {}
    }
    return finish_encoded(clamp(color, vec3f(0.0), vec3f(1.0)), base.a);
}
#endif
