//! The lobes' formulas in `shaders/`, integrated over the hemisphere: no lobe adds energy, and every BRDF is
//! reciprocal. The functions here follow the shaders line by line.

use std::f64::consts::PI;

use glam::DVec3;

const ROUGHNESSES: [f64; 5] = [0.1, 0.25, 0.5, 0.75, 1.0];
const COSINES: [f64; 5] = [0.05, 0.2, 0.5, 0.8, 1.0];

/// A direction in tangent space.
fn direction(cosine: f64, turn: f64) -> DVec3 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    DVec3::new(sine * turn.cos(), sine * turn.sin(), cosine)
}

/// The integral of a BRDF times the cosine over all directions of light.
fn integrate(brdf: impl Fn(DVec3) -> f64) -> f64 {
    const POLAR: usize = 400;
    const AROUND: usize = 200;
    let mut sum = 0.0;
    for polar in 0..POLAR {
        // Denser towards grazing angles and towards the normal.
        let t = (polar as f64 + 0.5) / POLAR as f64;
        let (cosine, weight) = (0.5 - 0.5 * (PI * t).cos(), 0.5 * PI * (PI * t).sin());
        for around in 0..AROUND {
            let light = direction(cosine, 2.0 * PI * (around as f64 + 0.5) / AROUND as f64);
            sum += weight * cosine * brdf(light);
        }
    }
    sum * 2.0 * PI / (POLAR * AROUND) as f64
}

/// `brdf` takes the directions to the viewer and to the light.
#[track_caller]
fn check_reciprocal(brdf: impl Fn(DVec3, DVec3) -> f64) {
    for (a, b) in [(0.2, 0.9), (0.5, 0.6), (0.05, 0.4)] {
        for turn in [0.3, 1.9, 3.0] {
            let (view, light) = (direction(a, 0.4), direction(b, turn));
            let [there, back] = [brdf(view, light), brdf(light, view)];
            assert!((there - back).abs() < 1e-9 * there.abs().max(1.0), "{view} {light}: {there}, back {back}");
        }
    }
}

fn schlick(cosine: f64) -> f64 {
    (1.0 - cosine).powi(5)
}

/// As in brdf.wgsl, without its clamping.
fn ggx(roughness: f64, half: DVec3, light: DVec3, view: DVec3) -> f64 {
    let alpha_squared = roughness.powi(4);
    let f = half.z * half.z * (alpha_squared - 1.0) + 1.0;
    let masked = |a: f64, b: f64| b * (a * a * (1.0 - alpha_squared) + alpha_squared).sqrt();
    alpha_squared / (PI * f * f) * 0.5 / (masked(light.z, view.z) + masked(view.z, light.z))
}

/// As in anisotropy.wgsl, without its clamping.
fn anisotropic_ggx(roughness: f64, anisotropy: f64, half: DVec3, light: DVec3, view: DVec3) -> f64 {
    let alpha = roughness * roughness;
    let along = alpha + (1.0 - alpha) * anisotropy * anisotropy;
    let product = along * alpha;
    let h = DVec3::new(alpha * half.x, along * half.y, product * half.z);
    let spread = product / h.dot(h);
    let scale = DVec3::new(along, alpha, 1.0);
    let masked = light.z * (scale * view).length() + view.z * (scale * light).length();
    product * spread * spread / PI * 0.5 / masked
}

#[test]
fn highlights_conserve_energy_and_are_reciprocal() {
    for roughness in ROUGHNESSES {
        for anisotropy in [0.0, 0.5, 1.0] {
            let brdf = |view: DVec3, light: DVec3| {
                anisotropic_ggx(roughness, anisotropy, (view + light).normalize(), light, view)
            };
            check_reciprocal(brdf);
            // Smoother lobes are narrower than the steps of the integral.
            for view in COSINES.map(|cosine| direction(cosine, 0.7)).into_iter().filter(|_| roughness > 0.2) {
                let reflected = integrate(|light| brdf(view, light));
                assert!((0.3..=1.002).contains(&reflected), "{roughness} {anisotropy} {view}: {reflected}");
            }
        }
        for (view, light) in [(0.3, 0.8), (0.9, 0.5)].map(|(a, b)| (direction(a, 0.2), direction(b, 2.0))) {
            let half = (view + light).normalize();
            let [plain, stretched] =
                [ggx(roughness, half, light, view), anisotropic_ggx(roughness, 0.0, half, light, view)];
            assert!((plain - stretched).abs() < 1e-9 * plain.max(1.0), "{roughness}: {plain} and {stretched}");
        }
    }
}

/// As in sheen.wgsl.
fn charlie_fit(x: f64, alpha: f64) -> f64 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |a: f64, b: f64| a + (b - a) * t;
    let (a, b, c) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801));
    let (d, e) = (mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    a / (1.0 + b * x.powf(c)) + d * x + e
}

