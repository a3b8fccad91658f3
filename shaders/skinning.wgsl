// Morphing and skinning, equivalent to crates/character/src/mesh/skinning.rs on the CPU.

struct Draw {
    // First palette entry.
    palette: u32,
    // First texel of the morph weights in the palette texture.
    morph_weights: u32,
    morph_count: u32,
    // Texels per vertex and target: 1 position, 2 also normal, 3 also tangent.
    morph_attributes: u32,
    vertices: u32,
    // Influences per vertex in the influence texture.
    influence_stride: u32,
    // Joint of the heat map; 0xffffffff for none.
    heat_joint: u32,
    // What the surface shows; see channel.wgsl.
    channel: u32,
    // Wireframe colour, sRGB.
    color: vec4f,
}

@group(2) @binding(0) var<uniform> draw: Draw;
@group(3) @binding(11) var morph_deltas: texture_2d<f32>;
@group(3) @binding(12) var influences: texture_2d<f32>;

// 0 linear, 1 rigid, 2 dual quaternion.
override SKINNING: u32 = 0u;

const MODE_RIGID: u32 = 1u;
const MODE_DUAL_QUATERNION: u32 = 2u;
const VERTEX_TEXTURE_WIDTH: u32 = 2048u;
const VERTEX_TEXTURE_SHIFT: u32 = 11u;

struct Shape {
    position: vec3f,
    normal: vec3f,
    tangent: vec3f,
}

// p' = rotation · (linear · p) + translation
struct Blend {
    linear: mat3x3f,
    rotation: vec4f,
    translation: vec3f,
}

// Weighted sum of palette entries, per texel.
struct Sum {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
    e: vec4f,
}

fn load_vertex_texel(source: texture_2d<f32>, index: u32) -> vec4f {
    return textureLoad(source, vec2i(i32(index & (VERTEX_TEXTURE_WIDTH - 1u)), i32(index >> VERTEX_TEXTURE_SHIFT)), 0);
}

// Rotation of the first joint. q and −q are the same rotation, so all are flipped into its hemisphere.
fn pivot_of(joint: u32) -> vec4f {
    if SKINNING == MODE_DUAL_QUATERNION {
        return palette_row(draw.palette + joint, 0u);
    }
    return vec4f();
}

// Branch-free, because software renderers execute both sides of a branch: unused influences repeat the first joint.
fn add_influence(sum: Sum, pivot: vec4f, joint: u32, weight: f32) -> Sum {
    let entry = draw.palette + joint;
    let first = palette_row(entry, 0u);
    var signed_weight = weight;
    var d = sum.d;
    var e = sum.e;
    if SKINNING == MODE_DUAL_QUATERNION {
        signed_weight = select(weight, -weight, dot(pivot, first) < 0.0);
        d += weight * palette_row(entry, 3u);
        e += weight * palette_row(entry, 4u);
    }
    return Sum(
        sum.a + signed_weight * first,
        sum.b + signed_weight * palette_row(entry, 1u),
        sum.c + weight * palette_row(entry, 2u),
        d,
        e,
    );
}

fn add_4(sum: Sum, pivot: vec4f, joints: vec4u, weights: vec4f) -> Sum {
    let one = add_influence(sum, pivot, joints.x, weights.x);
    let two = add_influence(one, pivot, joints.y, weights.y);
    let three = add_influence(two, pivot, joints.z, weights.z);
    return add_influence(three, pivot, joints.w, weights.w);
}

fn single(joint: u32) -> Blend {
    return blend_from_sum(add_influence(Sum(), pivot_of(joint), joint, 1.0));
}

fn blend_from_sum(sum: Sum) -> Blend {
    if SKINNING != MODE_DUAL_QUATERNION {
        return linear_blend(sum.a, sum.b, sum.c);
    }
    var blend = linear_blend(sum.c, sum.d, sum.e);
    let real_length = length(sum.a);
    if real_length > 0.0 {
        let real = sum.a / real_length;
        let dual = sum.b / real_length;
        blend.rotation = real;
        blend.translation = 2.0 * (real.w * dual.xyz - dual.w * real.xyz + cross(real.xyz, dual.xyz));
    }
    return blend;
}

fn linear_blend(x: vec4f, y: vec4f, z: vec4f) -> Blend {
    return Blend(transpose(mat3x3f(x.xyz, y.xyz, z.xyz)), vec4f(0.0, 0.0, 0.0, 1.0), vec3f(x.w, y.w, z.w));
}

fn rotate(rotation: vec4f, vector: vec3f) -> vec3f {
    if SKINNING != MODE_DUAL_QUATERNION {
        return vector;
    }
    return vector + 2.0 * cross(rotation.xyz, cross(rotation.xyz, vector) + rotation.w * vector);
}

