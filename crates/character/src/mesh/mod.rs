//! Geometry, skins and materials, and CPU skinning, the reference for the GPU. Independent of files, GPU, user
//! interface and clock.

mod bounds;
mod geometry;
mod lobes;
mod material;
mod mikktspace;
mod normals;
mod palette;
mod skin;
mod skinning;
mod tangents;
mod texture;
mod toon;

pub use bounds::Bounds;
pub use geometry::first_not_below;
pub use geometry::{Geometry, GeometryError, Influences, MAX_INFLUENCES, Mesh, MorphTarget, Topology};
pub use lobes::Lobes;
pub use material::{AlphaMode, Material};
pub use normals::smooth_normals;
pub use palette::{PaletteEntry, SkinningMode, palette_entry, write_palette};
pub use skin::{Skin, SkinError};
pub use skinning::deform_vertex;
pub use skinning::{DeformedVertices, deform};
pub use tangents::{add_tangents, corner_tangents};
pub use texture::{Filter, MipFilter, Sampler, Texture, TextureRef, UvTransform, Wrap};
pub use toon::{OutlineMode, Toon};
