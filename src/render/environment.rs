//! The studio environment: procedural soft boxes, prefiltered by roughness into a small cube map, with diffuse light as
//! nine spherical harmonics. Computed on the CPU in a few milliseconds, so nothing is downloaded.

use glam::{Vec2, Vec3};

/// Edge length of the sharpest level in texels.
const SIZE: u32 = 64;
/// Roughness 0 to 1 in equal steps; must match light.wgsl.
const LEVELS: u32 = 6;

/// Direction to the key light without environment rotation: front left, above.
pub const KEY_DIRECTION: Vec3 = Vec3::new(-0.48, 0.72, 0.50);
pub const KEY_COLOR: Vec3 = Vec3::new(1.75, 1.68, 1.58);

/// A soft-edged lamp at infinity.
struct SoftBox {
    direction: Vec3,
    right: Vec3,
    up: Vec3,
    /// Half the size at unit distance.
    half_size: Vec2,
    color: Vec3,
}

impl SoftBox {
    fn new(direction: Vec3, half_size: Vec2, color: Vec3) -> Self {
        let direction = direction.normalize_or_zero();
        let right = Vec3::Y.cross(direction).try_normalize().unwrap_or(Vec3::X);
        Self { direction, right, up: direction.cross(right), half_size, color }
    }

    fn radiance(&self, direction: Vec3) -> Vec3 {
        let facing = direction.dot(self.direction);
        if facing <= 0.05 {
            return Vec3::ZERO;
        }
        let at = Vec2::new(direction.dot(self.right), direction.dot(self.up)) / facing;
        let edge =
            ((self.half_size - at.abs()) / (0.12 * self.half_size.min_element()) + 0.5).clamp(Vec2::ZERO, Vec2::ONE);
        let edge = edge * edge * (3.0 - 2.0 * edge);
        self.color * (edge.x * edge.y)
    }
}

struct Studio {
    boxes: [SoftBox; 5],
}

impl Studio {
    fn new() -> Self {
        let gray = Vec3::ONE;
        Self {
            boxes: [
                // Key, above left.
                SoftBox::new(KEY_DIRECTION, Vec2::new(0.55, 0.55), gray * 2.6),
                // Fill, large and weak, right.
                SoftBox::new(Vec3::new(0.9, 0.25, 0.5), Vec2::new(0.7, 1.0), Vec3::new(0.95, 1.0, 1.06) * 0.9),
                // Rims, behind on both sides.
                SoftBox::new(Vec3::new(-0.75, 0.35, -0.75), Vec2::new(0.22, 1.2), Vec3::new(0.9, 0.97, 1.1) * 4.5),
                SoftBox::new(Vec3::new(0.7, 0.45, -0.8), Vec2::new(0.25, 1.2), Vec3::new(1.0, 0.98, 0.95) * 5.0),
                // Ceiling.
                SoftBox::new(Vec3::new(0.05, 1.0, 0.0), Vec2::new(0.8, 0.8), gray * 1.2),
            ],
        }
    }

    /// Linear radiance from a unit direction.
    fn radiance(&self, direction: Vec3) -> Vec3 {
        let floor = Vec3::new(0.16, 0.155, 0.15);
        let horizon = Vec3::new(0.26, 0.27, 0.29);
        let zenith = Vec3::new(0.32, 0.34, 0.38);
        let height = direction.y;
        let walls =
            if height > 0.0 { horizon.lerp(zenith, height) } else { horizon.lerp(floor, (-3.0 * height).min(1.0)) };
        self.boxes.iter().fold(walls, |sum, soft_box| sum + soft_box.radiance(direction))
    }
}

pub(super) struct Environment {
    pub view: wgpu::TextureView,
    pub sampler: wgpu::Sampler,
    /// Irradiance coefficients divided by π, in the order of light.wgsl.
    pub irradiance: [[f32; 4]; 9],
}

impl Environment {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let studio = Studio::new();
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("environment"),
            size: wgpu::Extent3d { width: SIZE, height: SIZE, depth_or_array_layers: 6 },
            mip_level_count: LEVELS,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let mut texels = Vec::with_capacity((SIZE * SIZE * 4) as usize);
        for level in 0..LEVELS {
            let size = SIZE >> level;
            let lobe = Lobe::new(level as f32 / (LEVELS - 1) as f32, if level < 3 { 24 } else { 64 });
            for face in 0..6 {
                texels.clear();
                for y in 0..size {
                    for x in 0..size {
                        let at = (Vec2::new(x as f32, y as f32) + 0.5) / size as f32 * 2.0 - 1.0;
                        let color = lobe.blur(&studio, cube_direction(face, at));
                        texels.extend([color.x, color.y, color.z, 1.0].map(half_from_float));
                    }
                }
                queue.write_texture(
                    wgpu::TexelCopyTextureInfo {
                        texture: &texture,
                        mip_level: level,
                        origin: wgpu::Origin3d { x: 0, y: 0, z: face },
                        aspect: wgpu::TextureAspect::All,
                    },
                    bytemuck::cast_slice(&texels),
                    wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(8 * size),
                        rows_per_image: Some(size),
                    },
                    wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
                );
            }
        }
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::Cube),
            ..Default::default()
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("environment"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        Self { view, sampler, irradiance: irradiance(&studio) }
    }
}

