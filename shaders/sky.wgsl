// The environment as a background, sharp or out of focus.

@group(1) @binding(0) var environment: texture_cube<f32>;
@group(1) @binding(1) var environment_sampler: sampler;
@group(1) @binding(2) var panorama: texture_2d<f32>;

struct SkyOut {
    @builtin(position) position: vec4f,
    @location(0) direction: vec3f,
}

@vertex
fn sky_vertex(@builtin(vertex_index) vertex: u32) -> SkyOut {
    let at = vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 4.0 - 1.0;
    let direction = frame.sky_ahead + at.x * frame.sky_right + at.y * frame.sky_up;
    return SkyOut(vec4f(at, 1.0, 1.0), direction.xyz);
}

fn display(radiance: vec3f) -> vec4f {
    return vec4f(srgb_from_linear(tone_map(frame.exposure * radiance)), 1.0);
}

// The mapping of `Panorama::radiance`.
@fragment
fn sky_sharp(in: SkyOut) -> @location(0) vec4f {
    let direction = normalize(in.direction);
    let at = vec2f(atan2(direction.z, direction.x) * 0.15915494 + 0.5, acos(clamp(direction.y, -1.0, 1.0)) * 0.31830989);
    return display(textureSampleLevel(panorama, environment_sampler, at, 0.0).rgb);
}

// Several taps hide the low resolution of a rough level.
@fragment
fn sky_blurred(in: SkyOut) -> @location(0) vec4f {
    let direction = normalize(in.direction);
    let helper = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(direction.y) > 0.7);
    let right = normalize(cross(direction, helper));
    let up = cross(right, direction);
    var sum = vec3f(0.0);
    for (var tap = 0u; tap < 12u; tap++) {
        let angle = 2.3999632 * f32(tap);
        let offset = 0.12 * sqrt((f32(tap) + 0.5) / 12.0) * (cos(angle) * right + sin(angle) * up);
        sum += textureSampleLevel(environment, environment_sampler, direction + offset, 0.4 * frame.environment_last_level).rgb;
    }
    return display(sum / 12.0);
}
