// The ground: transparent except for the grid and the shadow.

struct GroundOut {
    @builtin(position) position: vec4f,
    // From the center of the ground, metres.
    @location(0) offset: vec2f,
}

// Fewer on software adapters.
override SHADOW_TAPS: u32 = 12u;

fn ground_out(offset: vec2f) -> GroundOut {
    let world = vec3f(frame.ground.x + offset.x, frame.ground.y, frame.ground.z + offset.y);
    return GroundOut(frame.projection_from_world * vec4f(world, 1.0), offset);
}

fn ground_fade(offset: vec2f) -> f32 {
    return 1.0 - smoothstep(0.4, 1.0, length(offset) / frame.ground.w);
}

@vertex
fn grid_vertex(@builtin(vertex_index) vertex: u32) -> GroundOut {
    // An octagon as a fan of six triangles.
    let corner = select(vertex / 3u + vertex % 3u, 0u, vertex % 3u == 0u);
    let angle = f32(corner) * 0.78539816 + 0.39269908;
    return ground_out(frame.ground.w * 1.0824 * vec2f(cos(angle), -sin(angle)));
}

// Coverage of a pixel by grid lines `width` pixels wide.
fn grid_lines(at: vec2f, per_pixel: vec2f, spacing: f32, width: f32) -> f32 {
    let cells = at / spacing;
    let cells_per_pixel = per_pixel / spacing;
    let distance = abs(fract(cells - 0.5) - 0.5) / max(cells_per_pixel, vec2f(1e-9));
    let coverage = clamp(0.5 * width + 0.5 - distance, vec2f(0.0), vec2f(1.0));
    // Fades out lines only a few pixels apart, which would alias.
    let fade = clamp(1.5 - 4.0 * cells_per_pixel, vec2f(0.0), vec2f(1.0));
    return max(coverage.x * fade.x, coverage.y * fade.y);
}

fn axis_line(at: f32, per_pixel: f32) -> f32 {
    return clamp(1.25 - abs(at) / max(per_pixel, 1e-9), 0.0, 1.0);
}

@fragment
fn grid_fragment(in: GroundOut) -> @location(0) vec4f {
    let at = frame.ground.xz + in.offset;
    let per_pixel = fwidth(in.offset);
    let thin = 0.10 * grid_lines(at, per_pixel, frame.grid_spacing, 1.0);
    let thick = 0.20 * grid_lines(at, per_pixel, 10.0 * frame.grid_spacing, 1.0);
    let x_axis = 0.5 * axis_line(at.y, per_pixel.y);
    let z_axis = 0.5 * axis_line(at.x, per_pixel.x);
    var color = mix(vec3f(0.15), vec3f(0.70, 0.22, 0.25), clamp(2.0 * x_axis, 0.0, 1.0));
    color = mix(color, vec3f(0.19, 0.35, 0.74), clamp(2.0 * z_axis, 0.0, 1.0));
    let alpha = max(max(thin, thick), max(x_axis, z_axis)) * ground_fade(in.offset);
    return vec4f(color * alpha, alpha);
}

// Covers only the part of the ground inside the shadow map.
@vertex
fn shadow_vertex(@builtin(vertex_index) vertex: u32) -> GroundOut {
    let right = vertex == 1u || vertex == 2u || vertex == 4u;
    let up = vertex == 2u || vertex == 4u || vertex == 5u;
    return ground_out(select(-frame.shadow_x, frame.shadow_x, right) + select(-frame.shadow_y, frame.shadow_y, up)
        + frame.shadow_center);
}

// A spiral of taps, each filtering four texels.
fn soft_shadow(world: vec3f, pixel: vec2f) -> f32 {
    let at = shadow_coordinates(world);
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    if SHADOW_TAPS <= 4u {
        let a = 1.5 * texel * vec2f(0.4, 0.9);
        let b = 1.5 * texel * vec2f(0.9, -0.4);
        return 0.25 * (shadow_tap(at, a) + shadow_tap(at, b) + shadow_tap(at, -a) + shadow_tap(at, -b));
    }
    let turn = 6.2831853 * fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
    var lit = 0.0;
    for (var tap = 0u; tap < SHADOW_TAPS; tap++) {
        let angle = turn + 2.3999632 * f32(tap);
        let radius = 5.0 * sqrt((f32(tap) + 0.5) / f32(SHADOW_TAPS));
        lit += shadow_tap(at, texel * radius * vec2f(cos(angle), sin(angle)));
    }
    return lit / f32(SHADOW_TAPS);
}

@fragment
fn shadow_fragment(in: GroundOut) -> @location(0) vec4f {
    let world = vec3f(frame.ground.x + in.offset.x, frame.ground.y, frame.ground.z + in.offset.y);
    let dark = frame.ground_shadow * (1.0 - soft_shadow(world, in.position.xy)) * ground_fade(in.offset);
    return vec4f(0.0, 0.0, 0.0, dark);
}
