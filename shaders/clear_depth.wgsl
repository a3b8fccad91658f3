// Resets the depth buffer to far, so that everything drawn afterwards is on top.

@vertex
fn full_screen(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 1.0, 1.0);
}

@fragment
fn nothing() -> @location(0) vec4f {
    return vec4f(0.0);
}
