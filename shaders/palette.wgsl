// The palette texture, and nobody else knows its layout: entries of five texels (see `PaletteEntry` in
// src/mesh/palette.rs), 256 to a row; then the morph weights that are not 0, one texel each (target, weight).

@group(0) @binding(1) var palette: texture_2d<f32>;

const PALETTE_WIDTH: u32 = 1280u;

// One of an entry's five texels. Shifts rather than divisions, which software renderers do lane by lane.
fn palette_row(entry: u32, row: u32) -> vec4f {
    return textureLoad(palette, vec2i(i32((entry & 255u) * 5u + row), i32(entry >> 8u)), 0);
}

// x: the target, y: its weight.
fn morph_weight(first_texel: u32, index: u32) -> vec2f {
    let texel = first_texel + index;
    return textureLoad(palette, vec2i(i32(texel % PALETTE_WIDTH), i32(texel / PALETTE_WIDTH)), 0).xy;
}
