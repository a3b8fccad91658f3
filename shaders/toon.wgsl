// MToon (VRMC_materials_mtoon-1.0): lit and shade colour for each light, even ambient light, rim and outline.

#if TOON
// Displacement of the outline's vertices.
fn outline_offset(in: VertexIn, shape: Shape) -> vec3f {
    var width = material.outline_width * outline_width_texel(in.uv).g;
    if material.outline_on_screen == 1u {
        let to_clip = frame.projection_from_world;
        let clip = to_clip * vec4f(shape.position, 1.0);
        // Two units of normalized device coordinates are the picture's height.
        width *= 2.0 * clip.w / length(vec3f(to_clip[0].y, to_clip[1].y, to_clip[2].y));
    }
    return width * normalize_or_zero(shape.normal);
}

// Turns texture coordinates about their middle, then moves them.
fn animated_uv(uv: vec4f) -> vec4f {
    let time = frame.time_secs * uv_animation_mask_texel(uv).b;
    let turn = time * material.uv_rotation;
    let rotation = mat2x2f(cos(turn), -sin(turn), sin(turn), cos(turn));
    let middle = 0.5 + time * material.uv_scroll;
    return vec4f(rotation * (uv.xy - 0.5) + middle, rotation * (uv.zw - 0.5) + middle);
}

// 0 in shade, 1 in light.
fn toon_step(cosine: f32, shift: f32) -> f32 {
    return clamp(0.5 + (cosine + shift) / max(2.0 * (1.0 - material.shading_toony), 1e-3), 0.0, 1.0);
}

@fragment
fn lit(at_rest: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let base = base_color(at_rest);
    var in = at_rest;
    in.uv = animated_uv(in.uv);
    let shade = material.shade_color * shade_multiply_texel(in.uv).rgb;
    var shift = material.shading_shift;
#if SHADING_SHIFT_MAP
    shift += material.shading_shift_scale * shading_shift_texel(in.uv).r;
#endif
    let normal = surface_normal(in, front || OUTLINE);
    let to_eye = normalize(in.to_eye);
    let world = frame.eye - in.to_eye;
    var shadow = 1.0;
    if SHADOW {
        shadow = mesh_shadow(world, normal);
    }

    let even = 0.5 * (environment_diffuse(vec3f(0.0, 1.0, 0.0)) + environment_diffuse(vec3f(0.0, -1.0, 0.0)));
    var received = mix(environment_diffuse(normal), even, material.gi_equalization);
    var color = base.rgb * received;
    if FILE_LIGHTS {
        for (var index = 0u; index < frame.light_count; index++) {
            var to_light: vec3f;
            let light = light_at(frame.lights[index], world, &to_light) / PI;
            let lit = toon_step(dot(normal, to_light), shift) * select(1.0, shadow, index == frame.shadow_light);
            color += light * mix(shade, base.rgb, lit);
            received += light;
        }
    } else {
        let light = frame.key_color / PI;
        color += light * mix(shade, base.rgb, shadow * toon_step(dot(normal, frame.key_direction), shift));
        received += light;
    }

    let grazing = clamp(1.0 - dot(normal, to_eye) + material.rim_lift, 0.0, 1.0);
    var rim = material.rim_color * pow(grazing, material.rim_fresnel_power);
#if MATCAP_MAP
    let right = normalize_or_zero(vec3f(to_eye.z, 0.0, -to_eye.x));
    let up = cross(to_eye, right);
    // Half the texture, less a margin that keeps filtering inside.
    let at = 0.5 + 0.495 * vec2f(dot(right, normal), -dot(up, normal));
    rim += material.matcap_color * matcap_texel(vec4f(at, at)).rgb;
#endif
    rim *= rim_multiply_texel(in.uv).rgb;
    color += rim * mix(vec3f(1.0), received, material.rim_lighting_mix) + emissive(in);
    if OUTLINE {
        color = material.outline_color * mix(vec3f(1.0), color, material.outline_lighting_mix);
    }
    return finish(tone_map(frame.exposure * color), base.a);
}
#endif
