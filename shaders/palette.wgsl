// The palette texture. Only this file knows its layout: entries of five texels (see `PaletteEntry` in
// crates/character/src/mesh/palette.rs), 256 to a row, followed by the non-zero morph weights, one texel each (target, weight).

@group(0) @binding(1) var palette: texture_2d<f32>;

const PALETTE_WIDTH: u32 = 1280u;

// Loads one of an entry's five texels. Uses shifts, because software renderers divide lane by lane.
fn palette_row(entry: u32, row: u32) -> vec4f {
    return textureLoad(palette, vec2i(i32((entry & 255u) * 5u + row), i32(entry >> 8u)), 0);
}

// Returns a target and its weight.
fn morph_weight(first_texel: u32, index: u32) -> vec2f {
    let texel = first_texel + index;
    return textureLoad(palette, vec2i(i32(texel % PALETTE_WIDTH), i32(texel / PALETTE_WIDTH)), 0).xy;
}
