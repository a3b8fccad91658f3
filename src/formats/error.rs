//! Why a load failed: the file, the place in it, what was expected, what was found and, if known, what to do.

use crate::asset::AssetError;
use crate::mesh::GeometryError;

/// Everything that makes a set of files unreadable. The user sees these texts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    #[error(
        "no model among the files ({}); Gaitway reads .glb, .gltf with its files, .vrm, .vrma, .bvh, .obj (with .skel and .attach), or a .zip of these",
        listed(found)
    )]
    NoModel { found: Vec<String> },
    #[error("several models at once ({}); drop one of them with its own files", listed(found))]
    SeveralModels { found: Vec<String> },
    #[error(
        "{file}: {format} files cannot be read; open it in Blender (File › Import), then export glTF 2.0 (.glb) and drop that"
    )]
    UnsupportedFormat { file: String, format: &'static str },
    #[error(
        "{file}: this is glTF {found}; Gaitway reads glTF 2.0. Convert it, for example by importing and exporting it again"
    )]
    UnsupportedVersion { file: String, found: String },
    #[error("{file}: needs the extension {name}, which is not supported; {advice}")]
    RequiredExtension { file: String, name: String, advice: &'static str },
    #[error("{file}: not valid JSON for glTF, line {line}, column {column}: {problem}")]
    Json { file: String, line: usize, column: usize, problem: String },
    #[error("{file}: {place}: expected {expected}, found {found}")]
    Invalid { file: String, place: String, expected: String, found: String },
    #[error("{file}: {place} is “{uri}”, which is not among the files; drop it together with the model")]
    MissingFile { file: String, place: String, uri: String },
    #[error("{file}: {problem}")]
    Archive { file: String, problem: String },
}

fn listed(names: &[String]) -> String {
    const MAX_NAMES: usize = 8;
    if names.is_empty() {
        return "there are none".to_owned();
    }
    let mut text = names.iter().take(MAX_NAMES).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > MAX_NAMES {
        text.push_str(&format!(" and {} more", names.len() - MAX_NAMES));
    }
    text
}

/// An error at one place of a file. The loader adds the file name.
#[derive(Debug)]
pub(super) enum Problem {
    Invalid { place: String, expected: String, found: String },
    MissingFile { place: String, uri: String },
}

impl Problem {
    pub fn new(place: impl Into<String>, expected: impl Into<String>, found: impl ToString) -> Self {
        Self::Invalid { place: place.into(), expected: expected.into(), found: found.to_string() }
    }

    pub fn in_file(self, file: &str) -> LoadError {
        let file = file.to_owned();
        match self {
            Self::Invalid { place, expected, found } => LoadError::Invalid { file, place, expected, found },
            Self::MissingFile { place, uri } => LoadError::MissingFile { file, place, uri },
        }
    }
}

/// Places are those of a glTF, the only format whose files can lead here: the other readers check as they go.
impl From<AssetError> for Problem {
    fn from(problem: AssetError) -> Self {
        match problem {
            AssetError::Index { list, index, count } => Self::new(list, format!("an index below {count}"), index),
            AssetError::Geometry { mesh, primitive, problem } => {
                let place = format!("meshes[{mesh}].primitives[{primitive}]");
                match problem {
                    GeometryError::JointOutOfRange { vertex, joint, joints } => Self::new(
                        format!("{place}.attributes.JOINTS_n, vertex {vertex}"),
                        format!("a joint below {joints}, the size of the skin"),
                        joint,
                    ),
                    other => Self::new(place, "consistent geometry", other),
                }
            }
        }
    }
}
