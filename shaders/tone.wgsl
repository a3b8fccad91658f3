// Tone mapping and sRGB encoding. Both run in the shaders that draw surfaces and sky, so blending happens on encoded
// values (as in three.js), edges next to bright light stay smooth, and no full-screen pass is needed.

// 0 Khronos Neutral, 1 ACES, 2 AgX, 3 none.
override TONE_MAP: u32 = 0u;

fn tone_map(scene: vec3f) -> vec3f {
    if TONE_MAP == 1u {
        return aces(scene);
    } else if TONE_MAP == 2u {
        return agx(scene);
    } else if TONE_MAP == 3u {
        return scene;
    }
    return neutral(scene);
}

const TONE_START: f32 = 0.76;
const TONE_DESATURATION: f32 = 0.15;
const TONE_RANGE: f32 = 0.24;

// Khronos PBR Neutral (https://github.com/KhronosGroup/ToneMapping).
fn neutral(scene: vec3f) -> vec3f {
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

// Hill's fit of the ACES reference and output transforms, brightened by 1/0.6, as in three.js (ACESFilmicToneMapping) and the
// Khronos viewer (ACES Hill, exposure boost): https://github.com/TheRealMJP/BakingLab/blob/master/BakingLab/ACES.hlsl
fn aces(scene: vec3f) -> vec3f {
    let fit_from_srgb = mat3x3f(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    let srgb_from_fit = mat3x3f(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    let v = fit_from_srgb * (scene / 0.6);
    let fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return srgb_from_fit * fitted;
}

// AgX (Troy Sobotka) as in Blender 4, in Rec. 2020, with a polynomial for its curve, as in Filament and three.js
// (AgXToneMapping): https://github.com/google/filament/pull/7236
fn agx(scene: vec3f) -> vec3f {
    let rec2020_from_srgb = mat3x3f(0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956);
    let srgb_from_rec2020 = mat3x3f(1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187);
    let inset = mat3x3f(
        0.856627153, 0.137318973, 0.111898213, 0.095121241, 0.761241991, 0.076799419, 0.048251606, 0.101439036, 0.811302368);
    let outset = mat3x3f(
        1.127100582, -0.141329763, -0.141329763, -0.110606643, 1.157823702, -0.110606643, -0.016493939, -0.016493939, 1.251936407);
    // From 10 stops below middle grey to 6.5 above.
    let stops = log2(max(inset * (rec2020_from_srgb * scene), vec3f(1e-10)));
    let x = clamp((stops + 12.47393) / 16.5, vec3f(0.0), vec3f(1.0));
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    return srgb_from_rec2020 * pow(max(outset * curve, vec3f(0.0)), vec3f(2.2));
}

fn srgb_from_linear(linear: vec3f) -> vec3f {
    let color = clamp(linear, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(color, vec3f(1.0 / 2.4)) - 0.055, 12.92 * color, color <= vec3f(0.0031308));
}
