// The palette texture, and nobody else knows its layout: entries of five texels (see `PaletteEntry` in
// src/mesh/palette.rs), 256 to a row; then the morph weights that are not 0, one texel each (target, weight).

@group(0) @binding(1) var palette: texture_2d<f32>;

const PALETTE_WIDTH: u32 = 1280u;
const PALETTE_ENTRY_TEXELS: u32 = 5u;

fn palette_texel(index: u32) -> vec4f {
    return textureLoad(palette, vec2i(i32(index % PALETTE_WIDTH), i32(index / PALETTE_WIDTH)), 0);
}

// x: the target, y: its weight.
fn morph_weight(first_texel: u32, index: u32) -> vec2f {
    return palette_texel(first_texel + index).xy;
}
