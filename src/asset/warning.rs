//! Problems that do not prevent loading, but that the user is told.

use std::fmt;

/// A problem and how it was handled. `code` is stable and in kebab case: scripts and the page group by it.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    WeightsNormalized { mesh: String, vertices: usize },
    WeightsMissing { mesh: String, vertices: usize },
    InfluencesDropped { mesh: String, found: usize, kept: usize, largest_lost_weight: f32 },
    UnsupportedExtension { name: String },
    FoundByBareName { uri: String, used: String },
    ImageMissing { uri: String },
    ImageUnreadable { image: String, problem: String },
    MatrixNotDecomposable { node: String },
    ChannelIgnored { clip: String, place: String, problem: String },
    Other { code: &'static str, place: String, problem: String },
}

impl Warning {
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
                write!(f, "image “{uri}” is not among the files; drop it together with the model")
            }
            Self::ImageUnreadable { image, problem } => write!(f, "image {image} cannot be read: {problem}"),
            Self::MatrixNotDecomposable { node } => {
                write!(f, "{node}: its matrix is sheared or singular and has no exact translation, rotation and scale")
            }
            Self::ChannelIgnored { clip, place, problem } => write!(f, "clip “{clip}”, {place} is left out: {problem}"),
            Self::Other { place, problem, .. } => write!(f, "{place}: {problem}"),
        }
    }
}

/// Warnings in the order in which they occurred.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Warnings(pub Vec<Warning>);

impl Warnings {
    /// Limit per code, so that a broken file does not fill the memory.
    const MAX_PER_CODE: usize = 100;

    pub fn push(&mut self, warning: Warning) {
        if self.0.iter().filter(|other| other.code() == warning.code()).count() < Self::MAX_PER_CODE {
            self.0.push(warning);
        }
    }

    pub fn iter(&self) -> std::slice::Iter<'_, Warning> {
        self.0.iter()
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
