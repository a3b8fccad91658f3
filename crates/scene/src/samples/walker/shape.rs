//! The walker's mesh: tubes around joint chains, rounded at the ends, with weights that blend across each bend.

use gaitway_character::mesh::{Geometry, Influences, MorphTarget};
use glam::{Vec2, Vec3, Vec4};

use super::{joint, position};

const SIDES: usize = 24;

const SHELL: Vec3 = Vec3::new(0.78, 0.80, 0.83);
const DARK: Vec3 = Vec3::new(0.045, 0.05, 0.06);
const ACCENT: Vec3 = Vec3::new(0.95, 0.24, 0.03);

const SHELL_MATERIAL: usize = 0;
const VISOR_MATERIAL: usize = 1;
const EYES_MATERIAL: usize = 2;

const HEAD_CENTER: Vec3 = Vec3::new(0.0, 1.635, 0.01);
const HEAD_RADII: Vec3 = Vec3::new(0.118, 0.125, 0.122);

/// A cross-section of a tube.
#[derive(Clone, Copy)]
struct Ring {
    center: Vec3,
    /// Along the tube's `across` and `up` axes.
    radii: Vec2,
    color: Vec3,
}

/// A mesh primitive under construction.
#[derive(Default)]
struct Surface {
    positions: Vec<Vec3>,
    colors: Vec<Vec4>,
    influences: Influences,
    indices: Vec<u32>,
}

/// A joint chain and its skin weights along `axis`: 1 in the middle of a bone, blended over `blend` metres on either side
/// of a joint.
struct Chain<'a> {
    joints: &'a [usize],
    axis: Vec3,
    blend: f32,
}

impl Chain<'_> {
    /// Returns the two joints that influence a point, with their weights.
    fn weights(&self, point: Vec3) -> [(usize, f32); 2] {
        let along = point.dot(self.axis);
        let mut at = [(self.joints[0], 1.0), (self.joints[0], 0.0)];
        for pair in self.joints.windows(2) {
            let start = position(pair[1]).dot(self.axis) - self.blend;
            let share = ((along - start) / (2.0 * self.blend)).clamp(0.0, 1.0);
            if share > 0.0 {
                let smooth = share * share * (3.0 - 2.0 * share);
                at = [(pair[0], 1.0 - smooth), (pair[1], smooth)];
            }
        }
        at
    }
}

pub fn body() -> Vec<Geometry> {
    let mut shell = Surface::default();
    torso(&mut shell);
    head(&mut shell);
    for side in [1.0, -1.0] {
        arm(&mut shell, side);
        leg(&mut shell, side);
        shoe(&mut shell, side);
    }
    vec![shell.build(SHELL_MATERIAL), visor()]
}

/// Two lights on the visor; the morph target flattens them.
pub fn eyes() -> Geometry {
    let mut surface = Surface::default();
    for side in [1.0, -1.0] {
        let center = HEAD_CENTER + Vec3::new(0.043 * side, 0.012, 0.0);
        let depth = on_visor(center.x, center.y);
        surface.ellipsoid(Vec3::new(center.x, center.y, depth), Vec3::new(0.015, 0.024, 0.007), joint::HEAD, SHELL);
    }
    let mut geometry = surface.build(EYES_MATERIAL);
    let middle = HEAD_CENTER.y + 0.012;
    let flat = |position: &Vec3| Vec3::new(0.0, 0.88 * (middle - position.y), 0.0);
    let positions = geometry.positions.iter().map(flat).collect();
    geometry.morph_targets = vec![MorphTarget { positions, ..MorphTarget::default() }];
    geometry
}

