//! The viewport's camera.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// The camera that shows the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CameraChoice {
    /// Frames the whole clip from the front, slightly from the side and above.
    #[default]
    Auto,
    /// A camera that orbits a target.
    Orbit(OrbitCamera),
    /// A camera of the file, by index.
    File(usize),
}

/// Looks at `target` from `distance` away. Yaw 0 looks from +Z, 90° from +X; positive pitch looks from above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OrbitCamera {
    /// Within ±180°.
    pub yaw_radians: f32,
    /// Within ±89.9°.
    pub pitch_radians: f32,
    /// Metres, positive.
    pub distance: f32,
    /// World space.
    pub target: Vec3,
}

impl OrbitCamera {
    /// Unit vector from the target towards the eye.
    pub fn direction(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = self.yaw_radians.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch_radians.sin_cos();
        Vec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch)
    }

    /// Returns the camera's position in world space.
    pub fn eye(&self) -> Vec3 {
        self.target + self.distance * self.direction()
    }
}
