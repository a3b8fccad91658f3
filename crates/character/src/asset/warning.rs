//! Problems that do not prevent loading but are reported to the user.

use std::fmt;

/// A problem and how it was handled. `code` is stable and in kebab case: scripts and the page group by it.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Weights that did not sum to 1; they were divided by their sum.
    WeightsNormalized {
        /// The primitive, such as `meshes[0].primitives[1]`, or the .attach file.
        mesh: String,
        /// Number of vertices affected.
        vertices: usize,
    },
    /// Vertices without any weight; they follow the skin's first joint.
    WeightsMissing {
        /// The primitive, such as `meshes[0].primitives[1]`, or the .attach file.
        mesh: String,
        /// Number of vertices affected.
        vertices: usize,
    },
    /// Vertices with more than [`MAX_INFLUENCES`](crate::mesh::MAX_INFLUENCES); the weakest were dropped.
    InfluencesDropped {
        /// The primitive, such as `meshes[0].primitives[1]`, or the .attach file.
        mesh: String,
        /// Largest number of influences that a vertex had.
        found: usize,
        /// Largest number of influences that a vertex has now.
        kept: usize,
        /// Largest weight dropped, as a fraction of its vertex's sum.
        largest_lost_weight: f32,
    },
    /// An optional glTF extension that is ignored.
    UnsupportedExtension {
        /// As in `extensionsUsed`.
        name: String,
    },
    /// A file that is not where the reference says; one with the same bare name was used.
    FoundByBareName {
        /// The reference, percent-decoded.
        uri: String,
        /// Path of the file used.
        used: String,
    },
    /// An image file that was not supplied.
    ImageMissing {
        /// The reference, percent-decoded.
        uri: String,
    },
    /// An image that is broken, too large or of an unsupported kind.
    ImageUnreadable {
        /// Its place in the file, its name, its URI or its index.
        image: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A sheared or singular node matrix; it is approximated by a translation, rotation and scale.
    MatrixNotDecomposable {
        /// The node, such as `nodes[3]`.
        node: String,
    },
    /// An animation channel that was left out.
    ChannelIgnored {
        /// Name of its clip.
        clip: String,
        /// The channel's place in the file.
        place: String,
        /// Why it was left out.
        problem: String,
    },
    /// A .bvh ends before its frames do.
    FramesMissing {
        /// Line of the file.
        line: String,
        /// What is missing, and how it was handled.
        problem: String,
    },
    /// A problem without a variant of its own.
    Other {
        /// What [`Warning::code`] returns.
        code: &'static str,
        /// Place in the file; empty if `problem` names it or concerns the whole file.
        place: String,
        /// What is wrong, and how it was handled.
        problem: String,
    },
}

impl Warning {
    /// Returns the code to group by.
    pub fn code(&self) -> &'static str {
        match self {
            Self::WeightsNormalized { .. } => "weights-normalized",
            Self::WeightsMissing { .. } => "weights-missing",
            Self::InfluencesDropped { .. } => "influences-dropped",
            Self::UnsupportedExtension { .. } => "unsupported-extension",
            Self::FoundByBareName { .. } => "found-by-bare-name",
            Self::ImageMissing { .. } => "image-missing",
            Self::ImageUnreadable { .. } => "image-unreadable",
            Self::MatrixNotDecomposable { .. } => "matrix-not-decomposable",
            Self::ChannelIgnored { .. } => "channel-ignored",
            Self::FramesMissing { .. } => "bvh-motion",
            Self::Other { code, .. } => code,
        }
    }

    /// The place in the file.
    pub fn place(&self) -> &str {
        match self {
            Self::WeightsNormalized { mesh, .. }
            | Self::WeightsMissing { mesh, .. }
            | Self::InfluencesDropped { mesh, .. } => mesh,
            Self::UnsupportedExtension { .. } => "extensionsUsed",
            Self::FoundByBareName { uri, .. } | Self::ImageMissing { uri } => uri,
            Self::ImageUnreadable { image, .. } => image,
            Self::MatrixNotDecomposable { node } => node,
            Self::FramesMissing { line, .. } => line,
            Self::ChannelIgnored { place, .. } | Self::Other { place, .. } => place,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WeightsNormalized { mesh, vertices } => {
                write!(f, "{mesh}: weights of {vertices} vertices did not add up to 1 and were divided by their sum")
            }
            Self::WeightsMissing { mesh, vertices } => {
                write!(f, "{mesh}: {vertices} vertices have no weight at all and follow the skin's first joint")
            }
            Self::InfluencesDropped { mesh, found, kept, largest_lost_weight } => write!(
                f,
                "{mesh}: up to {found} influences per vertex, the strongest {kept} are kept (largest weight lost: {largest_lost_weight:.4})"
            ),
            Self::UnsupportedExtension { name } => {
                write!(f, "extension {name} is not supported; shown without it")
            }
            Self::FoundByBareName { uri, used } => write!(f, "“{uri}” was not found; “{used}” was used instead"),
            Self::ImageMissing { uri } => {
                write!(f, "image “{uri}” is not among the files; open it with the model")
            }
            Self::ImageUnreadable { image, problem } => write!(f, "image {image} cannot be read: {problem}"),
            Self::MatrixNotDecomposable { node } => {
                write!(f, "{node}: its matrix is sheared or singular and has no exact translation, rotation and scale")
            }
            Self::ChannelIgnored { clip, place, problem } => write!(f, "clip “{clip}”, {place} is left out: {problem}"),
            Self::FramesMissing { line, problem } => write!(f, "{line}: {problem}"),
            Self::Other { place, problem, .. } if place.is_empty() => f.write_str(problem),
            Self::Other { place, problem, .. } => write!(f, "{place}: {problem}"),
        }
    }
}

/// Warnings in the order in which they occurred.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Warnings(pub Vec<Warning>);

impl Warnings {
    /// Limit per code, so that a broken file can't exhaust memory.
    const MAX_PER_CODE: usize = 100;

    /// Adds a warning unless it was added before or its code has reached the limit.
    pub fn push(&mut self, warning: Warning) {
        let mut alike = self.0.iter().filter(|other| other.code() == warning.code());
        if alike.clone().count() < Self::MAX_PER_CODE && !alike.any(|other| *other == warning) {
            self.0.push(warning);
        }
    }

    /// Iterates over the warnings in the order in which they occurred.
    pub fn iter(&self) -> std::slice::Iter<'_, Warning> {
        self.0.iter()
    }

    /// Number of warnings kept.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_warnings_are_one() {
        let mut warnings = Warnings::default();
        for uri in ["a.png", "b.png", "a.png"] {
            warnings.push(Warning::ImageMissing { uri: uri.to_owned() });
        }
        assert_eq!(warnings.len(), 2);
    }
}
