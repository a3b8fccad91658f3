//! A cube map on the CPU: radiance from all directions, its mip levels, and the filtered levels for rough reflections.

use glam::{Vec2, Vec3, Vec4};

/// Edge length of an irradiance face, small because irradiance is smooth.
const IRRADIANCE_SIZE: usize = 16;

/// One mip level. Every face has a border of one texel from its neighbours, so that filtering is seamless.
struct Level {
    size: usize,
    texels: Vec<Vec4>,
}

/// Radiance from all directions, from sharp to 4 × 4 texels a face.
pub(super) struct Cube {
    levels: Vec<Level>,
}

/// Returns the direction of a point of a cube face; `at` runs from −1 to 1, right and down. Not normalized.
fn on_face(face: usize, at: Vec2) -> Vec3 {
    match face {
        0 => Vec3::new(1.0, -at.y, -at.x),
        1 => Vec3::new(-1.0, -at.y, at.x),
        2 => Vec3::new(at.x, 1.0, at.y),
        3 => Vec3::new(at.x, -1.0, -at.y),
        4 => Vec3::new(at.x, -at.y, 1.0),
        _ => Vec3::new(-at.x, -at.y, -1.0),
    }
}

/// Inverts [`on_face`]. Inlined like [`Level::sample`]: both run half a million times before the first picture.
#[inline(always)]
fn face_of(direction: Vec3) -> (usize, Vec2) {
    let Vec3 { x, y, z } = direction;
    let size = direction.abs();
    if size.x >= size.y && size.x >= size.z {
        if x > 0.0 { (0, Vec2::new(-z, -y) / size.x) } else { (1, Vec2::new(z, -y) / size.x) }
    } else if size.y >= size.z {
        if y > 0.0 { (2, Vec2::new(x, z) / size.y) } else { (3, Vec2::new(x, -z) / size.y) }
    } else if z > 0.0 {
        (4, Vec2::new(x, -y) / size.z)
    } else {
        (5, Vec2::new(-x, -y) / size.z)
    }
}

/// Center of a texel, −1 to 1 inside a face.
fn center(size: usize, x: usize, y: usize) -> Vec2 {
    (Vec2::new(x as f32, y as f32) + 0.5) * (2.0 / size as f32) - 1.0
}

/// Returns the directions to the texels of all faces, not normalized.
fn directions(size: usize) -> impl Iterator<Item = Vec3> {
    (0..6 * size * size).map(move |texel| {
        let (face, on) = (texel / (size * size), texel % (size * size));
        on_face(face, center(size, on % size, on / size))
    })
}

impl Level {
    /// `texel` gets the face and the column and row on it.
    fn new(size: usize, mut texel: impl FnMut(usize, usize, usize) -> Vec4) -> Self {
        let mut level = Self { size, texels: vec![Vec4::ZERO; 6 * (size + 2) * (size + 2)] };
        for face in 0..6 {
            for y in 0..size {
                for x in 0..size {
                    let index = level.index(face, x + 1, y + 1);
                    level.texels[index] = texel(face, x, y);
                }
            }
        }
        level.fill_borders();
        level
    }

    /// Counts columns and rows from the border.
    fn index(&self, face: usize, x: usize, y: usize) -> usize {
        let edge = self.size + 2;
        (face * edge + y) * edge + x
    }

    fn fill_borders(&mut self) {
        let last = self.size + 1;
        for face in 0..6 {
            for step in 0..=last {
                for (x, y) in [(step, 0), (step, last), (0, step), (last, step)] {
                    let at = (Vec2::new(x as f32, y as f32) - 0.5) * (2.0 / self.size as f32) - 1.0;
                    let (other, at) = face_of(on_face(face, at));
                    let nearest =
                        |at: f32| 1 + ((0.5 * at + 0.5) * self.size as f32).clamp(0.0, self.size as f32 - 1.0) as usize;
                    let (index, source) = (self.index(face, x, y), self.index(other, nearest(at.x), nearest(at.y)));
                    self.texels[index] = self.texels[source];
                }
            }
        }
    }

