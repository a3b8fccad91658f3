//! Why a load failed: the file, the place in it, what was expected, what was found and, if known, what to do.

use gaitway_character::asset::{AssetError, Warning, Warnings};
use gaitway_character::mesh::GeometryError;

/// Everything that makes a set of files unreadable. The user sees these texts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// No file of the set is a model or motion.
    #[error(
        "expected a model or a motion, found {}; Gaitway opens .glb, .gltf with its files, .vrm, .vrma, .fbx, .x, .bvh, .npy, .npz, .obj (with .skel and .attach), a .zip of these, a joint map (.json), or an environment (.hdr)",
        listed(found)
    )]
    NoModel {
        /// Names of all files in the set.
        found: Vec<String>,
    },
    /// No file of the set has the requested name.
    #[error("“{name}” is not among the files ({})", listed(found))]
    NoSuchFile {
        /// The requested name.
        name: String,
        /// Names of all files in the set.
        found: Vec<String>,
    },
    /// The set has more than one model or motion, where exactly one is expected.
    #[error("several models at once ({}); drop one of them with its own files", listed(found))]
    SeveralModels {
        /// Names of the models and motions.
        found: Vec<String>,
    },
    /// There is no model, but a file in a known format that Gaitway cannot read.
    #[error("{file}: {format} files cannot be read; {advice}")]
    UnsupportedFormat {
        /// Name of the file in the set.
        file: String,
        /// The format as the user knows it, such as "COLLADA".
        format: &'static str,
        /// How to convert the file.
        advice: &'static str,
    },
    /// The glTF has no version, has one other than 2.x, or has a `minVersion` other than 2.0.
    #[error(
        "{file}: this is glTF {found}; Gaitway reads glTF 2.0; convert it, for example by importing and exporting it again"
    )]
    UnsupportedVersion {
        /// Name of the file in the set.
        file: String,
        /// The version, completing "this is glTF …".
        found: String,
    },
    /// The glTF lists an unsupported extension in `extensionsRequired`.
    #[error("{file}: needs the extension {name}, which is not supported; {advice}")]
    RequiredExtension {
        /// Name of the file in the set.
        file: String,
        /// Name of the extension, such as "KHR_gaussian_splatting".
        name: String,
        /// How to export or convert the file without the extension.
        advice: &'static str,
    },
    /// The text is not JSON.
    #[error("{file}: not valid JSON, {place}: {problem}")]
    Json {
        /// Name of the file in the set.
        file: String,
        /// Line and column, both from 1, or the JSON path in a GLB, whose text nobody sees.
        place: String,
        /// The JSON parser's message in plain words.
        problem: String,
    },
    /// Something else in the file is malformed, cut short or inconsistent.
    #[error("{file}: {}expected {expected}, found {found}", prefix(place))]
    Invalid {
        /// Name of the file in the set.
        file: String,
        /// Where in the file: a JSON path such as `accessors[3].count`, or a line of a text format. Empty if it concerns
        /// the whole file.
        place: String,
        /// What a valid file has there.
        expected: String,
        /// What this file has there.
        found: String,
    },
    /// A file exceeds one of the limits on what is read.
    #[error("{file}: {}expected {expected}, found {found}", prefix(place))]
    TooLarge {
        /// Name of the file in the set.
        file: String,
        /// Where in the file, as in [`Self::Invalid`].
        place: String,
        /// The limit.
        expected: String,
        /// What this file has.
        found: String,
    },
    /// A file that the model needs is not in the set.
    #[error("{file}: {place} is “{uri}”, which {}; open them together", where_missing(uri))]
    MissingFile {
        /// Name of the file that needs it.
        file: String,
        /// What refers to it: a JSON path such as `buffers[0].uri`, or the role of an .obj's companion.
        place: String,
        /// The missing file's percent-decoded URI, or its bare name if it is a companion.
        uri: String,
    },
    /// A zip archive is unreadable.
    #[error("{file}: {problem}")]
    Archive {
        /// Name of the archive.
        file: String,
        /// What is wrong with the archive, or with one of its entries.
        problem: String,
    },
    /// A file could not be converted into plain glTF, which is what is loaded.
    #[error("{file}: {problem}")]
    Conversion {
        /// Name of the file in the set.
        file: String,
        /// What the converter expected and found.
        problem: String,
    },
}

/// Returns a place as the start of a message.
fn prefix(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!("{place}: ") }
}

/// Files above the model's folder are not searched for, so they may well exist.
fn where_missing(uri: &str) -> &'static str {
    if uri.split(['/', '\\']).any(|part| part == "..") || uri.starts_with('/') {
        "may lie outside the model's folder and is not among the files"
    } else {
        "is not among the files"
    }
}

fn listed(names: &[String]) -> String {
    const MAX_NAMES: usize = 8;
    if names.is_empty() {
        return "no files".to_owned();
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
    Invalid {
        place: String,
        expected: String,
        found: String,
    },
    /// One of the [limits](super::limits) on what is read.
    Limit {
        place: String,
        expected: String,
        found: usize,
    },
    MissingFile {
        place: String,
        uri: String,
    },
}

impl Problem {
    pub fn new(place: impl Into<String>, expected: impl Into<String>, found: impl ToString) -> Self {
        Self::Invalid { place: place.into(), expected: expected.into(), found: found.to_string() }
    }

    /// Reports a problem with a part that is left out, unless it concerns the whole model. `outcome` says what happens
    /// instead.
    pub fn leave_out(self, code: &'static str, outcome: &str, warnings: &mut Warnings) -> Result<(), Self> {
        let Self::Invalid { place, expected, found } = self else { return Err(self) };
        let problem = format!("expected {expected}, found {found}; {outcome}");
        warnings.push(Warning::Other { code, place, problem });
        Ok(())
    }

    pub fn in_file(self, file: &str) -> LoadError {
        let file = file.to_owned();
        match self {
            Self::Invalid { place, expected, found } => LoadError::Invalid { file, place, expected, found },
            Self::Limit { place, expected, found } => {
                LoadError::TooLarge { file, place, expected, found: found.to_string() }
            }
            Self::MissingFile { place, uri } => LoadError::MissingFile { file, place, uri },
        }
    }
}

/// Names places as in a glTF, the only format whose files can fail here: the other readers check as they go.
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
