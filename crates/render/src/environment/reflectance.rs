//! How much light a rough surface reflects in total: the table behind image-based specular light.
//!
//! For every roughness and angle of view, the directional albedo of the GGX lobe with height-correlated Smith masking is
//! `specular · x + y` (Schlick's Fresnel split in two: Karis 2013, "Real Shading in Unreal Engine 4"). `light.wgsl` adds
//! what is reflected more than once.

use std::f32::consts::PI;

/// Edge length in texels; must match light.wgsl. Columns are equal steps of √(N·V) and rows of roughness, both 0 to 1.
pub const SIZE: usize = 24;

/// Returns the table, row by row.
pub fn table() -> Vec<[f32; 2]> {
    let step = |index: usize| index as f32 / (SIZE - 1) as f32;
    let texels = (0..SIZE).flat_map(|row| (0..SIZE).map(move |column| (step(row), step(column).powi(2))));
    texels.map(|(roughness, normal_view)| directional_albedo(roughness, normal_view)).collect()
}

/// Integrates over the normals visible to the viewer (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical
/// Caps"), where the integrand is Fresnel times Smith's G2/G1: so smooth that a small grid of points suffices.
fn directional_albedo(roughness: f32, normal_view: f32) -> [f32; 2] {
    const POLAR: usize = 16;
    const AROUND: usize = 8;
    let alpha = roughness * roughness;
    let view_z = normal_view.max(1e-3);
    let view_x = (1.0 - view_z * view_z).max(0.0).sqrt();
    let masking = |cos: f32| 0.5 * ((1.0 + alpha * alpha * (1.0 - cos * cos) / (cos * cos)).sqrt() - 1.0);
    let view_masking = 1.0 + masking(view_z);
    let stretched = (alpha * alpha * view_x * view_x + view_z * view_z).sqrt();
    let (cap_x, cap_z) = (alpha * view_x / stretched, view_z / stretched);
    let (mut scale, mut bias, mut total) = (0.0, 0.0, 0.0);
    for polar in 0..POLAR {
        let t = (polar as f32 + 0.5) / POLAR as f32;
        // Denser towards both ends, where the integrand changes quickest.
        let (u, weight) = (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t));
        total += weight;
        let z = (1.0 - u) * (1.0 + cap_z) - cap_z;
        let ring = (1.0 - z * z).max(0.0).sqrt();
        for around in 0..AROUND {
            // Half a turn: the other half mirrors it.
            let (sin, cos) = (PI * (around as f32 + 0.5) / AROUND as f32).sin_cos();
            let half = [alpha * (ring * cos + cap_x), alpha * ring * sin, (z + cap_z).max(1e-6)];
            let length = half.iter().map(|part| part * part).sum::<f32>().sqrt();
            let (half_x, half_z) = (half[0] / length, half[2] / length);
            let view_half = (view_x * half_x + view_z * half_z).max(0.0);
            let normal_light = 2.0 * view_half * half_z - view_z;
            if normal_light > 0.0 {
                let share = weight * view_masking / (view_masking + masking(normal_light));
                let fresnel = (1.0 - view_half).max(0.0).powi(5);
                scale += share * (1.0 - fresnel);
                bias += share * fresnel;
            }
        }
    }
    [scale, bias].map(|sum| sum / (total * AROUND as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The BRDF times the cosine, integrated over all directions of light in double precision, as an independent
    /// reference. Returns scale and bias for N·V.
    fn integrated(roughness: f64, normal_view: f64) -> [f64; 2] {
        const STEPS: usize = 1200;
        let alpha2 = roughness.powi(4);
        let view = [(1.0 - normal_view * normal_view).sqrt(), normal_view];
        let mut sums = [0.0; 2];
        for polar in 0..STEPS {
            // Polar angle of the half vector, by GGX's distribution, with steps that become short at grazing angles.
            let t = (polar as f64 + 0.5) / STEPS as f64;
            let (u, weight) = (1.0 - (1.0 - t).powi(4), 4.0 * (1.0 - t).powi(3));
            let cos = ((1.0 - u) / (1.0 + (alpha2 - 1.0) * u)).sqrt();
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            for around in 0..STEPS / 8 {
                let angle = std::f64::consts::PI * (around as f64 + 0.5) / (STEPS / 8) as f64;
                let view_half = view[0] * sin * angle.cos() + view[1] * cos;
                let normal_light = 2.0 * view_half * cos - normal_view;
                if view_half <= 0.0 || normal_light <= 0.0 {
                    continue;
                }
                let smith = |a: f64, b: f64| a * (b * b * (1.0 - alpha2) + alpha2).sqrt();
                let visibility = 0.5 / (smith(normal_light, normal_view) + smith(normal_view, normal_light));
                let share = weight * visibility * 4.0 * normal_light * view_half / cos;
                let fresnel = (1.0 - view_half).powi(5);
                sums[0] += share * (1.0 - fresnel);
                sums[1] += share * fresnel;
            }
        }
        sums.map(|sum| sum / (STEPS * (STEPS / 8)) as f64)
    }

    /// What light.wgsl reads from the table.
    fn looked_up(table: &[[f32; 2]], roughness: f32, normal_view: f32) -> [f32; 2] {
        let at = [normal_view.sqrt(), roughness].map(|value| value * (SIZE - 1) as f32);
        let [x, y] = at.map(|value| (value as usize).min(SIZE - 2));
        let [right, down] = [at[0] - x as f32, at[1] - y as f32];
        let mix = |a: [f32; 2], b: [f32; 2], share: f32| [0, 1].map(|i| a[i] + (b[i] - a[i]) * share);
        let row = |y: usize| mix(table[y * SIZE + x], table[y * SIZE + x + 1], right);
        mix(row(y), row(y + 1), down)
    }

    /// `environment_reflectance` of light.wgsl.
    fn reflectance(specular: f32, [scale, bias]: [f32; 2], roughness: f32, normal_view: f32) -> f32 {
        let grazing = (1.0 - roughness).max(specular) - specular;
        let once = (specular + grazing * (1.0 - normal_view).powi(5)) * scale + bias;
        let lost = 1.0 - scale - bias;
        let average = specular + (1.0 - specular) / 21.0;
        once + once * average * lost / (1.0 - average * lost)
    }

    const ROUGHNESSES: [f32; 8] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0];
    const COSINES: [f32; 7] = [0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0];

    #[test]
    fn the_table_is_the_integral_of_the_lobe() {
        let table = table();
        let mut sum = 0.0;
        for roughness in ROUGHNESSES {
            for normal_view in COSINES {
                let exact = integrated(f64::from(roughness), f64::from(normal_view)).map(|value| value as f32);
                let found = looked_up(&table, roughness, normal_view);
                let error = (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
                assert!(error < 0.008, "roughness {roughness}, N·V {normal_view}: {found:?} instead of {exact:?}");
                sum += error;
            }
        }
        let mean = sum / (ROUGHNESSES.len() * COSINES.len()) as f32;
        assert!(mean < 0.0025, "{mean}");
        let [_, grazing] = looked_up(&table, 0.2, 0.2);
        assert!((grazing - 0.297).abs() < 0.002, "{grazing}");
    }

    #[test]
    fn white_reflects_everything_and_nothing_reflects_more() {
        let table = table();
        for roughness in ROUGHNESSES {
            for normal_view in COSINES {
                let albedo = looked_up(&table, roughness, normal_view);
                assert!(albedo[0] + albedo[1] <= 1.0005, "roughness {roughness}, N·V {normal_view}: {albedo:?}");
                let white = reflectance(1.0, albedo, roughness, normal_view);
                assert!((white - 1.0).abs() < 1e-5, "roughness {roughness}, N·V {normal_view}: {white}");
                let mut darker = 0.0;
                for specular in [0.0, 0.04, 0.2, 0.5, 0.9] {
                    let reflected = reflectance(specular, albedo, roughness, normal_view);
                    assert!(
                        (darker..=1.0005).contains(&reflected),
                        "{specular} {roughness} {normal_view}: {reflected}"
                    );
                    darker = reflected;
                }
            }
        }
    }
}