fn normalize_or_zero(vector: vec3f) -> vec3f {
    let squared = dot(vector, vector);
    return select(vec3f(0.0), vector * inverseSqrt(max(squared, 1e-38)), squared > 0.0);
}

fn blend_normal(blend: Blend, normal: vec3f) -> vec3f {
    // The cofactor matrix is the inverse transpose times the determinant: it needs no division and handles zero scales.
    let m = blend.linear;
    let cofactor = mat3x3f(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
    let side = select(1.0, -1.0, dot(m[0], cofactor[0]) < 0.0);
    return rotate(blend.rotation, normalize_or_zero(side * (cofactor * normal)));
}

fn morph(vertex: u32, base: Shape) -> Shape {
    var shape = base;
    for (var index = 0u; index < draw.morph_count; index++) {
        let target_weight = morph_weight(draw.morph_weights, index);
        let texel = (u32(target_weight.x) * draw.vertices + vertex) * draw.morph_attributes;
        shape.position += target_weight.y * load_vertex_texel(morph_deltas, texel).xyz;
        if draw.morph_attributes > 1u {
            shape.normal += target_weight.y * load_vertex_texel(morph_deltas, texel + 1u).xyz;
        }
        if draw.morph_attributes > 2u {
            shape.tangent += target_weight.y * load_vertex_texel(morph_deltas, texel + 2u).xyz;
        }
    }
    return shape;
}

// From mesh space to the palette's target space.
fn deform(vertex: u32, base: Shape, blend: Blend) -> Shape {
    let shape = morph(vertex, base);
    return Shape(
        rotate(blend.rotation, blend.linear * shape.position) + blend.translation,
        blend_normal(blend, shape.normal),
        rotate(blend.rotation, blend.linear * shape.tangent),
    );
}

fn blend_4(joints: vec4u, weights: vec4f) -> Blend {
    if SKINNING == MODE_RIGID {
        return single(joints.x);
    }
    return blend_from_sum(add_4(Sum(), pivot_of(joints.x), joints, weights));
}

fn blend_8(joints_0: vec4u, weights_0: vec4f, joints_1: vec4u, weights_1: vec4f) -> Blend {
    if SKINNING == MODE_RIGID {
        return single(joints_0.x);
    }
    let pivot = pivot_of(joints_0.x);
    return blend_from_sum(add_4(add_4(Sum(), pivot, joints_0, weights_0), pivot, joints_1, weights_1));
}

// Two influences per texel: joint, weight, joint, weight.
fn influence_pair(vertex: u32, pair: u32) -> vec4f {
    return load_vertex_texel(influences, vertex * (draw.influence_stride / 2u) + pair);
}

fn blend_texture(vertex: u32) -> Blend {
    let strongest = u32(influence_pair(vertex, 0u).x);
    if SKINNING == MODE_RIGID {
        return single(strongest);
    }
    let pivot = pivot_of(strongest);
    var sum = Sum();
    for (var pair = 0u; pair < draw.influence_stride / 2u; pair++) {
        let texel = influence_pair(vertex, pair);
        sum = add_influence(sum, pivot, u32(texel.x), texel.y);
        sum = add_influence(sum, pivot, u32(texel.z), texel.w);
    }
    return blend_from_sum(sum);
}

#if CHANNEL
// Number of influences with a weight.
fn heat_4(joints: vec4u, weights: vec4f) -> f32 {
    return dot(vec4f(1.0), select(vec4f(0.0), vec4f(1.0), weights > vec4f(0.0)));
}

fn heat_texture(vertex: u32) -> f32 {
    var count = 0.0;
    for (var pair = 0u; pair < draw.influence_stride / 2u; pair++) {
        let texel = influence_pair(vertex, pair);
        count += dot(vec2f(1.0), select(vec2f(0.0), vec2f(1.0), texel.yw > vec2f(0.0)));
    }
    return count;
}
#else
// Weight of the heat map's joint.
fn heat_4(joints: vec4u, weights: vec4f) -> f32 {
    return dot(weights, select(vec4f(0.0), vec4f(1.0), joints == vec4u(draw.heat_joint)));
}

fn heat_texture(vertex: u32) -> f32 {
    var heat = 0.0;
    for (var pair = 0u; pair < draw.influence_stride / 2u; pair++) {
        let texel = influence_pair(vertex, pair);
        let hits = select(vec2f(0.0), vec2f(1.0), vec2u(texel.xz) == vec2u(draw.heat_joint));
        heat += dot(texel.yw, hits);
    }
    return heat;
}
#endif
