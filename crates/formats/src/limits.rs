//! The limits on what is read, stated once: docs/limits.md explains them, and a test compares the two. A limit on one file counts
//! what its reader is about to allocate, or what showing the result would cost, before it happens.

use std::cell::Cell;
use std::fmt::Display;

use super::error::Problem;

/// Files held in memory at once: those given, those that they refer to and, while they are unpacked, archives. The page has 4 GiB
/// for everything.
pub const MAX_READ_BYTES: u64 = if cfg!(target_arch = "wasm32") { 1 << 30 } else { 2 << 30 };
/// Files in one archive.
pub const MAX_ARCHIVE_FILES: usize = 10_000;
/// Files out of folders that are opened together.
pub const MAX_FOLDER_FILES: usize = 4096;
/// Folders inside folders.
pub const MAX_FOLDER_DEPTH: usize = 16;
/// A joint map, which is held as a tree of values.
pub const MAX_MAP_BYTES: usize = 16 << 20;
/// Frames of a clip that is sampled to be written, nine hours at 30 a second.
pub const MAX_WRITTEN_FRAMES: usize = 1_000_000;
/// Frames of such a clip times its joints, which limits the memory that writing it takes.
pub const MAX_WRITTEN_POSES: usize = 12 << 20;
/// Width and height of an image in pixels.
pub const MAX_IMAGE_SIDE: u32 = 16_384;
/// Decoded images of a model. Larger ones are scaled down until they fit.
pub const MAX_IMAGE_BYTES: u64 = 512 << 20;
/// Objects in the JSON of a glTF, and values in its unknown extensions: an object takes a few hundred bytes, however short its
/// text is.
pub const MAX_JSON_OBJECTS: usize = 1 << 21;
/// Values in a JSON text that has to be corrected, and is held as a tree.
pub const MAX_JSON_VALUES: usize = 1 << 24;

/// What a reader counts over a whole model or motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Bytes of vertices, indices, keys and embedded images.
    DataBytes,
    /// Pixels of all images, as their headers say.
    ImagePixels,
    /// Nodes of a glTF and EXT_mesh_gpu_instancing copies, joints of a .bvh or a .skel.
    Nodes,
    /// Each node of a mesh has a weight for each of its morph targets.
    MorphWeights,
    /// Each skinned node has a matrix for each joint of its skin.
    SkinMatrices,
    /// Each node of a mesh, and each copy, draws all its vertices.
    DrawnVertices,
    /// Each primitive takes a draw call for each node of its mesh; consecutive copies that are mirrored alike share one. Blended
    /// copies count the same, although they are drawn one by one, from back to front.
    DrawCalls,
}

impl Limit {
    /// All limits.
    pub const ALL: [Self; 7] = [
        Self::DataBytes,
        Self::ImagePixels,
        Self::Nodes,
        Self::MorphWeights,
        Self::SkinMatrices,
        Self::DrawnVertices,
        Self::DrawCalls,
    ];

    /// The most that a file may have.
    pub fn max(self) -> usize {
        match self {
            Self::DataBytes if cfg!(target_pointer_width = "32") => 512 << 20,
            Self::DataBytes => 1 << 30,
            Self::ImagePixels => 256 << 20,
            Self::Nodes => 1 << 18,
            Self::MorphWeights => 1 << 22,
            Self::SkinMatrices => 1 << 20,
            Self::DrawnVertices => 1 << 26,
            Self::DrawCalls => 1 << 15,
        }
    }

    /// What is counted, as messages and docs/limits.md call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::DataBytes => "MiB of data",
            Self::ImagePixels => "pixels of images",
            Self::Nodes => "nodes",
            Self::MorphWeights => "morph weights",
            Self::SkinMatrices => "skin matrices",
            Self::DrawnVertices => "drawn vertices",
            Self::DrawCalls => "draw calls",
        }
    }

    /// The maximum in the unit of [`Self::name`].
    pub fn max_in_unit(self) -> usize {
        self.max() / self.unit()
    }

    fn unit(self) -> usize {
        if self == Self::DataBytes { 1 << 20 } else { 1 }
    }
}

/// Counts what one load needs. Shared by all readers.
#[derive(Debug, Default)]
pub(super) struct Budget {
    spent: [Cell<usize>; Limit::ALL.len()],
}

impl Budget {
    /// Counts `amount` more towards a limit; fails if that exceeds it.
    pub fn spend(&self, limit: Limit, amount: usize, place: &dyn Display) -> Result<(), Problem> {
        let spent = &self.spent[limit as usize];
        let total = spent.get().saturating_add(amount);
        if total > limit.max() {
            let expected = format!("at most {} {} in all", limit.max_in_unit(), limit.name());
            return Err(Problem::Limit { place: place.to_string(), expected, found: total.div_ceil(limit.unit()) });
        }
        spent.set(total);
        Ok(())
    }

    /// Counts `count` items of `size` bytes that are about to be allocated.
    pub fn allocate(&self, count: usize, size: usize, place: &dyn Display) -> Result<(), Problem> {
        self.spend(Limit::DataBytes, count.saturating_mul(size), place)
    }

    /// What is left of a limit.
    pub fn left(&self, limit: Limit) -> usize {
        limit.max().saturating_sub(self.spent[limit as usize].get())
    }
}