/// As in sheen.wgsl.
fn charlie_masking(cosine: f64, alpha: f64) -> f64 {
    let near = charlie_fit(cosine.min(1.0 - cosine), alpha);
    if cosine >= 0.5 { (2.0 * charlie_fit(0.5, alpha) - near).exp() } else { near.exp() }
}

/// As in sheen.wgsl.
fn sheen_albedo(roughness: f64, cosine: f64) -> f64 {
    let powers = [roughness, roughness * roughness, 1.0 / roughness, 1.0 / (roughness * roughness)];
    let dot = |factors: [f64; 4]| factors.iter().zip(powers).map(|(a, b)| a * b).sum::<f64>();
    let a = dot([0.8964, -0.2046, 0.2439, -0.009195]) - 1.148;
    let b = dot([0.4373, -0.8, -1.556, 0.0502]) + 0.268;
    let c = dot([14.22, -6.291, 2.869, -0.2906]) - 10.52;
    (a + cosine * (b + cosine * c)).exp().min(1.0)
}

/// Only the fibres: `sheen_light` of sheen.wgsl over black, divided by the cosine.
fn sheen(roughness: f64, view: DVec3, light: DVec3) -> f64 {
    let alpha = roughness * roughness;
    let half = (view + light).normalize().z;
    let distribution = (2.0 + 1.0 / alpha) * (1.0 - half * half).max(1e-6).powf(0.5 / alpha) / (2.0 * PI);
    let masking = 1.0 + charlie_masking(view.z, alpha) + charlie_masking(light.z, alpha);
    distribution * (1.0 / (masking * 4.0 * view.z * light.z)).min(1.0)
}

#[test]
fn the_albedo_of_sheen_is_the_integral_of_its_lobe() {
    let (mut sum, mut count) = (0.0, 0.0);
    for roughness in [0.1, 0.2, 0.3, 0.5, 0.7, 0.85, 1.0] {
        check_reciprocal(|view, light| sheen(roughness, view, light));
        for cosine in [0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0] {
            let exact = integrate(|light| sheen(roughness, direction(cosine, 0.0), light));
            let error = (sheen_albedo(roughness, cosine) - exact).abs();
            assert!(error < 0.025, "roughness {roughness}, N·V {cosine}: off by {error} from {exact}");
            (sum, count) = (sum + error, count + 1.0);
        }
    }
    assert!(sum / count < 0.008, "{}", sum / count);
}

/// White fibres over a white matte surface, combined as by `sheen_light`.
#[test]
fn sheen_attenuates_what_is_below_it() {
    for roughness in [0.2, 0.4, 0.7, 1.0] {
        let both = |view: DVec3, light: DVec3| {
            let albedo = sheen_albedo(roughness, view.z).max(sheen_albedo(roughness, light.z.max(0.001)));
            (1.0 - albedo) / PI + sheen(roughness, view, light)
        };
        check_reciprocal(both);
        for cosine in COSINES {
            let view = direction(cosine, 0.0);
            let [alone, reflected] =
                [integrate(|light| sheen(roughness, view, light)), integrate(|light| both(view, light))];
            // At grazing angles the extension's lobe itself reflects up to 3 % more than it receives.
            let allowed = alone.max(1.0) + 0.03;
            assert!((0.5..=allowed).contains(&reflected), "{roughness} {cosine}: {reflected}");
        }
    }
}

/// A clear coat over white, combined as by `reflect_light` of brdf.wgsl.
#[test]
fn a_coat_attenuates_what_is_below_it() {
    for roughness in [0.3, 0.6, 1.0] {
        let coat = |view: DVec3| 0.04 + 0.96 * schlick(view.z);
        for cosine in COSINES {
            let view = direction(cosine, 0.0);
            let reflected = integrate(|light| {
                let lobe = ggx(roughness, (view + light).normalize(), light, view);
                (1.0 - coat(view)) / PI + coat(view) * lobe
            });
            assert!((0.4..=1.002).contains(&reflected), "{roughness} {cosine}: {reflected}");
        }
    }
}

