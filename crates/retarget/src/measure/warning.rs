//! What is visibly wrong with a retargeted clip, in words.

use std::fmt;

use super::figures::Figures;
use super::verdict::{FACING_PATH, SKIN_STRETCH_MAX, Verdict};

/// A fault that figures show, and where.
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    /// The skin around a joint is torn: a part of the body is left behind, or is elsewhere than it was bound.
    TornSkin {
        /// The joint's name.
        joint: String,
        /// See [`Figures::skin_stretch_max`].
        stretch: f64,
    },
    /// A limb stays still although the motion's moves.
    IdleChain {
        /// A part of the body or the name of the first joint.
        chain: String,
    },
    /// The body faces otherwise along its path than its source.
    FacesAway {
        /// See [`Figures::facing_path_error_degrees_mean`].
        degrees: f64,
    },
}

impl FitWarning {
    /// Returns what is wrong, by the limits of [`Verdicts`](super::Verdicts).
    pub fn of(figures: &Figures) -> Vec<Self> {
        let needs_review = |value: &f64, limits: super::verdict::Limits| limits.verdict(*value) == Verdict::NeedsReview;
        let torn = figures.skin_stretch_max.filter(|value| needs_review(value, SKIN_STRETCH_MAX));
        let torn = torn.map(|stretch| Self::TornSkin {
            joint: figures.skin_stretch_max_joint.clone().unwrap_or_default(),
            stretch,
        });
        let away = figures.facing_path_error_degrees_mean.filter(|value| needs_review(value, FACING_PATH));
        let idle = figures.idle_chains.iter().map(|chain| Self::IdleChain { chain: chain.clone() });
        torn.into_iter().chain(idle).chain(away.map(|degrees| Self::FacesAway { degrees })).collect()
    }

    /// The kind of fault, for scripts.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TornSkin { .. } => "torn-skin",
            Self::IdleChain { .. } => "idle-chain",
            Self::FacesAway { .. } => "faces-away",
        }
    }
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TornSkin { joint, stretch } => write!(
                f,
                "the skin around “{joint}” is stretched to {stretch:.1} times its size; map the joint that carries it"
            ),
            Self::IdleChain { chain } => {
                write!(f, "“{chain}” stays still although the motion moves it; map its joints")
            }
            Self::FacesAway { degrees } => write!(
                f,
                "the body faces {degrees:.0}° away from where its source faces along its path; check left and right in the map, and \
                 the rest poses"
            ),
        }
    }
}