fn torso(surface: &mut Surface) {
    let chain = Chain {
        joints: &[joint::HIPS, joint::SPINE, joint::CHEST, joint::NECK, joint::HEAD],
        axis: Vec3::Y,
        blend: 0.05,
    };
    let ring = |y: f32, z: f32, x_radius: f32, z_radius: f32, color: Vec3| Ring {
        center: Vec3::new(0.0, y, z),
        radii: Vec2::new(x_radius, z_radius),
        color,
    };
    let pelvis = [
        ring(0.815, 0.0, 0.03, 0.03, SHELL),
        ring(0.825, 0.0, 0.085, 0.07, SHELL),
        ring(0.85, 0.0, 0.13, 0.098, SHELL),
        ring(0.885, 0.0, 0.155, 0.112, SHELL),
        ring(0.925, 0.0, 0.16, 0.115, SHELL),
        ring(0.955, 0.0, 0.152, 0.11, SHELL),
        ring(0.972, 0.0, 0.135, 0.098, SHELL),
        ring(0.978, 0.0, 0.115, 0.085, DARK),
        ring(1.0, -0.002, 0.108, 0.08, DARK),
        ring(1.03, -0.004, 0.106, 0.078, DARK),
        ring(1.06, -0.006, 0.108, 0.08, DARK),
        ring(1.078, -0.006, 0.115, 0.084, DARK),
        ring(1.084, -0.006, 0.14, 0.098, SHELL),
        ring(1.11, -0.006, 0.158, 0.108, SHELL),
        ring(1.145, -0.006, 0.168, 0.116, SHELL),
        ring(1.19, -0.005, 0.178, 0.123, SHELL),
        ring(1.225, -0.004, 0.184, 0.126, ACCENT),
        ring(1.25, -0.004, 0.187, 0.127, ACCENT),
        ring(1.275, -0.005, 0.188, 0.126, SHELL),
        ring(1.325, -0.007, 0.184, 0.12, SHELL),
        ring(1.37, -0.009, 0.17, 0.108, SHELL),
        ring(1.405, -0.01, 0.14, 0.09, SHELL),
        ring(1.425, -0.01, 0.1, 0.072, SHELL),
        ring(1.434, -0.01, 0.065, 0.058, SHELL),
        ring(1.437, -0.01, 0.05, 0.05, DARK),
        ring(1.47, -0.008, 0.046, 0.046, DARK),
        ring(1.51, -0.003, 0.046, 0.046, DARK),
        ring(1.55, 0.0, 0.046, 0.046, DARK),
    ];
    surface.tube(&pelvis, Vec3::X, Vec3::Z, &chain);
}

fn head(surface: &mut Surface) {
    surface.ellipsoid(HEAD_CENTER, HEAD_RADII, joint::HEAD, SHELL);
    for side in [1.0, -1.0] {
        let ear = HEAD_CENTER + Vec3::new(0.113 * side, 0.0, -0.005);
        surface.ellipsoid(ear, Vec3::new(0.02, 0.042, 0.042), joint::HEAD, ACCENT);
    }
}

/// Returns the Z of the visor at a point of the face.
fn on_visor(x: f32, y: f32) -> f32 {
    let radii = 1.035 * HEAD_RADII;
    let (u, v) = ((x - HEAD_CENTER.x) / radii.x, (y - HEAD_CENTER.y) / radii.y);
    HEAD_CENTER.z + radii.z * (1.0 - u * u - v * v).max(0.0).sqrt()
}

/// A face shield: a patch of a slightly larger head, sunk in along its rim.
fn visor() -> Geometry {
    const COLUMNS: usize = 28;
    const ROWS: usize = 14;
    let mut surface = Surface::default();
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let (u, v) = (2.0 * column as f32 / COLUMNS as f32 - 1.0, 2.0 * row as f32 / ROWS as f32 - 1.0);
            // Maps the square to a rounded one.
            let (x, y) = (u * (1.0 - 0.28 * v * v).sqrt(), v * (1.0 - 0.28 * u * u).sqrt());
            let (azimuth, elevation) = (1.12 * x, 0.47 * y + 0.06);
            let direction =
                Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
            let rim = u.abs().max(v.abs());
            let out = if rim > 0.999 { 0.985 } else { 1.035 - 0.02 * rim.powi(6) };
            surface.vertex(HEAD_CENTER + out * HEAD_RADII * direction, SHELL, [(joint::HEAD, 1.0), (joint::HEAD, 0.0)]);
        }
    }
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let corner = (row * (COLUMNS + 1) + column) as u32;
            let above = corner + COLUMNS as u32 + 1;
            surface.quad([corner, corner + 1, above + 1, above]);
        }
    }
    surface.build(VISOR_MATERIAL)
}