    /// The texels without the borders, face by face.
    fn inside(&self) -> Vec<Vec3> {
        let rows = (0..6 * self.size).map(|row| self.index(row / self.size, 1, 1 + row % self.size));
        rows.flat_map(|first| &self.texels[first..first + self.size]).map(|texel| texel.truncate()).collect()
    }

    /// Filters four texels.
    #[inline(always)]
    fn sample(&self, direction: Vec3) -> Vec4 {
        let (face, at) = face_of(direction);
        let at = (0.5 * at + 0.5) * self.size as f32 + 0.5;
        let (x, y) = ((at.x as usize).min(self.size), (at.y as usize).min(self.size));
        let (right, down) = (at.x - x as f32, at.y - y as f32);
        let first = self.index(face, x, y);
        let next = first + self.size + 2;
        let upper = self.texels[first].lerp(self.texels[first + 1], right);
        upper.lerp(self.texels[next].lerp(self.texels[next + 1], right), down)
    }
}

impl Cube {
    /// `size` is the edge length of a face, a power of two from 4.
    pub fn new(size: usize, radiance: impl Fn(Vec3) -> Vec3) -> Self {
        let direction = |face, x, y| on_face(face, center(size, x, y)).normalize_or_zero();
        let mut levels = vec![Level::new(size, |face, x, y| radiance(direction(face, x, y)).extend(1.0))];
        while let Some(above) = levels.last().filter(|level| level.size > 4) {
            let size = above.size / 2;
            let average = |face, x: usize, y: usize| {
                let texel = |right, down| above.texels[above.index(face, 2 * x + 1 + right, 2 * y + 1 + down)];
                0.25 * (texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1))
            };
            levels.push(Level::new(size, average));
        }
        Self { levels }
    }

    /// Leaves out the sharpest level.
    pub fn halved(mut self) -> Self {
        self.levels.remove(0);
        self
    }

    /// Returns the levels for reflections, from a mirror's to those of the roughest surface: for each its edge length and the
    /// texels of all faces. `quality` multiplies the number of samples.
    pub fn filtered(&self, quality: usize) -> Vec<(usize, Vec<Vec3>)> {
        let mut filtered = vec![(self.levels[0].size, self.levels[0].inside())];
        for (index, level) in self.levels.iter().enumerate().skip(1) {
            let lobe = Lobe::new(self, roughness_of_level(index, self.levels.len() - 1), quality * (12 << (index - 1)));
            let blurred = directions(level.size).map(|at| self.blurred(&lobe, at.normalize_or_zero()));
            filtered.push((level.size, blurred.collect()));
        }
        filtered
    }

    fn blurred(&self, lobe: &Lobe, normal: Vec3) -> Vec3 {
        let (x, y) = normal.any_orthonormal_pair();
        let sum = lobe.samples.iter().fold(Vec4::ZERO, |sum, sample| {
            let [right, up, ahead, weight] = sample.direction_weight.to_array();
            sum + weight * self.levels[sample.level].sample(x * right + y * up + normal * ahead)
        });
        sum.truncate()
    }

    /// Returns the irradiance over π, which a white diffuse surface reflects, as a cube map indexed by the normal: the
    /// edge length of a face and the texels of all faces. Spherical harmonics of few bands would let a strong lamp
    /// light surfaces that face away from it.
    pub fn irradiance(&self) -> (usize, Vec<Vec3>) {
        let lights = self.lights();
        let reflected = |normal: Vec3| {
            let sum = lights.iter().fold(Vec4::ZERO, |sum, (from, light)| sum + from.dot(normal).max(0.0) * *light);
            sum.truncate() / sum.w
        };
        (IRRADIANCE_SIZE, directions(IRRADIANCE_SIZE).map(|at| reflected(at.normalize_or_zero())).collect())
    }

    /// Returns the mean direction of incoming light. Its length is 1 for a single small lamp, 0 for uniform light.
    pub fn mean_direction(&self) -> Vec3 {
        let weighted = self.lights().into_iter().map(|(from, light)| from.extend(1.0) * light.truncate().element_sum());
        let sum: Vec4 = weighted.sum();
        sum.truncate() / sum.w.max(f32::MIN_POSITIVE)
    }

    /// Returns directions with the light from there times its relative solid angle, which W holds.
    fn lights(&self) -> Vec<(Vec3, Vec4)> {
        let size = (self.levels[0].size / 8).max(4);
        let level = self.levels.iter().find(|level| level.size <= size).unwrap_or(&self.levels[0]);
        let lights = directions(level.size).zip(level.inside()).map(|(at, light)| {
            let solid_angle = at.length_squared().powf(-1.5);
            (at.normalize_or_zero(), solid_angle * light.extend(1.0))
        });
        lights.collect()
    }
}

