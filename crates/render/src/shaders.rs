//! The WGSL modules, concatenated from the files in `shaders/`.
//!
//! Surfaces without lobes share one module, whose overrides switch everything else. The lobes' formulas are those of the
//! Khronos glTF Sample Viewer; `crates/character/tests/character/lobes.rs` integrates them. MToon and channels are permutations with fragment
//! stages of their own: a view without channels compiles nothing for them, and cycling through them compiles once.

use std::fmt::Write;

use gaitway_character::anim::TextureSlot;

/// The text of a file in `shaders/`, which build.rs strips of comments and indentation.
macro_rules! wgsl {
    ($name:literal) => {
        include_str!(concat!(env!("OUT_DIR"), "/", $name, ".wgsl"))
    };
}

const FRAME: &str = wgsl!("frame");
const TONE: &str = wgsl!("tone");
const PALETTE: &str = wgsl!("palette");
const SKINNING: &str = wgsl!("skinning");
const VERTEX: &str = wgsl!("vertex");
const LIGHT: &str = wgsl!("light");
const BRDF: &str = wgsl!("brdf");
const CLEARCOAT: &str = wgsl!("clearcoat");
const SHEEN: &str = wgsl!("sheen");
const ANISOTROPY: &str = wgsl!("anisotropy");
const IRIDESCENCE: &str = wgsl!("iridescence");
const TRANSMISSION: &str = wgsl!("transmission");
const SURFACE: &str = wgsl!("surface");
const TOON: &str = wgsl!("toon");
const CHANNELS: &str = wgsl!("channel");
const GROUND: &str = wgsl!("ground");
const LINE: &str = wgsl!("line");
const BONE: &str = wgsl!("bone");
const CLEAR_DEPTH: &str = wgsl!("clear_depth");
const BACKGROUND: &str = wgsl!("background");
const SKY_BACKGROUND: &str = wgsl!("sky");
const MIP: &str = wgsl!("mip");
const BLIT_PICTURE: &str = wgsl!("blit");

/// The shaders' names for a material's maps, in the order of [`TextureSlot`].
const MAPS: [&str; TextureSlot::ALL.len()] = [
    "base_color",
    "metallic_roughness",
    "normal",
    "occlusion",
    "emissive",
    "specular",
    "specular_color",
    "clearcoat",
    "clearcoat_roughness",
    "clearcoat_normal",
    "sheen_color",
    "sheen_roughness",
    "iridescence",
    "iridescence_thickness",
    "anisotropy",
    "transmission",
    "thickness",
    "diffuse_transmission",
    "diffuse_transmission_color",
    "shade_multiply",
    "shading_shift",
    "matcap",
    "rim_multiply",
    "outline_width",
    "uv_animation_mask",
];

/// A permutation of the mesh shader: a bit for each map, in the order of [`TextureSlot`], then one for each lobe, MToon
/// and channels. Everything else is cut from the shader's text, since WebGL2 has few texture units and most materials
/// have no lobes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfacePermutation(pub u64);

impl SurfacePermutation {
    /// All maps of core glTF, which overrides turn off, and no lobes.
    pub const PLAIN: Self = Self(0b11111);
    /// An index of refraction, or a weight or colour of the dielectric reflection.
    pub const SPECULAR: u64 = 1 << 25;
    /// Glossiness in the alpha of the specular colour map.
    pub const GLOSSINESS: u64 = 1 << 26;
    /// KHR_materials_clearcoat.
    pub const CLEARCOAT: u64 = 1 << 27;
    /// KHR_materials_sheen.
    pub const SHEEN: u64 = 1 << 28;
    /// KHR_materials_iridescence.
    pub const IRIDESCENCE: u64 = 1 << 29;
    /// KHR_materials_anisotropy.
    pub const ANISOTROPY: u64 = 1 << 30;
    /// KHR_materials_transmission.
    pub const TRANSMISSION: u64 = 1 << 31;
    /// KHR_materials_volume; only with transmission or diffuse transmission.
    pub const VOLUME: u64 = 1 << 32;
    /// KHR_materials_dispersion; only with transmission and a volume.
    pub const DISPERSION: u64 = 1 << 33;
    /// KHR_materials_diffuse_transmission.
    pub const DIFFUSE_TRANSMISSION: u64 = 1 << 34;
    /// All lobes.
    pub const LOBES: u64 = 0x3ff << 25;
    /// VRMC_materials_mtoon, which has no lobes.
    pub const TOON: u64 = 1 << 35;
    /// Shows single inputs of shading instead of the whole.
    pub const CHANNEL: u64 = 1 << 36;

