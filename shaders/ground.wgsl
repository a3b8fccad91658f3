// The ground: it only catches the shadow and shows the grid; everything else of it is clear.

struct GroundOut {
    @builtin(position) position: vec4f,
    // From the middle of the ground, metres.
    @location(0) offset: vec2f,
}

override GROUND_SHADOW: bool = false;
override GRID: bool = false;

@vertex
fn ground_vertex(@builtin(vertex_index) vertex: u32) -> GroundOut {
    // An octagon as a fan of six triangles around its first corner.
    let corner = select(vertex / 3u + vertex % 3u, 0u, vertex % 3u == 0u);
    let angle = f32(corner) * 0.78539816 + 0.39269908;
    let offset = frame.ground.w * 1.0824 * vec2f(cos(angle), -sin(angle));
    let world = vec3f(frame.ground.x + offset.x, frame.ground.y, frame.ground.z + offset.y);
    return GroundOut(frame.projection_from_world * vec4f(world, 1.0), offset);
}

// How much of a pixel the lines of a grid cover; lines are `width` pixels wide.
fn grid_lines(at: vec2f, per_pixel: vec2f, spacing: f32, width: f32) -> f32 {
    let cells = at / spacing;
    let cells_per_pixel = per_pixel / spacing;
    let distance = abs(fract(cells - 0.5) - 0.5) / max(cells_per_pixel, vec2f(1e-9));
    let coverage = clamp(0.5 * width + 0.5 - distance, vec2f(0.0), vec2f(1.0));
    // Lines closer than a few pixels turn to nothing rather than to noise.
    let fade = clamp(1.5 - 4.0 * cells_per_pixel, vec2f(0.0), vec2f(1.0));
    return max(coverage.x * fade.x, coverage.y * fade.y);
}

fn axis_line(at: f32, per_pixel: f32) -> f32 {
    return clamp(1.25 - abs(at) / max(per_pixel, 1e-9), 0.0, 1.0);
}

// Soft: 12 taps in a spiral, each of four texels.
fn soft_shadow(world: vec3f, pixel: vec2f) -> f32 {
    let at = shadow_coordinates(world);
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    let turn = 6.2831853 * fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
    var lit = 0.0;
    for (var tap = 0u; tap < 12u; tap++) {
        let angle = turn + 2.3999632 * f32(tap);
        let radius = 5.0 * sqrt((f32(tap) + 0.5) / 12.0);
        lit += shadow_tap(at, texel * radius * vec2f(cos(angle), sin(angle)));
    }
    return lit / 12.0;
}

@fragment
fn ground_fragment(in: GroundOut) -> @location(0) vec4f {
    let fade = 1.0 - smoothstep(0.4, 1.0, length(in.offset) / frame.ground.w);
    let world = vec3f(frame.ground.x + in.offset.x, frame.ground.y, frame.ground.z + in.offset.y);
    var color = vec3f(0.0);
    var alpha = 0.0;
    if GRID {
        let per_pixel = fwidth(in.offset);
        let spacing = frame.grid_spacing;
        let thin = 0.16 * grid_lines(world.xz, per_pixel, spacing, 1.0);
        let thick = 0.30 * grid_lines(world.xz, per_pixel, 10.0 * spacing, 1.0);
        alpha = max(thin, thick);
        let x_axis = 0.55 * axis_line(world.z, per_pixel.y);
        let z_axis = 0.55 * axis_line(world.x, per_pixel.x);
        color = mix(vec3f(0.02), vec3f(0.45, 0.04, 0.05), clamp(2.0 * x_axis, 0.0, 1.0));
        color = mix(color, vec3f(0.03, 0.10, 0.50), clamp(2.0 * z_axis, 0.0, 1.0));
        alpha = max(alpha, max(x_axis, z_axis)) * fade;
    }
    if GROUND_SHADOW {
        let dark = frame.ground_shadow * (1.0 - soft_shadow(world, in.position.xy)) * fade;
        // The shadow falls over the lines.
        color *= 1.0 - dark;
        alpha = 1.0 - (1.0 - alpha) * (1.0 - dark);
        color *= select(0.0, 1.0, alpha > dark);
    }
    return vec4f(color * alpha, alpha);
}
