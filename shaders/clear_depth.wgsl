// Puts the depth back to far, so that what follows is drawn through everything before it.

@vertex
fn full_screen(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 1.0, 1.0);
}

@fragment
fn nothing() -> @location(0) vec4f {
    return vec4f(0.0);
}
