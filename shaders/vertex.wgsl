// Vertex stages of meshes: one per source of influences, for the scene pass and for the shadow pass.

struct VertexIn {
    @builtin(vertex_index) vertex: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    // Both sets.
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
}

struct Influences4 {
    @location(5) joints: vec4u,
    @location(6) weights: vec4f,
}

struct Influences8 {
    @location(5) joints_0: vec4u,
    @location(6) weights_0: vec4f,
    @location(7) joints_1: vec4u,
    @location(8) weights_1: vec4f,
}

struct VertexOut {
    // Invariant, since other pipelines compare with the depth that this one writes.
    @builtin(position) @invariant position: vec4f,
    // World-space vector to the eye. Unlike positions it stays small far from the origin, which keeps derivatives
    // precise.
    @location(0) to_eye: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
    // Weight of the heat map's joint or, for channels, the number of influences.
    @location(5) heat: f32,
#if VOLUME
    // World units per unit of the mesh.
    @location(6) scale: f32,
#endif
}

// Depth offset towards the viewer, which keeps the wireframe in front of its surface.
override DEPTH_OFFSET: f32 = 0.0;

fn vertex_out(in: VertexIn, blend: Blend, heat: f32) -> VertexOut {
    let shape = deform(in.vertex, Shape(in.position, in.normal, in.tangent.xyz), blend);
    var position = shape.position;
#if TOON
    if OUTLINE {
        position += outline_offset(in, shape);
    }
#endif
    var out: VertexOut;
    out.position = frame.projection_from_world * vec4f(position, 1.0);
    out.position.z -= DEPTH_OFFSET * out.position.w;
    out.to_eye = frame.eye - position;
    out.normal = shape.normal;
    out.tangent = vec4f(shape.tangent, in.tangent.w);
    out.uv = in.uv;
    out.color = in.color;
    out.heat = heat;
#if VOLUME
    out.scale = (length(blend.linear[0]) + length(blend.linear[1]) + length(blend.linear[2])) / 3.0;
#endif
    return out;
}

// For the shadow pass, which needs only positions.
fn position_out(in: VertexIn, blend: Blend) -> vec4f {
    let position = morph(in.vertex, Shape(in.position, in.normal, in.tangent.xyz)).position;
    let moved = rotate(blend.rotation, blend.linear * position) + blend.translation;
    return frame.projection_from_world * vec4f(moved, 1.0);
}

// Without influences, each copy of the mesh has its own palette entry.
@vertex
fn position_0(in: VertexIn, @builtin(instance_index) copy: u32) -> @builtin(position) vec4f {
    return position_out(in, single(copy));
}

@vertex
fn position_4(in: VertexIn, influence: Influences4) -> @builtin(position) vec4f {
    return position_out(in, blend_4(influence.joints, influence.weights));
}

@vertex
fn position_8(in: VertexIn, influence: Influences8) -> @builtin(position) vec4f {
    let blend = blend_8(influence.joints_0, influence.weights_0, influence.joints_1, influence.weights_1);
    return position_out(in, blend);
}

@vertex
fn position_texture(in: VertexIn) -> @builtin(position) vec4f {
    return position_out(in, blend_texture(in.vertex));
}

@vertex
fn vertex_0(in: VertexIn, @builtin(instance_index) copy: u32) -> VertexOut {
    return vertex_out(in, single(copy), select(0.0, 1.0, draw.heat_joint == 0u));
}

@vertex
fn vertex_4(in: VertexIn, influence: Influences4) -> VertexOut {
    return vertex_out(in, blend_4(influence.joints, influence.weights), heat_4(influence.joints, influence.weights));
}

@vertex
fn vertex_8(in: VertexIn, influence: Influences8) -> VertexOut {
    let heat = heat_4(influence.joints_0, influence.weights_0) + heat_4(influence.joints_1, influence.weights_1);
    let blend = blend_8(influence.joints_0, influence.weights_0, influence.joints_1, influence.weights_1);
    return vertex_out(in, blend, heat);
}

@vertex
fn vertex_texture(in: VertexIn) -> VertexOut {
    return vertex_out(in, blend_texture(in.vertex), heat_texture(in.vertex));
}
