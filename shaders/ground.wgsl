// The ground: transparent except for the grid and the shadow.

struct GroundOut {
    @builtin(position) position: vec4f,
    // From the center of the ground, metres.
    @location(0) offset: vec2f,
}

// 4 on software adapters, where the shadow is equally soft everywhere.
override SHADOW_TAPS: u32 = 16u;

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

// Offset of a tap on a spiral that fills the unit disc.
fn spiral(tap: u32, taps: u32, turn: f32) -> vec2f {
    let angle = turn + 2.3999632 * f32(tap);
    return sqrt((f32(tap) + 0.5) / f32(taps)) * vec2f(cos(angle), sin(angle));
}

// Radii in texels: of the blocker search, and of the sharpest and the softest penumbra.
const SEARCH_RADIUS: f32 = 18.0;
const MIN_RADIUS: f32 = 1.5;
const MAX_RADIUS: f32 = 12.0;
const SEARCH_TAPS: u32 = 12u;
// Penumbra radius relative to the blocker's distance from the ground.
const LIGHT_SIZE: f32 = 0.03;
// Heights in texels that the search distinguishes.
const LOW: f32 = 24.0;
const HIGH: f32 = 240.0;
// Maximum darkening where something touches the ground.
const CONTACT: f32 = 0.5;

// Compares with the ground's own depth at the offset, raised by `height`. Otherwise slanting light would leak under
// whatever stands on the ground.
fn ground_tap(at: vec3f, slope: vec2f, offset: vec2f, height: f32) -> f32 {
    return shadow_tap(vec3f(at.xy, min(at.z + dot(slope, offset), 1.0) - height), offset);
}

// Opacity of the shadow, with penumbrae that grow with the blocker's distance (percentage-closer soft shadows, Fernando
// 2005). WebGL2 can't both compare with and read a depth texture, so comparisons at several heights estimate the
// distance. Blockers close to the ground also occlude ambient light.
fn ground_shade(world: vec3f, pixel: vec2f) -> f32 {
    let at = shadow_coordinates(world);
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    // Gradient of the ground's depth across the map, and depth per texel along the light.
    let m = frame.shadow_from_world;
    let depth = vec3f(m[0].z, m[1].z, m[2].z);
    let slope = 2.0 * vec2f(dot(depth.xz, frame.shadow_x), -dot(depth.xz, frame.shadow_y));
    let step = frame.shadow_texel * length(depth);
    if SHADOW_TAPS <= 4u {
        let a = 1.5 * texel * vec2f(0.4, 0.9);
        let b = 1.5 * texel * vec2f(0.9, -0.4);
        let lit = ground_tap(at, slope, a, 0.0) + ground_tap(at, slope, b, 0.0) + ground_tap(at, slope, -a, 0.0)
            + ground_tap(at, slope, -b, 0.0);
        return frame.ground_shadow * (1.0 - 0.25 * lit);
    }
    let turn = 6.2831853 * fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
    // Fractions of the surroundings in which a blocker is above each height.
    var above = vec3f(0.0);
    for (var tap = 0u; tap < SEARCH_TAPS; tap++) {
        let offset = SEARCH_RADIUS * texel * spiral(tap, SEARCH_TAPS, turn);
        above += 1.0 - vec3f(ground_tap(at, slope, offset, 0.0), ground_tap(at, slope, offset, LOW * step),
            ground_tap(at, slope, offset, HIGH * step));
    }
    above /= f32(SEARCH_TAPS);
    let distance = dot(above, vec3f(0.5 * LOW, 0.5 * HIGH, HIGH)) / max(above.x, 1e-3);
    let radius = clamp(LIGHT_SIZE * distance, MIN_RADIUS, MAX_RADIUS);
    var lit = 0.0;
    for (var tap = 0u; tap < SHADOW_TAPS; tap++) {
        lit += ground_tap(at, slope, radius * texel * spiral(tap, SHADOW_TAPS, turn), 0.0);
    }
    let shadow = frame.ground_shadow * (1.0 - lit / f32(SHADOW_TAPS));
    return 1.0 - (1.0 - shadow) * (1.0 - CONTACT * (above.x - above.y));
}

@fragment
fn shadow_fragment(in: GroundOut) -> @location(0) vec4f {
    let world = vec3f(frame.ground.x + in.offset.x, frame.ground.y, frame.ground.z + in.offset.y);
    let dark = ground_shade(world, in.position.xy) * ground_fade(in.offset);
    return vec4f(0.0, 0.0, 0.0, dark);
}
