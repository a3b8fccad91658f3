//! Uniform structs have the same layout in WGSL and in Rust.

use std::collections::BTreeMap;
use std::mem::{offset_of, size_of};

use gaitway_render::shaders::MESH;
use gaitway_render::uniforms::{DrawUniform, FrameUniform, LightUniform, MaterialUniform, UvTransformUniform};
use naga::TypeInner;

/// Returns the member offsets and the size of a struct in the mesh shader.
fn in_wgsl(name: &str) -> (BTreeMap<String, usize>, usize) {
    let module = naga::front::wgsl::parse_str(&MESH.source()).unwrap();
    for (_, found) in module.types.iter() {
        if let (Some(found_name), TypeInner::Struct { members, span }) = (&found.name, &found.inner)
            && found_name == name
        {
            let offsets = members.iter().map(|member| (member.name.clone().unwrap(), member.offset as usize)).collect();
            return (offsets, *span as usize);
        }
    }
    panic!("there is no struct {name}");
}

macro_rules! check {
    ($wgsl:literal, $rust:ty, $($field:ident),+) => {{
        let (offsets, size) = in_wgsl($wgsl);
        let expected: BTreeMap<String, usize> =
            [$((stringify!($field).to_string(), offset_of!($rust, $field))),+].into();
        assert_eq!(offsets, expected, "{}", $wgsl);
        assert_eq!(size, size_of::<$rust>(), "{}", $wgsl);
    }};
}

#[test]
fn frames_and_draws_have_the_same_layout_in_wgsl_and_rust() {
    check!("Light", LightUniform, position, range, color, kind, direction, spot_scale, spot_offset);
    check!(
        "Frame",
        FrameUniform,
        projection_from_world,
        shadow_from_world,
        eye,
        exposure,
        viewport_pixels,
        light_count,
        environment_last_level,
        environment,
        shadow_texel,
        shadow_light,
        key_direction,
        ground_shadow,
        key_color,
        grid_spacing,
        ground,
        shadow_center,
        shadow_x,
        shadow_y,
        time_secs,
        padding,
        background_center,
        background_edge,
        sky_ahead,
        sky_right,
        sky_up,
        lights
    );
    check!(
        "Draw",
        DrawUniform,
        palette,
        morph_weights,
        morph_count,
        morph_attributes,
        vertices,
        influence_stride,
        heat_joint,
        channel,
        color
    );
}

#[test]
fn materials_have_the_same_layout_in_wgsl_and_rust() {
    check!("UvTransform", UvTransformUniform, matrix, offset, uv_set);
    check!(
        "Material",
        MaterialUniform,
        base_color,
        emissive,
        alpha_cutoff,
        metallic,
        roughness,
        normal_scale,
        occlusion_strength,
        specular_color,
        specular,
        sheen_color,
        sheen_roughness,
        absorption,
        thickness,
        diffuse_transmission_color,
        diffuse_transmission,
        clearcoat,
        clearcoat_roughness,
        clearcoat_normal_scale,
        ior,
        iridescence,
        iridescence_ior,
        iridescence_thickness,
        anisotropy_direction,
        anisotropy,
        transmission,
        dispersion,
        shading_shift,
        shading_shift_scale,
        shading_toony,
        shade_color,
        gi_equalization,
        matcap_color,
        rim_lighting_mix,
        rim_color,
        rim_fresnel_power,
        outline_color,
        outline_lighting_mix,
        rim_lift,
        outline_width,
        outline_on_screen,
        uv_rotation,
        uv_scroll,
        uvs
    );
}
