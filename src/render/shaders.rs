//! The WGSL modules, concatenated from the files in `shaders/`.

const FRAME: &str = include_str!("../../shaders/frame.wgsl");
const TONE: &str = include_str!("../../shaders/tone.wgsl");
const PALETTE: &str = include_str!("../../shaders/palette.wgsl");
const SKINNING: &str = include_str!("../../shaders/skinning.wgsl");
const VERTEX: &str = include_str!("../../shaders/vertex.wgsl");
const LIGHT: &str = include_str!("../../shaders/light.wgsl");
const SURFACE: &str = include_str!("../../shaders/surface.wgsl");
const GROUND: &str = include_str!("../../shaders/ground.wgsl");
const LINE: &str = include_str!("../../shaders/line.wgsl");
const BONE: &str = include_str!("../../shaders/bone.wgsl");
const CLEAR_DEPTH: &str = include_str!("../../shaders/clear_depth.wgsl");
const BACKGROUND: &str = include_str!("../../shaders/background.wgsl");
const SKY_BACKGROUND: &str = include_str!("../../shaders/sky.wgsl");
const MIP: &str = include_str!("../../shaders/mip.wgsl");
const BLIT_PICTURE: &str = include_str!("../../shaders/blit.wgsl");

/// One shader module.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// Name in wgpu's messages and graphics debuggers.
    pub label: &'static str,
    parts: &'static [&'static str],
}

/// Meshes: all vertex and fragment stages of the scene and shadow passes.
pub const MESH: Shader = Shader { label: "mesh", parts: &[FRAME, TONE, PALETTE, SKINNING, VERTEX, LIGHT, SURFACE] };
/// The grid and the shadow on the ground.
pub(super) const GROUND_PLANE: Shader = Shader { label: "ground", parts: &[FRAME, LIGHT, GROUND] };
/// Overlay lines.
pub(super) const LINES: Shader = Shader { label: "lines", parts: &[FRAME, TONE, LINE] };
/// Bones of the skeleton overlay.
pub(super) const BONES: Shader = Shader { label: "bones", parts: &[FRAME, TONE, BONE] };
/// Resets the depth buffer before the overlays that are drawn on top.
pub(super) const DEPTH_CLEAR: Shader = Shader { label: "clear depth", parts: &[CLEAR_DEPTH] };
/// The gradient of the studio background.
pub(super) const BACKDROP: Shader = Shader { label: "background", parts: &[FRAME, BACKGROUND] };
/// The environment as a background.
pub(super) const SKY: Shader = Shader { label: "sky", parts: &[FRAME, TONE, SKY_BACKGROUND] };
/// Renders a mip level of a texture from the level above.
pub(super) const MIPS: Shader = Shader { label: "mips", parts: &[MIP] };
/// Copies the finished picture to the screen.
pub(super) const BLIT: Shader = Shader { label: "blit", parts: &[BLIT_PICTURE] };
/// The vertex stages of meshes alone, without fragment stages.
pub const SKINNED_VERTEX: Shader = Shader { label: "skinned vertex", parts: &[FRAME, PALETTE, SKINNING, VERTEX] };

/// Every module used for drawing.
pub const ALL: [Shader; 9] = [MESH, GROUND_PLANE, LINES, BONES, DEPTH_CLEAR, BACKDROP, SKY, MIPS, BLIT];

impl Shader {
    /// Returns the WGSL of the whole module.
    pub fn source(&self) -> String {
        self.parts.concat()
    }

    pub(super) fn module(&self, device: &wgpu::Device) -> wgpu::ShaderModule {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.label),
            source: wgpu::ShaderSource::Wgsl(self.source().into()),
        })
    }
}
