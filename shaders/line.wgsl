// Overlay lines: one screen-space quad each, its width in pixels.

struct LineIn {
    @location(0) from_world: vec3f,
    @location(1) width_pixels: f32,
    @location(2) to_world: vec3f,
    @location(3) color: vec4f,
}

struct LineOut {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
    // Distance across the line and half its width, in pixels.
    @location(1) across: vec2f,
}

// Clips an end point to the near plane.
fn before_near(end: vec4f, other: vec4f) -> vec4f {
    if end.z >= 0.0 || other.z <= end.z {
        return end;
    }
    return mix(end, other, clamp(end.z / (end.z - other.z), 0.0, 1.0));
}

@vertex
fn line_vertex(@builtin(vertex_index) vertex: u32, in: LineIn) -> LineOut {
    let from_raw = frame.projection_from_world * vec4f(in.from_world, 1.0);
    let to_raw = frame.projection_from_world * vec4f(in.to_world, 1.0);
    let a = before_near(from_raw, to_raw);
    let b = before_near(to_raw, from_raw);
    let half_viewport = 0.5 * frame.viewport_pixels;
    let along = (b.xy / max(b.w, 1e-9) - a.xy / max(a.w, 1e-9)) * half_viewport;
    let length_pixels = length(along);
    let direction = select(vec2f(1.0, 0.0), along / max(length_pixels, 1e-9), length_pixels > 1e-6);
    // Two triangles; half a pixel extra on each side for antialiasing.
    let at_end = vertex == 1u || vertex == 2u || vertex == 4u;
    let side = select(-1.0, 1.0, vertex == 2u || vertex == 4u || vertex == 5u);
    let half_width = 0.5 * in.width_pixels + 0.5;
    var position = a;
    if at_end {
        position = b;
    }
    let offset = side * half_width * vec2f(-direction.y, direction.x) / half_viewport;
    position = vec4f(position.xy + offset * position.w, position.z, position.w);
    return LineOut(position, vec4f(srgb_from_linear(in.color.rgb), in.color.a), vec2f(side * half_width, half_width));
}

@fragment
fn line_fragment(in: LineOut) -> @location(0) vec4f {
    let alpha = in.color.a * clamp(in.across.y - abs(in.across.x), 0.0, 1.0);
    return vec4f(in.color.rgb * alpha, alpha);
}
