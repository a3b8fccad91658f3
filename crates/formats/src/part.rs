//! The decoders that few files need.

#[cfg(not(target_arch = "wasm32"))]
use gaitway_part::Answer;

/// A decoder that few files need. Natively it is linked like any crate; the page downloads it when a file needs it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// `KHR_draco_mesh_compression`.
    Draco,
    /// Models and motions in Autodesk's format.
    Fbx,
    /// `KHR_texture_basisu`. Its images stay what they are until all images are decoded.
    Ktx2,
    /// `EXT_meshopt_compression` and `KHR_meshopt_compression`.
    Meshopt,
    /// Motions in NumPy arrays and archives of them.
    Npz,
    /// Models and motions in DirectX's `.x` format.
    X,
}

impl Part {
    /// Name of the package and of the page's module; also of a format, if the part converts whole files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draco => "draco",
            Self::Fbx => "fbx",
            Self::Ktx2 => "ktx2",
            Self::Meshopt => "meshopt",
            Self::Npz => "npz",
            Self::X => "x",
        }
    }

    /// What messages call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Draco => "Draco decoder",
            Self::Fbx => "FBX reader",
            Self::Ktx2 => "KTX2 decoder",
            Self::Meshopt => "meshopt decoder",
            Self::Npz => "NumPy reader",
            Self::X => "DirectX reader",
        }
    }

    /// Runs the decoder in this process. A panic in it is returned as an error.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(self, input: &[u8]) -> Answer {
        let convert = match self {
            Self::Draco => gaitway_draco::decode,
            Self::Fbx => gaitway_fbx::convert,
            Self::Ktx2 => gaitway_ktx2::decode,
            Self::Meshopt => gaitway_meshopt::decode,
            Self::Npz => gaitway_npz::convert,
            Self::X => gaitway_x::convert,
        };
        let stopped = |_| Err(format!("the {} stopped unexpectedly; the file may be damaged", self.title()));
        std::panic::catch_unwind(|| convert(input)).unwrap_or_else(stopped)
    }
}
