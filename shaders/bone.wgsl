// Bones: instanced tapered octahedra with a ball at the joint.

struct BoneIn {
    // Position on the unit shape; an octahedron's y runs from head (0) to tail (1).
    @location(0) position: vec3f,
    // w: 0 octahedron, 1 ball.
    @location(1) normal: vec4f,
    @location(2) head: vec3f,
    @location(3) radius: f32,
    @location(4) tail: vec3f,
    @location(5) color: vec4f,
}

struct BoneOut {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
    @location(1) normal: vec3f,
    @location(2) to_eye: vec3f,
}

@vertex
fn bone_vertex(in: BoneIn) -> BoneOut {
    let along = in.tail - in.head;
    let bone_length = length(along);
    let y = select(vec3f(0.0, 1.0, 0.0), along / max(bone_length, 1e-30), bone_length > 0.0);
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), abs(y.x) > 0.7);
    let x = normalize(cross(y, helper));
    let z = cross(x, y);
    let ball = in.normal.w > 0.5;
    let size = select(vec3f(in.radius, bone_length, in.radius), vec3f(in.radius), ball);
    let offset = in.position * size;
    let world = in.head + x * offset.x + y * offset.y + z * offset.z;
    // Normals scale by the inverse of the shape's size.
    let unit = in.normal.xyz / max(size, vec3f(1e-30));
    var out: BoneOut;
    out.position = frame.projection_from_world * vec4f(world, 1.0);
    out.color = vec4f(mix(in.color.rgb, vec3f(1.0), select(0.0, 0.35, ball)), in.color.a);
    out.normal = normalize(x * unit.x + y * unit.y + z * unit.z);
    out.to_eye = frame.eye - world;
    return out;
}

@fragment
fn bone_fragment(in: BoneOut) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let facing = clamp(dot(normal, normalize(in.to_eye)), 0.0, 1.0);
    let shade = 0.35 + 0.45 * facing + 0.2 * clamp(normal.y, 0.0, 1.0);
    return vec4f(srgb_from_linear(shade * in.color.rgb) * in.color.a, in.color.a);
}
