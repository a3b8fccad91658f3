//! Converts a frame to the uniform that all shaders share.

use gaitway_character::asset::{LightKind, MAX_LIGHTS};
use gaitway_scene::frame::{Frame, FrameLight};
use gaitway_scene::state::KeyLight;
use glam::{Mat3, Vec3};

use super::environment::DirectionalLight;
use super::light::LightSources;
use super::shadow::shadow_view;
use super::uniforms::{FrameUniform, LightUniform};

/// sRGB colours of the studio backdrop, at the center and at the edge.
const STUDIO_CENTER: [f32; 4] = [0.735, 0.748, 0.767, 1.0];
const STUDIO_EDGE: [f32; 4] = [0.496, 0.512, 0.547, 1.0];
/// Opacity of the shadow on the ground.
const GROUND_SHADOW: f32 = 0.32;
/// No light casts a shadow on meshes.
const NO_SHADOW: u32 = u32::MAX;

/// The visible part of the ground.
pub(super) struct GroundPlane {
    pub center: Vec3,
    pub radius: f32,
    pub spacing: f32,
    pub grid: bool,
    pub shadow: bool,
}

impl GroundPlane {
    /// None without a grid or shadow to show.
    pub fn of(frame: &Frame) -> Option<Self> {
        let bounds = &frame.bounds;
        let shadow = frame.look.shadow && frame.look.mesh && !bounds.is_empty();
        match frame.look.grid {
            Some(grid) => Some(Self {
                center: grid.center.with_y(grid.height),
                radius: grid.radius,
                spacing: grid.spacing,
                grid: true,
                // Seen from below, the ground is transparent.
                shadow: shadow && frame.view.eye.y > grid.height,
            }),
            None if shadow => Some(Self {
                center: bounds.center().with_y(frame.look.ground_height),
                radius: 2.5 * bounds.diagonal(),
                spacing: 1.0,
                grid: false,
                shadow: frame.view.eye.y > frame.look.ground_height,
            }),
            None => None,
        }
    }
}

/// Returns the scene pass's uniform and, if something casts a shadow, the shadow pass's with the light's projection.
pub(super) fn frame_uniform(
    frame: &Frame,
    ground: Option<&GroundPlane>,
    size: [f32; 2],
    light: &LightSources,
) -> (FrameUniform, Option<FrameUniform>) {
    let look = &frame.look;
    let (sin, cos) = look.environment_radians.sin_cos();
    let key = look.key.map_or(light.environment.key, directional_light);
    let key_direction = Mat3::from_rotation_y(look.environment_radians) * key.direction;
    let [sky_ahead, sky_right, sky_up] = sky_directions(frame);
    // The file's first directional light from above casts the shadow. With other lights only, the key light casts one
    // on the ground but not on meshes.
    let sun = frame
        .lights
        .iter()
        .take(MAX_LIGHTS)
        .position(|light| light.kind == LightKind::Directional && light.direction.normalize_or_zero().y < -0.15);
    let (to_light, shadow_light) = match sun {
        Some(index) => (-frame.lights[index].direction.normalize_or_zero(), index as u32),
        None if frame.lights.is_empty() => (key_direction, 0),
        None => (key_direction, NO_SHADOW),
    };
    let shadow =
        if look.shadow && look.mesh { shadow_view(&frame.bounds, to_light, light.shadow_map.size) } else { None };
    let on_ground = ground.zip(shadow.as_ref()).map(|(ground, view)| view.on_ground(to_light, ground.center));
    let mut uniform = FrameUniform {
        projection_from_world: (frame.view.projection_from_view * frame.view.view_from_world).to_cols_array_2d(),
        shadow_from_world: shadow.map_or_else(Default::default, |view| view.shadow_from_world.to_cols_array_2d()),
        eye: frame.view.eye.to_array(),
        exposure: look.exposure.max(1e-6),
        viewport_pixels: size,
        light_count: frame.lights.len().min(MAX_LIGHTS) as u32,
        environment_last_level: light.environment.last_level as f32,
        environment: [cos, sin],
        shadow_texel: shadow.map_or(0.0, |view| view.texel),
        shadow_light,
        key_direction: key_direction.to_array(),
        ground_shadow: GROUND_SHADOW,
        key_color: key.color.to_array(),
        grid_spacing: ground.map_or(1.0, |ground| ground.spacing),
        ground: ground.map_or([0.0; 4], |ground| ground.center.extend(ground.radius).to_array()),
        background_center: STUDIO_CENTER,
        background_edge: STUDIO_EDGE,
        shadow_center: on_ground.map_or([0.0; 2], |[center, ..]| center),
        shadow_x: on_ground.map_or([0.0; 2], |[_, x, _]| x),
        shadow_y: on_ground.map_or([0.0; 2], |[.., y]| y),
        time_secs: look.time_secs,
        padding: 0.0,
        sky_ahead,
        sky_right,
        sky_up,
        lights: Default::default(),
    };
    for (slot, light) in uniform.lights.iter_mut().zip(&frame.lights) {
        *slot = light_uniform(light);
    }
    let from_light = shadow.map(|view| {
        let mut from_light = uniform;
        from_light.projection_from_world = view.shadow_from_world.to_cols_array_2d();
        from_light
    });
    (uniform, from_light)
}

fn directional_light(key: KeyLight) -> DirectionalLight {
    let (yaw_sin, yaw_cos) = key.yaw_degrees.to_radians().sin_cos();
    let (pitch_sin, pitch_cos) = key.pitch_degrees.to_radians().sin_cos();
    // Irradiance π gives a white diffuse surface radiance 1.
    let color = Vec3::splat(std::f32::consts::PI * key.strength);
    DirectionalLight { direction: Vec3::new(yaw_sin * pitch_cos, pitch_sin, yaw_cos * pitch_cos), color }
}

/// Directions in the environment: at the center of a pane, and what x and y in normalized device coordinates add to it.
fn sky_directions(frame: &Frame) -> [[f32; 4]; 3] {
    let projection = frame.view.projection_from_view;
    let environment_from_view = Mat3::from_rotation_y(-frame.look.environment_radians)
        * Mat3::from_mat4(frame.view.view_from_world).transpose();
    let [width, height] = [projection.x_axis.x, projection.y_axis.y];
    let is_parallel = projection.w_axis.w == 1.0;
    let ahead = match is_parallel {
        true => Vec3::NEG_Z,
        false => Vec3::new(projection.z_axis.x / width, projection.z_axis.y / height, -1.0),
    };
    // Without perspective, every pixel looks the same way.
    let scale = if is_parallel { 0.0 } else { 1.0 };
    [ahead, Vec3::X * (scale / width), Vec3::Y * (scale / height)]
        .map(|direction| (environment_from_view * direction).extend(0.0).to_array())
}

fn light_uniform(light: &FrameLight) -> LightUniform {
    let (kind, spot_scale, spot_offset) = match light.kind {
        LightKind::Directional => (0, 0.0, 0.0),
        LightKind::Point => (1, 0.0, 0.0),
        LightKind::Spot { inner_cone_radians, outer_cone_radians } => {
            // As recommended by KHR_lights_punctual.
            let outer = outer_cone_radians.cos();
            let scale = 1.0 / (inner_cone_radians.cos() - outer).max(0.001);
            (2, scale, -outer * scale)
        }
    };
    LightUniform {
        position: light.position.to_array(),
        range: light.range,
        color: light.color.to_array(),
        kind,
        direction: light.direction.normalize_or_zero().to_array(),
        spot_scale,
        spot_offset,
        padding: [0.0; 3],
    }
}