/// Inverts light.wgsl's `level = last · roughness · (2 − roughness)`, which gives smooth surfaces, whose reflections are the
/// sharpest, most of the levels.
fn roughness_of_level(level: usize, last: usize) -> f32 {
    if last == 0 { 0.0 } else { 1.0 - (1.0 - level as f32 / last as f32).sqrt() }
}

struct LobeSample {
    /// Around +Z; the weights sum up to 1.
    direction_weight: Vec4,
    /// Where a texel is about as large as the part of the lobe that the sample stands for.
    level: usize,
}

/// Samples of the reflection lobe for some roughness.
struct Lobe {
    samples: Vec<LobeSample>,
}

impl Lobe {
    /// Importance-samples GGX for a view along the normal (Karis 2013, "Real Shading in Unreal Engine 4"). Each sample reads the
    /// mip level that matches its density (Křivánek and Colbert 2008, "Real-time Shading with Filtered Importance Sampling"), so
    /// that a few samples cover the whole environment.
    fn new(cube: &Cube, roughness: f32, count: usize) -> Self {
        let (size, last) = (cube.levels[0].size, cube.levels.len() - 1);
        let alpha_squared = roughness.powi(4);
        let texel = 4.0 * std::f32::consts::PI / (6 * size * size) as f32;
        let mut samples = Vec::new();
        for index in 0..count {
            let u = (index as f32 + 0.5) / count as f32;
            let cos_squared = (1.0 - u) / (1.0 + (alpha_squared - 1.0) * u);
            let (cos, sin) = (cos_squared.sqrt(), (1.0 - cos_squared).max(0.0).sqrt());
            // The golden angle distributes samples evenly.
            let (turn_sin, turn_cos) = (2.399_963_2 * index as f32).sin_cos();
            let half_way = Vec3::new(sin * turn_cos, sin * turn_sin, cos);
            let reflected = 2.0 * half_way.z * half_way - Vec3::Z;
            if reflected.z > 0.0 {
                let f = cos_squared * (alpha_squared - 1.0) + 1.0;
                let density = alpha_squared / (4.0 * std::f32::consts::PI * f * f);
                // Somewhat larger, so that neighbouring samples overlap.
                let level = 0.5 * (1.0 / (count as f32 * density * texel)).max(1.0).log2() + 0.3;
                let level = (level.round() as usize).min(last);
                samples.push(LobeSample { direction_weight: reflected.extend(reflected.z), level });
            }
        }
        let sum: f32 = samples.iter().map(|sample| sample.direction_weight.w).sum();
        samples.iter_mut().for_each(|sample| sample.direction_weight.w /= sum);
        Self { samples }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lamp with a soft edge from above left in a dim room.
    fn lamp(direction: Vec3) -> Vec3 {
        let facing = direction.dot(Vec3::new(-0.6, 0.8, 0.0));
        Vec3::splat(0.2) + ((facing - 0.9) / 0.06).clamp(0.0, 1.0) * Vec3::new(8.0, 7.0, 6.0)
    }

    /// Directions that cover the sphere evenly, each standing for the same solid angle.
    fn sphere(count: usize) -> impl Iterator<Item = Vec3> {
        (0..count).map(move |index| {
            let y = 1.0 - 2.0 * (index as f32 + 0.5) / count as f32;
            let (sin, cos) = (2.399_963_2 * index as f32).sin_cos();
            let ring = (1.0 - y * y).sqrt();
            Vec3::new(ring * cos, y, ring * sin)
        })
    }

    /// The mean of the lamp's light over all directions, by a weight of the cosine to `normal`.
    fn weighted_light(normal: Vec3, weight: impl Fn(f32) -> f32) -> Vec3 {
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for direction in sphere(400_000) {
            let weight = weight(direction.dot(normal));
            (sum, total) = (sum + weight * lamp(direction), total + weight);
        }
        sum / total
    }

    #[test]
    fn a_direction_finds_its_own_texel() {
        for face in 0..6 {
            for at in [Vec2::ZERO, Vec2::new(0.9, -0.3), Vec2::new(-0.99, 0.98)] {
                let (found, place) = face_of(3.0 * on_face(face, at));
                assert!(found == face && place.distance(at) < 1e-6, "{face} {at}: {found} {place}");
            }
        }
        let cube = Cube::new(64, |direction| direction);
        for direction in sphere(500) {
            let found = cube.levels[0].sample(direction).truncate();
            assert!(found.distance(direction) < 0.05, "{direction}: {found}");
        }
    }

    #[test]
    fn the_same_light_from_everywhere_stays_the_same() {
        let cube = Cube::new(16, |_| Vec3::splat(0.75));
        for (size, texels) in cube.filtered(1) {
            assert_eq!(texels.len(), 6 * size * size);
            assert!(texels.iter().all(|texel| texel.abs_diff_eq(Vec3::splat(0.75), 1e-5)), "{size}");
        }
        assert!(cube.irradiance().1.iter().all(|light| light.abs_diff_eq(Vec3::splat(0.75), 1e-5)));
        assert!(cube.mean_direction().length() < 1e-4);
    }

    #[test]
    fn reflections_are_the_environment_weighted_by_the_lobe() {
        let cube = Cube::new(64, lamp);
        let levels = cube.filtered(1);
        let last = levels.len() - 1;
        // The lobe of level 1 is narrower than what this integral resolves.
        for (index, (size, texels)) in levels.iter().enumerate().skip(2) {
            let alpha_squared = roughness_of_level(index, last).powi(4);
            let mut sum = 0.0;
            for place in 0..48 {
                let texel = place * texels.len() / 48;
                let on = texel % (size * size);
                let normal = on_face(texel / (size * size), center(*size, on % size, on / size)).normalize();
                // GGX's density around the half vector between a direction and the normal, times the cosine.
                let exact = weighted_light(normal, |cos| {
                    let f = 0.5 * (1.0 + cos) * (alpha_squared - 1.0) + 1.0;
                    cos.max(0.0) / (f * f)
                });
                sum += (texels[texel] - exact).abs().max_element() / exact.max_element();
            }
            assert!(sum / 48.0 < 0.08, "level {index}: {}", sum / 48.0);
        }
    }

    #[test]
    fn irradiance_is_the_environment_weighted_by_the_cosine() {
        let (size, irradiance) = Cube::new(128, lamp).irradiance();
        let towards_lamp = Vec3::new(-0.6, 0.8, 0.0);
        let brightest = weighted_light(towards_lamp, |cos| cos.max(0.0)).y;
        for (normal, shown) in directions(size).zip(irradiance).step_by(31) {
            let expected = weighted_light(normal.normalize(), |cos| cos.max(0.0)).y;
            assert!((shown.y - expected).abs() < 0.01 * brightest, "{normal}: {} instead of {expected}", shown.y);
        }
        assert!(Cube::new(64, lamp).mean_direction().normalize().distance(towards_lamp) < 0.02);
    }
}