fn arm(surface: &mut Surface, side: f32) {
    let [_, upper, lower, hand] = if side > 0.0 { joint::LEFT_ARM } else { joint::RIGHT_ARM };
    let chain = Chain { joints: &[upper, lower, hand], axis: side * Vec3::X, blend: 0.045 };
    let y = position(upper).y;
    let ring = |x: f32, radius: f32, color: Vec3| Ring {
        center: Vec3::new(side * x, y, -0.01),
        radii: Vec2::splat(radius),
        color,
    };
    let rings = [
        ring(0.145, 0.02, SHELL),
        ring(0.15, 0.045, SHELL),
        ring(0.165, 0.065, SHELL),
        ring(0.19, 0.074, SHELL),
        ring(0.22, 0.07, SHELL),
        ring(0.25, 0.06, SHELL),
        ring(0.262, 0.052, SHELL),
        ring(0.266, 0.043, DARK),
        ring(0.3, 0.041, DARK),
        ring(0.34, 0.04, DARK),
        ring(0.38, 0.04, DARK),
        ring(0.41, 0.04, DARK),
        ring(0.43, 0.041, DARK),
        ring(0.445, 0.042, DARK),
        ring(0.46, 0.041, DARK),
        ring(0.478, 0.041, DARK),
        ring(0.483, 0.05, SHELL),
        ring(0.5, 0.057, SHELL),
        ring(0.54, 0.06, SHELL),
        ring(0.58, 0.057, SHELL),
        ring(0.6, 0.055, ACCENT),
        ring(0.622, 0.053, ACCENT),
        ring(0.64, 0.051, SHELL),
        ring(0.66, 0.047, SHELL),
        ring(0.665, 0.034, DARK),
        ring(0.685, 0.032, DARK),
        ring(0.7, 0.034, DARK),
    ];
    surface.tube(&rings, Vec3::Y, side * Vec3::Z, &chain);
    surface.ellipsoid(Vec3::new(side * 0.745, y, -0.005), Vec3::new(0.062, 0.03, 0.046), hand, DARK);
    surface.ellipsoid(Vec3::new(side * 0.8, y - 0.004, -0.002), Vec3::new(0.038, 0.022, 0.036), hand, DARK);
    surface.ellipsoid(Vec3::new(side * 0.735, y - 0.004, 0.045), Vec3::new(0.032, 0.017, 0.019), hand, DARK);
}

