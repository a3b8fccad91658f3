//! Environment light as an image.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

/// Radiance from all directions: an equirectangular image. Its middle is +X, its left quarter −Z, its top +Y, as in three.js
/// and the Khronos glTF Sample Viewer.
#[derive(Debug, Clone, PartialEq)]
pub struct Panorama {
    width: usize,
    height: usize,
    pixels: Vec<Vec3>,
}

impl Panorama {
    /// `pixels` are linear RGB, row by row from the top; `None` unless there are `width` times `height` of them, at
    /// least one.
    pub fn new(width: usize, height: usize, pixels: Vec<Vec3>) -> Option<Self> {
        let fits = !pixels.is_empty() && width.checked_mul(height) == Some(pixels.len());
        fits.then_some(Self { width, height, pixels })
    }

    /// In pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// In pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Linear RGB, row by row from the top.
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// Returns the radiance from a unit direction, bilinearly filtered.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let x = (direction.z.atan2(direction.x) / TAU + 0.5) * self.width as f32 - 0.5;
        let y = direction.y.clamp(-1.0, 1.0).acos() / PI * self.height as f32 - 0.5;
        let row = |step: isize| (y.floor() as isize + step).clamp(0, self.height as isize - 1) as usize;
        let column = |step: isize| (x.floor() as isize + step).rem_euclid(self.width as isize) as usize;
        let pixel = |right: isize, down: isize| self.pixels[row(down) * self.width + column(right)];
        let (right, down) = (x - x.floor(), y - y.floor());
        let upper = pixel(0, 0).lerp(pixel(1, 0), right);
        upper.lerp(pixel(0, 1).lerp(pixel(1, 1), right), down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_find_their_place_in_the_image() {
        // Red, green, blue and white quarters from the left, over black.
        let colors = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
        let pixels = (0..32 * 16).map(|at| if at / 32 < 8 { colors[at % 32 / 8] } else { Vec3::ZERO }).collect();
        let panorama = Panorama::new(32, 16, pixels).expect("the right size");
        let up = |x: f32, z: f32| Vec3::new(x, 0.5, z).normalize();
        let cases =
            [(up(-1.0, -1.0), Vec3::X), (up(1.0, -1.0), Vec3::Y), (up(1.0, 1.0), Vec3::Z), (up(-1.0, 1.0), Vec3::ONE)];
        for (direction, color) in cases {
            assert_eq!(panorama.radiance(direction), color, "{direction}");
        }
        assert_eq!(panorama.radiance(Vec3::new(1.0, -0.5, 1.0).normalize()), Vec3::ZERO);
        // Halfway between the last and the first column.
        assert!(panorama.radiance(up(-1.0, 0.0)).abs_diff_eq(Vec3::new(1.0, 0.5, 0.5), 1e-5));
        assert_eq!(Panorama::new(2, 2, vec![Vec3::ZERO; 3]), None);
    }
}
