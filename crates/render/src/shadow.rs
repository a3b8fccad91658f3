//! The shadow map and its view.

use gaitway_character::mesh::Bounds;
use glam::camera::rh::proj::directx::orthographic;
use glam::camera::rh::view::look_to_mat4;
use glam::{Mat4, Vec3};

pub(super) const SHADOW_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

pub(super) struct ShadowMap {
    /// Edge length in texels.
    pub size: u32,
    pub view: wgpu::TextureView,
    /// Bound instead of the map while it is drawn.
    pub placeholder: wgpu::TextureView,
    pub sampler: wgpu::Sampler,
}

impl ShadowMap {
    /// `samples` per pixel of the pictures. On software adapters, which draw one, a larger map takes as long as a picture.
    pub fn new(device: &wgpu::Device, samples: u32) -> Self {
        let size = if samples > 1 { 1024 } else { 512 };
        let view = |size| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("shadow map"),
                size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: SHADOW_FORMAT,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow map"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        Self { size, view: view(size), placeholder: view(1), sampler }
    }
}

/// The light's view of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShadowView {
    pub shadow_from_world: Mat4,
    /// Size of a texel in metres.
    pub texel: f32,
    /// Center of the view, and the vectors from there to its right and upper edges.
    center: Vec3,
    right: Vec3,
    up: Vec3,
}

impl ShadowView {
    /// Projects the view along the light onto a horizontal plane through `ground`. Returns x and z of its center,
    /// relative to `ground`, and of half its two edges. The light must come from above.
    pub fn on_ground(&self, to_light: Vec3, ground: Vec3) -> [[f32; 2]; 3] {
        let project = |vector: Vec3| {
            let projected = vector - to_light * (vector.y / to_light.y.max(0.05));
            [projected.x, projected.z]
        };
        [project(self.center - ground), project(self.right), project(self.up)]
    }
}

/// Fits an orthographic view along the light to the bounds, with a small margin, for a map of `size` texels along each edge.
/// `to_light` has unit length. None for empty bounds.
pub(super) fn shadow_view(bounds: &Bounds, to_light: Vec3, size: u32) -> Option<ShadowView> {
    let diagonal = bounds.diagonal();
    if bounds.is_empty() || !diagonal.is_finite() || diagonal <= 0.0 {
        return None;
    }
    let up = if to_light.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
    let center = bounds.center();
    let light_from_world = look_to_mat4(center, -to_light, up);
    let seen = Bounds::of(bounds.corners().map(|corner| light_from_world.transform_point3(corner)));
    let half = 0.5 * seen.size().truncate().max_element() * 1.06;
    let middle = seen.center();
    let margin = 0.05 * diagonal;
    let projection = orthographic(
        middle.x - half,
        middle.x + half,
        middle.y - half,
        middle.y + half,
        -seen.max.z - margin,
        -seen.min.z + margin,
    );
    let world_from_light = light_from_world.inverse();
    Some(ShadowView {
        shadow_from_world: projection * light_from_world,
        texel: 2.0 * half / size as f32,
        center: world_from_light.transform_point3(middle),
        right: world_from_light.transform_vector3(half * Vec3::X),
        up: world_from_light.transform_vector3(half * Vec3::Y),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_is_inside_the_view() {
        let bounds = Bounds { min: Vec3::new(-1.0, 0.0, 3.0), max: Vec3::new(2.0, 5.0, 4.0) };
        for to_light in [Vec3::Y, Vec3::new(-0.48, 0.72, 0.5).normalize(), Vec3::X, Vec3::NEG_Y] {
            let view = shadow_view(&bounds, to_light, 512).unwrap();
            for corner in bounds.corners() {
                let at = view.shadow_from_world.project_point3(corner);
                assert!(
                    at.truncate().abs().max_element() < 1.0 && (0.0..1.0).contains(&at.z),
                    "{to_light} {corner} {at}"
                );
            }
            let toward = view.shadow_from_world.project_point3(bounds.center() + 0.01 * to_light);
            assert!(toward.z < view.shadow_from_world.project_point3(bounds.center()).z, "{to_light}");
        }
    }

    #[test]
    fn the_ground_parallelogram_ends_where_the_map_ends() {
        let bounds = Bounds { min: Vec3::new(-1.0, 0.5, 3.0), max: Vec3::new(2.0, 5.0, 4.0) };
        let to_light = Vec3::new(-0.48, 0.72, 0.5).normalize();
        let ground = Vec3::new(0.3, 0.5, -2.0);
        let view = shadow_view(&bounds, to_light, 512).unwrap();
        let [center, x, y] = view.on_ground(to_light, ground).map(|[x, z]| Vec3::new(x, 0.0, z));
        for (right, up) in [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)] {
            let seen = view.shadow_from_world.project_point3(ground + center + right * x + up * y);
            assert!(seen.truncate().distance(glam::Vec2::new(right, up)) < 1e-4, "{seen}");
        }
    }

    #[test]
    fn empty_bounds_have_no_shadow_view() {
        assert_eq!(shadow_view(&Bounds::EMPTY, Vec3::Y, 512), None);
    }
}