/// Light that isn't reflected is shared between diffuse reflection, diffuse transmission and refraction. In glTF's core
/// model, diffuse and specular reflection together already exceed 1 at grazing angles; the lobes must not add to that.
#[test]
fn transmissive_surfaces_return_no_more_light_than_opaque_ones() {
    let returned = |view: DVec3, diffuse_transmission: f64, transmission: f64| {
        let half = |light: DVec3| (view + light).normalize();
        let fresnel = |light: DVec3| 0.04 + 0.96 * schlick(view.dot(half(light)));
        let front = integrate(|light| {
            let diffuse = (1.0 - transmission) * (1.0 - diffuse_transmission) / PI;
            (1.0 - fresnel(light)) * diffuse + fresnel(light) * ggx(0.5, half(light), light, view)
        });
        // Light from behind is mirrored to the front.
        let back = integrate(|light| {
            let diffuse = (1.0 - transmission) * diffuse_transmission / PI;
            (1.0 - fresnel(light)) * (diffuse + transmission * ggx(0.5, half(light), light, view))
        });
        front + back
    };
    for view in COSINES.map(|cosine| direction(cosine, 0.0)) {
        let opaque = returned(view, 0.0, 0.0);
        for (diffuse_transmission, transmission) in [(0.0, 1.0), (1.0, 0.0), (0.4, 0.7), (1.0, 1.0)] {
            let found = returned(view, diffuse_transmission, transmission);
            assert!((0.5..=opaque.max(1.0) + 1e-6).contains(&found), "{view} {transmission}: {found}, opaque {opaque}");
        }
    }
}

/// As in iridescence.wgsl.
fn interference(path_nanometres: f64, shift: DVec3) -> DVec3 {
    let phase = 2.0 * PI * path_nanometres * 1e-9;
    let squared = phase * phase;
    let cosine = (DVec3::new(1.6810e6, 1.7953e6, 2.2084e6) * phase + shift).to_array().map(f64::cos);
    let fading = (-squared * DVec3::new(4.3278e9, 9.3046e9, 6.6121e9)).exp();
    let mut xyz = DVec3::new(0.84659, 1.00022, 1.00112) * DVec3::from(cosine) * fading;
    xyz.x += 0.153869 * (2.2399e6 * phase + shift.x).cos() * (-4.5282e9 * squared).exp();
    DVec3::new(
        3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
        -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
        0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z,
    )
}

/// As in iridescence.wgsl for a grey base, without the final clamping.
fn film_reflectance(film_ior: f64, cosine: f64, nanometres: f64, base: f64) -> DVec3 {
    let between = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    let t = (nanometres / 0.03).clamp(0.0, 1.0);
    let ior = 1.0 + (film_ior - 1.0) * t * t * (3.0 - 2.0 * t);
    let inside = (1.0 - (1.0 - cosine * cosine) / (ior * ior)).max(0.0).sqrt();
    let fresnel = |normal: f64, cosine: f64| normal + (1.0 - normal) * schlick(cosine);
    let top = fresnel(between(ior, 1.0), cosine);
    let root = base.min(0.9999).sqrt();
    let base_ior = (1.0 + root) / (1.0 - root);
    let bottom = fresnel(between(base_ior, ior), inside);
    let shift = DVec3::splat(if base_ior < ior { 2.0 * PI } else { PI });
    let both = (top * bottom).clamp(1e-5, 0.9999);
    let repeated = (1.0 - top).powi(2) * bottom / (1.0 - both);
    let (mut sum, mut order) = (DVec3::splat(top + repeated), repeated - (1.0 - top));
    for m in [1.0, 2.0] {
        order *= both.sqrt();
        sum += 2.0 * order * interference(m * 2.0 * ior * nanometres * inside, m * shift);
    }
    sum
}

#[test]
fn a_thin_film_colours_reflections_without_adding_light() {
    let luminance = |color: DVec3| color.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    for base in [0.04, 0.3, 0.9] {
        for cosine in COSINES {
            // A film of no thickness leaves only the base. At grazing angles the model counts both surfaces.
            let plain = base + (1.0 - base) * schlick(cosine);
            let found = film_reflectance(1.3, cosine, 0.0, base);
            let is_close = (luminance(found) - plain).abs() < 0.03;
            assert!(is_close || cosine < 0.8, "{base} {cosine}: {found} instead of {plain}");
            for nanometres in [100.0, 250.0, 400.0, 700.0, 1200.0] {
                let found = film_reflectance(1.3, cosine, nanometres, base);
                // Saturated colours lie outside Rec. 709, so the shader clamps each channel.
                assert!((-0.05..=1.02).contains(&luminance(found)), "{base} {cosine} {nanometres}: {found}");
            }
        }
    }
    let colors = [250.0, 400.0].map(|nanometres| film_reflectance(1.8, 0.9, nanometres, 0.04));
    assert!(colors.iter().all(|color| color.max_element() > 1.3 * color.min_element()), "{colors:?}");
    // The film's index of refraction matches the base's, so nothing interferes and the film disappears.
    let [thin, thick] = [0.0, 5000.0].map(|nanometres| luminance(film_reflectance(1.5, 0.8, nanometres, 0.04)));
    assert!((thin - thick).abs() < 0.02, "{thin} {thick}");
}