    /// Conditions of the shaders' `#if`: true if the permutation has any of these bits.
    const CONDITIONS: [(&str, u64); 17] = [
        ("SPECULAR", Self::SPECULAR),
        ("GLOSSINESS", Self::GLOSSINESS),
        ("CLEARCOAT", Self::CLEARCOAT),
        ("CLEARCOAT_NORMAL_MAP", Self::map_bit(TextureSlot::ClearcoatNormal)),
        ("SHEEN", Self::SHEEN),
        ("IRIDESCENCE", Self::IRIDESCENCE),
        ("ANISOTROPY", Self::ANISOTROPY),
        ("ANISOTROPY_MAP", Self::map_bit(TextureSlot::Anisotropy)),
        ("TRANSMISSION", Self::TRANSMISSION),
        ("VOLUME", Self::VOLUME),
        ("DISPERSION", Self::DISPERSION),
        ("DIFFUSE_TRANSMISSION", Self::DIFFUSE_TRANSMISSION),
        ("TRANSMISSIVE", Self::TRANSMISSION | Self::DIFFUSE_TRANSMISSION),
        ("TOON", Self::TOON),
        ("CHANNEL", Self::CHANNEL),
        ("SHADING_SHIFT_MAP", Self::map_bit(TextureSlot::ShadingShift)),
        ("MATCAP_MAP", Self::map_bit(TextureSlot::Matcap)),
    ];

    /// The bit of a map.
    pub(super) const fn map_bit(slot: TextureSlot) -> u64 {
        1 << slot as u32
    }

    /// Returns the permutation with the same maps that shows channels.
    pub(super) fn of_channels(self) -> Self {
        Self(self.0 | Self::CHANNEL)
    }

    /// Returns the permutation with the same maps that doesn't.
    pub(super) fn without_channels(self) -> Self {
        Self(self.0 & !Self::CHANNEL)
    }

    /// Whether it has any of these bits.
    pub fn has(self, bits: u64) -> bool {
        self.0 & bits != 0
    }

    /// Whether it meets a condition of `#if`.
    fn meets(self, condition: &str) -> bool {
        Self::CONDITIONS.iter().any(|&(name, bits)| name == condition && self.has(bits))
    }

    /// Returns the indices of its maps.
    pub fn maps(self) -> impl Iterator<Item = usize> {
        (0..MAPS.len()).filter(move |map| self.0 >> map & 1 == 1)
    }

    /// Whether a map is read by the vertex stage instead of the fragment stage.
    pub fn is_vertex_map(map: usize) -> bool {
        map == TextureSlot::OutlineWidth as usize
    }

    /// Returns the binding of a map in group 3; its sampler has the next one. Bindings 11 and 12 are morph deltas and
    /// influences.
    pub fn binding(map: usize) -> u32 {
        let binding = 1 + 2 * map as u32;
        if binding < 11 { binding } else { binding + 2 }
    }

    /// Declares each map and a function that returns its texel, or white for maps it doesn't have.
    fn write_maps(self, out: &mut String) {
        for (map, name) in MAPS.iter().enumerate() {
            // The vertex stage has no derivatives to choose a mip level by.
            let (call, level) = if Self::is_vertex_map(map) { ("Level", ", 0.0") } else { ("", "") };
            // Writing to a string cannot fail.
            let _ = match self.0 >> map & 1 {
                0 => writeln!(out, "fn {name}_texel(uv: vec4f) -> vec4f {{ return vec4f(1.0); }}"),
                _ => writeln!(
                    out,
                    "@group(3) @binding({}) var {name}_map: texture_2d<f32>;
@group(3) @binding({}) var {name}_sampler: sampler;
fn {name}_texel(uv: vec4f) -> vec4f {{
return textureSample{call}({name}_map, {name}_sampler, map_uv({map}u, uv){level});
}}",
                    Self::binding(map),
                    Self::binding(map) + 1
                ),
            };
        }
    }
}

/// Colours of the heat map in linear RGB at equal distances, from little weight to 1.
pub const HEAT_COLORS: [[f32; 3]; 4] = [[0.03, 0.16, 0.75], [0.04, 0.55, 0.16], [0.95, 0.75, 0.03], [0.80, 0.03, 0.02]];

/// Colours of vertices with 1, 2, 4, 8 and 16 influences, in sRGB.
pub const INFLUENCE_COLORS: [[f32; 3]; 5] =
    [[0.19, 0.44, 0.88], [0.16, 0.68, 0.70], [0.22, 0.76, 0.35], [0.98, 0.66, 0.13], [0.90, 0.16, 0.28]];