fn leg(surface: &mut Surface, side: f32) {
    let [upper, lower, foot, _] = if side > 0.0 { joint::LEFT_LEG } else { joint::RIGHT_LEG };
    let x = position(upper).x;
    let chain = Chain { joints: &[joint::HIPS, upper, lower, foot], axis: -Vec3::Y, blend: 0.05 };
    let ring = |y: f32, radius: f32, z: f32, color: Vec3| Ring {
        center: Vec3::new(x, y, z),
        radii: Vec2::splat(radius),
        color,
    };
    let rings = [
        ring(0.935, 0.03, 0.0, DARK),
        ring(0.93, 0.055, 0.0, DARK),
        ring(0.905, 0.068, 0.0, DARK),
        ring(0.87, 0.07, 0.0, DARK),
        ring(0.845, 0.068, 0.0, DARK),
        ring(0.838, 0.08, 0.0, SHELL),
        ring(0.81, 0.086, 0.002, SHELL),
        ring(0.76, 0.086, 0.004, SHELL),
        ring(0.7, 0.081, 0.004, SHELL),
        ring(0.64, 0.074, 0.003, SHELL),
        ring(0.59, 0.067, 0.002, SHELL),
        ring(0.568, 0.062, 0.001, SHELL),
        ring(0.562, 0.05, 0.0, DARK),
        ring(0.535, 0.048, 0.0, DARK),
        ring(0.51, 0.048, 0.002, DARK),
        ring(0.48, 0.049, 0.003, DARK),
        ring(0.45, 0.048, 0.002, DARK),
        ring(0.425, 0.048, 0.0, DARK),
        ring(0.41, 0.048, 0.0, DARK),
        ring(0.404, 0.06, 0.0, SHELL),
        ring(0.38, 0.068, -0.002, SHELL),
        ring(0.33, 0.07, -0.006, SHELL),
        ring(0.27, 0.065, -0.006, SHELL),
        ring(0.235, 0.061, -0.005, ACCENT),
        ring(0.21, 0.058, -0.004, ACCENT),
        ring(0.19, 0.056, -0.003, SHELL),
        ring(0.16, 0.053, -0.001, SHELL),
        ring(0.15, 0.046, 0.0, SHELL),
        ring(0.147, 0.036, 0.0, DARK),
        ring(0.115, 0.034, 0.0, DARK),
        ring(0.085, 0.034, 0.0, DARK),
        ring(0.065, 0.034, 0.0, DARK),
    ];
    surface.tube(&rings, Vec3::X, -Vec3::Z, &chain);
}

/// A tube from heel to toe with a flat sole.
fn shoe(surface: &mut Surface, side: f32) {
    let [_, _, foot, toes] = if side > 0.0 { joint::LEFT_LEG } else { joint::RIGHT_LEG };
    let x = position(foot).x;
    let chain = Chain { joints: &[foot, toes], axis: Vec3::Z, blend: 0.03 };
    let ring = |z: f32, half_width: f32, height: f32, color: Vec3| Ring {
        center: Vec3::new(x, 0.5 * height, z),
        radii: Vec2::new(half_width, 0.5 * height),
        color,
    };
    let rings = [
        ring(-0.078, 0.016, 0.05, SHELL),
        ring(-0.074, 0.034, 0.072, SHELL),
        ring(-0.06, 0.045, 0.088, SHELL),
        ring(-0.03, 0.05, 0.1, SHELL),
        ring(0.01, 0.053, 0.104, SHELL),
        ring(0.045, 0.055, 0.098, SHELL),
        ring(0.08, 0.057, 0.084, SHELL),
        ring(0.105, 0.058, 0.075, SHELL),
        ring(0.118, 0.058, 0.072, DARK),
        ring(0.13, 0.058, 0.07, DARK),
        ring(0.142, 0.058, 0.067, DARK),
        ring(0.155, 0.057, 0.064, ACCENT),
        ring(0.175, 0.052, 0.058, ACCENT),
        ring(0.192, 0.042, 0.05, ACCENT),
        ring(0.203, 0.026, 0.04, ACCENT),
        ring(0.206, 0.012, 0.03, ACCENT),
    ];
    surface.tube(&rings, Vec3::X, Vec3::Y, &chain);
}

