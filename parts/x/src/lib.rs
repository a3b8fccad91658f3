//! Converts a DirectX `.x` file to glTF, in memory: frames, meshes with their skins, materials, and every animation set as a
//! clip. It is a crate of its own, since the page downloads it as a separate wasm module, only for those who open such a file.
//!
//! # The container
//!
//! A file begins with 16 bytes: `xof `, the version (`0302`, `0303`), how the rest is written (`txt `, `bin `, `tzip`, `bzip`) and
//! the size of its floats in bits (`0032`, `0064`). In `tzip` and `bzip`, text and binary are compressed with MSZIP: the size of
//! the whole file once unpacked (u32), then blocks of their size unpacked (u16), their size in the file (u16), and that many
//! bytes: `CK`, then a deflate stream of its own whose back-references reach into the blocks before it.
//!
//! # Objects
//!
//! What follows are *objects*: `Template name { data }`, where the name may be missing and the data are numbers, strings, nested
//! objects and references to others (`{ name }`). Declarations of templates (`template Name { … }`) come first. The data of the
//! templates below are known, so declarations are skipped, and so are the separators `;` and `,`, about which exporters disagree.
//! Text has `//` and `#` comments. Binary is a sequence of tokens (u16):
//!
//! | token | is followed by |
//! | --- | --- |
//! | 1 name, 2 string | length (u32), characters; 2 is followed by a separator |
//! | 3 integer | u32 |
//! | 5 GUID | 16 bytes |
//! | 6 integers, 7 floats | count (u32), values |
//! | 10 `{`, 11 `}`, 12 `(`, 13 `)`, 14 `[`, 15 `]`, 16 `<`, 17 `>`, 18 `.`, 19 `,`, 20 `;` | |
//! | 31 `template`, 40–52 types of members | |
//!
//! # Templates
//!
//! - `Frame`: a node, with `FrameTransformMatrix` (16 numbers), frames and meshes.
//! - `Mesh`: vertices, then faces as counts and indices. `MeshNormals` has faces of its own, `MeshTextureCoords` and
//!   `MeshVertexColors` go with the vertices. `MeshMaterialList` has one material per face; the last one is repeated.
//!   Newer exporters have `DeclData` instead of the first two: Direct3D's types (count; type, method, usage, index), then each
//!   vertex as 32-bit words. `VertexDuplicationIndices` says which vertices are copies of each other: all of them are in the
//!   mesh, so it is not needed.
//! - `SkinWeights`, one for each joint: the frame's name, vertices, weights, and the matrix from the bind pose to the joint.
//! - `Material`: colour with alpha, exponent, specular and emissive colour, `TextureFilename`.
//! - `AnimationSet` → `Animation` → a reference to a frame, and `AnimationKey`: what (0 rotation, 1 scale, 2 position, 3 or 4
//!   matrix), the number of keys, and for each the time, the number of values and the values. `AnimTicksPerSecond` gives the
//!   unit of time, else it is 1/4800 s. A file may have nothing else: it moves the frames of a model in another file.
//!
//! # Conventions
//!
//! Left-handed with Y up; +Z becomes -Z. Front faces are clockwise. Vectors are rows, so the 16 numbers of a matrix are
//! glTF's, columns first. Quaternions are `w x y z` and rotate in the opposite direction to the matrices. V of a
//! texture points down, as in glTF. There is no unit of length.

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![forbid(unsafe_code)]

mod clip;
mod container;
mod declared;
mod document;
mod frame;
mod material;
mod mesh;
mod skin;
mod token;
mod transform;

use document::Document;
use gaitway_glb::{Glb, Warnings};
use gaitway_part::{Answer, Output};

/// Converts the bytes of a whole `.x` file into those of a `.glb`. Textures are named by the last part of their path.
///
/// # Errors
///
/// Returns a message for the user (what was expected, what was found and what to do) if the file can't be read or exceeds a
/// limit.
pub fn convert(bytes: &[u8]) -> Answer {
    let contents = container::open(bytes)?;
    let document = Document::read(&contents)?;
    let mut glb = Glb::new(".x");
    let mut warnings = Warnings::default();
    document.warn(&mut warnings);
    let mut nodes = frame::Nodes::new(&document)?;
    mesh::write(&document, &mut nodes, &mut glb, &mut warnings)?;
    if nodes.entries.is_empty() {
        return Err(
            "the .x file has nothing to show: expected frames, meshes or animations, found none. Export it again with the \
            objects selected."
                .to_owned(),
        );
    }
    clip::write(&document, &mut nodes, &mut glb, &mut warnings)?;
    nodes.write(&mut glb, &mut warnings);
    Ok(Output { bytes: glb.write()?, warnings: warnings.into_sentences() })
}

/// Returns a message about a damaged file.
fn damaged(place: &str, expected: &str, found: &str) -> String {
    format!("the .x file is damaged at {place}: expected {expected}, found {found}. Download or export it again.")
}

/// Returns a message about a limit.
fn too_large(expected: usize, what: &str, found: usize) -> String {
    format!("the .x file is too large: expected at most {expected} {what}, found {found}. Export a part of the scene.")
}
