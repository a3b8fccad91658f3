// Khronos PBR Neutral tone mapping and sRGB encoding. Both run in the surface shaders, so blending happens on encoded
// values (as in three.js), edges next to bright light stay smooth, and no full-screen pass is needed.

const TONE_START: f32 = 0.76;
const TONE_DESATURATION: f32 = 0.15;
const TONE_RANGE: f32 = 0.24;

fn tone_map(scene: vec3f) -> vec3f {
    let darkest = min(scene.r, min(scene.g, scene.b));
    let offset = select(0.04, darkest - 6.25 * darkest * darkest, darkest < 0.08);
    let color = scene - offset;
    let peak = max(color.r, max(color.g, color.b));
    if peak < TONE_START {
        return color;
    }
    let new_peak = 1.0 - TONE_RANGE * TONE_RANGE / (peak + TONE_RANGE - TONE_START);
    let gray = 1.0 - 1.0 / (TONE_DESATURATION * (peak - new_peak) + 1.0);
    return mix(color * (new_peak / peak), vec3f(new_peak), gray);
}

fn srgb_from_linear(linear: vec3f) -> vec3f {
    let color = clamp(linear, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(color, vec3f(1.0 / 2.4)) - 0.055, 12.92 * color, color <= vec3f(0.0031308));
}