/// Direction of a texel of a cube face; `at` runs from −1 to 1, right and down.
fn cube_direction(face: u32, at: Vec2) -> Vec3 {
    let direction = match face {
        0 => Vec3::new(1.0, -at.y, -at.x),
        1 => Vec3::new(-1.0, -at.y, at.x),
        2 => Vec3::new(at.x, 1.0, at.y),
        3 => Vec3::new(at.x, -1.0, -at.y),
        4 => Vec3::new(at.x, -at.y, 1.0),
        _ => Vec3::new(-at.x, -at.y, -1.0),
    };
    direction.normalize_or_zero()
}

/// Weighted sample directions around +Z of the reflection lobe for some roughness.
struct Lobe {
    samples: Vec<(Vec3, f32)>,
}

impl Lobe {
    /// Importance-samples GGX for a view along the normal (Karis 2013, "Real Shading in Unreal Engine 4").
    fn new(roughness: f32, count: u32) -> Self {
        if roughness == 0.0 {
            return Self { samples: vec![(Vec3::Z, 1.0)] };
        }
        let alpha = roughness * roughness;
        let mut samples = Vec::new();
        for index in 0..count {
            let u = (index as f32 + 0.5) / count as f32;
            let cos_squared = (1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u);
            let (cos, sin) = (cos_squared.sqrt(), (1.0 - cos_squared).max(0.0).sqrt());
            // The golden angle distributes samples evenly.
            let (turn_sin, turn_cos) = (2.399_963_2 * index as f32).sin_cos();
            let half_way = Vec3::new(sin * turn_cos, sin * turn_sin, cos);
            let reflected = 2.0 * half_way.z * half_way - Vec3::Z;
            if reflected.z > 0.0 {
                samples.push((reflected, reflected.z));
            }
        }
        let sum: f32 = samples.iter().map(|(_, weight)| weight).sum();
        for (_, weight) in &mut samples {
            *weight /= sum;
        }
        Self { samples }
    }

    fn blur(&self, studio: &Studio, normal: Vec3) -> Vec3 {
        let (x, y) = normal.any_orthonormal_pair();
        self.samples.iter().fold(Vec3::ZERO, |sum, (sample, weight)| {
            sum + *weight * studio.radiance(x * sample.x + y * sample.y + normal * sample.z)
        })
    }
}

/// Projects the studio's irradiance to spherical harmonics (Ramamoorthi and Hanrahan 2001), with all constants folded in.
fn irradiance(studio: &Studio) -> [[f32; 4]; 9] {
    const COUNT: u32 = 2048;
    // Squared basis constant, times the cosine lobe's factor (π, 2π/3, π/4) over π.
    const FACTORS: [f32; 9] = [
        0.282_095 * 0.282_095,
        0.488_603 * 0.488_603 * 2.0 / 3.0,
        0.488_603 * 0.488_603 * 2.0 / 3.0,
        0.488_603 * 0.488_603 * 2.0 / 3.0,
        1.092_548 * 1.092_548 / 4.0,
        1.092_548 * 1.092_548 / 4.0,
        0.315_392 * 0.315_392 / 4.0,
        1.092_548 * 1.092_548 / 4.0,
        0.546_274 * 0.546_274 / 4.0,
    ];
    let mut sums = [Vec3::ZERO; 9];
    for index in 0..COUNT {
        let y = 1.0 - 2.0 * (index as f32 + 0.5) / COUNT as f32;
        let (sin, cos) = (2.399_963_2 * index as f32).sin_cos();
        let ring = (1.0 - y * y).sqrt();
        let n = Vec3::new(ring * cos, y, ring * sin);
        let light = studio.radiance(n);
        let basis = [1.0, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0 * n.z * n.z - 1.0, n.x * n.z, n.x * n.x - n.y * n.y];
        for (sum, basis) in sums.iter_mut().zip(basis) {
            *sum += basis * light;
        }
    }
    let solid_angle = 4.0 * std::f32::consts::PI / COUNT as f32;
    std::array::from_fn(|index| (sums[index] * (FACTORS[index] * solid_angle)).extend(0.0).to_array())
}

/// Converts a finite number from 0 to 65,504 to half-precision bits, flushing subnormals to 0.
fn half_from_float(value: f32) -> u16 {
    let bits = value.clamp(0.0, 65_504.0).to_bits() + 0x1000;
    let exponent = (bits >> 23) as i32 - 127 + 15;
    if exponent <= 0 { 0 } else { ((exponent as u16) << 10) | ((bits >> 13) & 0x3ff) as u16 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_floats_keep_eleven_bits() {
        for (value, bits) in [(0.0, 0), (1.0, 0x3c00), (0.5, 0x3800), (2.0, 0x4000), (1.5, 0x3e00), (65_504.0, 0x7bff)]
        {
            assert_eq!(half_from_float(value), bits, "{value}");
        }
    }

    #[test]
    fn irradiance_matches_the_studio_integrated_over_a_cosine_lobe() {
        let studio = Studio::new();
        let coefficients = irradiance(&studio);
        for normal in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::Z, Vec3::new(-0.6, 0.0, 0.8)] {
            let n = normal;
            let basis =
                [1.0, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0 * n.z * n.z - 1.0, n.x * n.z, n.x * n.x - n.y * n.y];
            let shown: f32 = coefficients.iter().zip(basis).map(|(c, b)| c[1] * b).sum();
            let lobe = Lobe::new(1.0, 4096);
            // At roughness 1 the lobe is almost the cosine lobe.
            let expected = lobe.blur(&studio, normal).y;
            assert!((shown - expected).abs() < 0.25 * expected, "{normal}: {shown} instead of {expected}");
        }
    }
}