impl Surface {
    fn vertex(&mut self, position: Vec3, color: Vec3, [(a, weight_a), (b, weight_b)]: [(usize, f32); 2]) {
        self.positions.push(position);
        self.colors.push(color.extend(1.0));
        // Strongest first, as in every loaded asset.
        let (first, second) =
            if weight_a >= weight_b { ((a, weight_a), (b, weight_b)) } else { ((b, weight_b), (a, weight_a)) };
        let second = if second.1 > 0.0 { second } else { (0, 0.0) };
        self.influences.stride = 4;
        self.influences.joints.extend([first.0 as u16, second.0 as u16, 0, 0]);
        self.influences.weights.extend([first.1, second.1, 0.0, 0.0]);
    }

    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.indices.extend([a, b, c, a, c, d]);
    }

    /// Adds a tube through the rings, capped at both ends. `across × up` points along the tube.
    fn tube(&mut self, rings: &[Ring], across: Vec3, up: Vec3, chain: &Chain) {
        let start = self.positions.len() as u32;
        let along = rings.last().map_or(Vec3::ZERO, |last| last.center - rings[0].center);
        let reversed = across.cross(up).dot(along) < 0.0;
        for ring in rings {
            for side in 0..SIDES {
                let (sin, cos) = (std::f32::consts::TAU * side as f32 / SIDES as f32).sin_cos();
                let position = ring.center + ring.radii.x * cos * across + ring.radii.y * sin * up;
                self.vertex(position, ring.color, chain.weights(ring.center));
            }
        }
        let sides = SIDES as u32;
        for ring in 0..rings.len() as u32 - 1 {
            for side in 0..sides {
                let next = (side + 1) % sides;
                let (a, b) = (start + ring * sides + side, start + ring * sides + next);
                let quad = [a, b, b + sides, a + sides];
                self.quad(if reversed { [quad[3], quad[2], quad[1], quad[0]] } else { quad });
            }
        }
        for (ring, outwards) in [(0, reversed), (rings.len() as u32 - 1, !reversed)] {
            let first = start + ring * sides;
            for side in 1..sides - 1 {
                let (b, c) = (first + side, first + side + 1);
                self.indices.extend(if outwards { [first, b, c] } else { [first, c, b] });
            }
        }
    }

    fn ellipsoid(&mut self, center: Vec3, radii: Vec3, joint: usize, color: Vec3) {
        const RINGS: usize = 14;
        let start = self.positions.len() as u32;
        for ring in 0..=RINGS {
            let (height, width) =
                (std::f32::consts::PI * ring as f32 / RINGS as f32 - 0.5 * std::f32::consts::PI).sin_cos();
            for side in 0..SIDES {
                let (sin, cos) = (std::f32::consts::TAU * side as f32 / SIDES as f32).sin_cos();
                let direction = Vec3::new(width * cos, height, -width * sin);
                self.vertex(center + radii * direction, color, [(joint, 1.0), (joint, 0.0)]);
            }
        }
        let sides = SIDES as u32;
        for ring in 0..RINGS as u32 {
            for side in 0..sides {
                let next = (side + 1) % sides;
                let (a, b) = (start + ring * sides + side, start + ring * sides + next);
                self.quad([a, b, b + sides, a + sides]);
            }
        }
    }

    fn build(self, material: usize) -> Geometry {
        let normals = smooth_normals(&self.positions, &self.indices);
        Geometry {
            file_vertices: self.positions.len(),
            positions: self.positions,
            normals,
            colors: self.colors,
            indices: self.indices,
            influences: self.influences,
            material: Some(material),
            ..Geometry::default()
        }
    }
}

/// Area-weighted vertex normals, shared by vertices at the same position.
fn smooth_normals(positions: &[Vec3], indices: &[u32]) -> Vec<Vec3> {
    let key = |position: Vec3| position.to_array().map(|value| (value * 1e5).round() as i32);
    let mut sums: std::collections::BTreeMap<[i32; 3], Vec3> = std::collections::BTreeMap::new();
    for triangle in indices.chunks_exact(3) {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|index| positions[index as usize]);
        let area = (b - a).cross(c - a);
        for corner in [a, b, c] {
            *sums.entry(key(corner)).or_default() += area;
        }
    }
    positions
        .iter()
        .map(|&position| sums.get(&key(position)).map_or(Vec3::Y, |sum| sum.normalize_or(Vec3::Y)))
        .collect()
}