fn write_colors(out: &mut String, name: &str, colors: &[[f32; 3]]) {
    let colors = colors.iter().map(|[red, green, blue]| format!("vec3f({red}, {green}, {blue})"));
    let colors = colors.collect::<Vec<_>>().join(", ");
    out.push_str(&format!("const {name} = array({colors});\n"));
}

/// One shader module.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// Name in wgpu's messages and graphics debuggers.
    pub label: &'static str,
    parts: &'static [&'static str],
    permutation: SurfacePermutation,
}

const MESH_PARTS: [&str; 15] = [
    FRAME,
    TONE,
    PALETTE,
    SKINNING,
    VERTEX,
    LIGHT,
    BRDF,
    CLEARCOAT,
    SHEEN,
    ANISOTROPY,
    IRIDESCENCE,
    TRANSMISSION,
    SURFACE,
    TOON,
    CHANNELS,
];

/// Meshes without lobes: all vertex and fragment stages of the scene and shadow passes.
pub const MESH: Shader = Shader::mesh(SurfacePermutation::PLAIN);
/// The grid and the shadow on the ground.
pub(super) const GROUND_PLANE: Shader = Shader::new("ground", &[FRAME, LIGHT, GROUND]);
/// Overlay lines.
pub(super) const LINES: Shader = Shader::new("lines", &[FRAME, TONE, LINE]);
/// Bones of the skeleton overlay.
pub(super) const BONES: Shader = Shader::new("bones", &[FRAME, TONE, BONE]);
/// Resets the depth buffer before the overlays that are drawn on top.
pub(super) const DEPTH_CLEAR: Shader = Shader::new("clear depth", &[CLEAR_DEPTH]);
/// The gradient of the studio background.
pub(super) const BACKDROP: Shader = Shader::new("background", &[FRAME, BACKGROUND]);
/// The environment as a background.
pub(super) const SKY: Shader = Shader::new("sky", &[FRAME, TONE, SKY_BACKGROUND]);
/// Renders a mip level of a texture from the level above.
pub(super) const MIPS: Shader = Shader::new("mips", &[MIP]);
/// Copies the finished picture to the screen.
pub(super) const BLIT: Shader = Shader::new("blit", &[BLIT_PICTURE]);
/// The vertex stages of meshes alone, without fragment stages.
pub const SKINNED_VERTEX: Shader = Shader::new("skinned vertex", &[FRAME, PALETTE, SKINNING, VERTEX]);

/// Every module used for drawing.
pub const ALL: [Shader; 9] = [MESH, GROUND_PLANE, LINES, BONES, DEPTH_CLEAR, BACKDROP, SKY, MIPS, BLIT];

impl Shader {
    const fn new(label: &'static str, parts: &'static [&'static str]) -> Self {
        Self { label, parts, permutation: SurfacePermutation::PLAIN }
    }

    /// Meshes with these maps and lobes.
    pub const fn mesh(permutation: SurfacePermutation) -> Self {
        Self { label: "mesh", parts: &MESH_PARTS, permutation }
    }

    /// Returns the WGSL of the whole module. `#if NAME`, `#else` and `#endif` select lines by the permutation; `#maps`
    /// stands for the declarations of its maps, `#heat` for [`HEAT_COLORS`], `#influences` for [`INFLUENCE_COLORS`].
    pub fn source(&self) -> String {
        let mut out = String::new();
        // Whether each enclosing `#if` selects the current line.
        let mut selected: Vec<bool> = Vec::new();
        for line in self.parts.iter().flat_map(|part| part.lines()) {
            let is_skipped = selected.contains(&false);
            match line.strip_prefix('#') {
                Some("endif") => drop(selected.pop()),
                Some("else") => selected.last_mut().into_iter().for_each(|is_selected| *is_selected = !*is_selected),
                Some(line) if line.starts_with("if ") => selected.push(self.permutation.meets(&line[3..])),
                _ if is_skipped => {}
                Some("maps") => self.permutation.write_maps(&mut out),
                Some("heat") => write_colors(&mut out, "HEAT_COLORS", &HEAT_COLORS),
                Some("influences") => write_colors(&mut out, "INFLUENCE_COLORS", &INFLUENCE_COLORS),
                _ => {
                    out.push_str(line);
                    out.push('\n');
                }
            }
        }
        out
    }

    pub(super) fn module(&self, device: &wgpu::Device) -> wgpu::ShaderModule {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.label),
            source: wgpu::ShaderSource::Wgsl(self.source().into()),
        })
    }
}
