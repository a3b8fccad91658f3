//! Light set-ups generated from a few soft boxes between a floor and a sky, so that nothing is downloaded.

use gaitway_scene::state::LightSetup;
use glam::{Vec2, Vec3};

/// A directional light that belongs to an environment. It casts the shadow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DirectionalLight {
    /// Unit vector towards the light, without environment rotation.
    pub direction: Vec3,
    /// Linear colour times intensity; zero switches the light off but not the shadow on the ground.
    pub color: Vec3,
}

/// A soft-edged lamp at infinity.
struct SoftBox {
    direction: Vec3,
    right: Vec3,
    up: Vec3,
    /// Half the size at unit distance.
    half_size: Vec2,
    /// Width of the soft edge.
    edge: f32,
    /// Cosine of the angle to its corners.
    reach: f32,
    color: Vec3,
}

impl SoftBox {
    fn new(direction: [f32; 3], half_size: [f32; 2], color: [f32; 3]) -> Self {
        let direction = Vec3::from(direction).normalize_or_zero();
        let right = Vec3::Y.cross(direction).try_normalize().unwrap_or(Vec3::X);
        let half_size = Vec2::from(half_size);
        let edge = 0.12 * half_size.min_element();
        let reach = 1.0 / (1.0 + (half_size + 0.5 * edge).length_squared()).sqrt();
        Self { direction, right, up: direction.cross(right), half_size, edge, reach, color: color.into() }
    }

    fn radiance(&self, direction: Vec3) -> Vec3 {
        let facing = direction.dot(self.direction);
        // Most directions miss most boxes.
        if facing < self.reach {
            return Vec3::ZERO;
        }
        let at = Vec2::new(direction.dot(self.right), direction.dot(self.up)).abs() / facing;
        let edge = ((self.half_size - at) / self.edge + 0.5).clamp(Vec2::ZERO, Vec2::ONE);
        let edge = edge * edge * (3.0 - 2.0 * edge);
        self.color * (edge.x * edge.y)
    }
}

/// The lamps and surroundings of a [`LightSetup`].
pub(super) struct Surroundings {
    boxes: Vec<SoftBox>,
    floor: Vec3,
    horizon: Vec3,
    zenith: Vec3,
    pub key: DirectionalLight,
}

impl Surroundings {
    pub fn of(setup: LightSetup) -> Self {
        match setup {
            LightSetup::Studio => studio(),
            LightSetup::White => white(),
            LightSetup::Soft => soft(),
            LightSetup::Hard => hard(),
            LightSetup::Outdoor => outdoor(),
        }
    }

    fn new(boxes: Vec<SoftBox>, [floor, horizon, zenith]: [[f32; 3]; 3], key: [[f32; 3]; 2]) -> Self {
        let [direction, color] = key.map(Vec3::from);
        let key = DirectionalLight { direction: direction.normalize_or_zero(), color };
        Self { boxes, floor: floor.into(), horizon: horizon.into(), zenith: zenith.into(), key }
    }

    /// Linear radiance from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let height = direction.y;
        let walls = match height > 0.0 {
            true => self.horizon.lerp(self.zenith, height),
            false => self.horizon.lerp(self.floor, (-3.0 * height).min(1.0)),
        };
        self.boxes.iter().fold(walls, |sum, soft_box| sum + soft_box.radiance(direction))
    }
}

/// Front left, above.
const KEY_DIRECTION: [f32; 3] = [-0.48, 0.72, 0.50];

/// White surfaces stay below white at exposure 0, so that their shading shows.
fn studio() -> Surroundings {
    let boxes = vec![
        // Key, above left.
        SoftBox::new(KEY_DIRECTION, [0.55, 0.55], [1.56, 1.56, 1.56]),
        // Fill, large and weak, right.
        SoftBox::new([0.9, 0.25, 0.5], [0.7, 1.0], [0.513, 0.54, 0.572]),
        // Rims, behind on both sides.
        SoftBox::new([-0.75, 0.35, -0.75], [0.22, 1.2], [2.43, 2.62, 2.97]),
        SoftBox::new([0.7, 0.45, -0.8], [0.25, 1.2], [3.0, 2.94, 2.85]),
        // Ceiling.
        SoftBox::new([0.05, 1.0, 0.0], [0.8, 0.8], [0.72, 0.72, 0.72]),
    ];
    let walls = [[0.096, 0.093, 0.09], [0.156, 0.162, 0.174], [0.192, 0.204, 0.228]];
    Surroundings::new(boxes, walls, [KEY_DIRECTION, [1.05, 1.01, 0.95]])
}

/// The same light from everywhere: a white surface disappears in front of it (the furnace test).
fn white() -> Surroundings {
    Surroundings::new(Vec::new(), [[1.0; 3]; 3], [KEY_DIRECTION, [0.0; 3]])
}

/// An overcast tent: large boxes, almost no highlights, a weak shadow.
fn soft() -> Surroundings {
    let boxes = vec![
        SoftBox::new([0.0, 1.0, 0.15], [1.6, 1.6], [0.55, 0.55, 0.56]),
        SoftBox::new([-0.8, 0.4, 0.6], [1.1, 1.3], [0.42, 0.42, 0.41]),
        SoftBox::new([0.9, 0.3, 0.5], [1.1, 1.3], [0.32, 0.33, 0.35]),
    ];
    let walls = [[0.34, 0.335, 0.33], [0.46, 0.46, 0.46], [0.5, 0.51, 0.52]];
    Surroundings::new(boxes, walls, [[-0.3, 0.9, 0.35], [0.25, 0.25, 0.25]])
}

/// One small strong lamp and two thin rims in a dark room.
fn hard() -> Surroundings {
    let boxes = vec![
        SoftBox::new([-0.62, 0.62, 0.48], [0.16, 0.16], [9.0, 8.8, 8.4]),
        SoftBox::new([-0.7, 0.2, -0.8], [0.12, 1.4], [3.2, 3.5, 4.2]),
        SoftBox::new([0.85, 0.3, -0.6], [0.12, 1.4], [4.2, 3.7, 3.2]),
    ];
    let walls = [[0.05, 0.05, 0.05], [0.075, 0.08, 0.09], [0.06, 0.065, 0.075]];
    Surroundings::new(boxes, walls, [[-0.62, 0.62, 0.48], [3.1, 3.0, 2.85]])
}

/// A clear day: blue sky, a bright haze at the horizon, warm ground, and the sun as the key light.
fn outdoor() -> Surroundings {
    let boxes = vec![
        // The bright sky around the sun.
        SoftBox::new([0.55, 0.65, 0.52], [0.3, 0.3], [1.9, 1.8, 1.6]),
        // A cloud bank behind.
        SoftBox::new([-0.5, 0.3, -0.8], [1.2, 0.35], [0.45, 0.45, 0.46]),
    ];
    let walls = [[0.2, 0.17, 0.13], [0.62, 0.68, 0.76], [0.2, 0.34, 0.66]];
    Surroundings::new(boxes, walls, [[0.55, 0.65, 0.52], [2.4, 2.25, 1.95]])
}
