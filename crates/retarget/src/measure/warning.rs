//! What is visibly wrong with a retargeted clip, in words.

use std::fmt;

use super::figures::Figures;
use super::verdict::{FACING_PATH, Verdict};

/// A fault that figures show, and where.
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    /// A limb stays still although the motion's moves.
    IdleChain {
        /// A part of the body or the name of the first joint.
        chain: String,
    },
    /// The body faces another way along its path than its source does.
    FacesAway {
        /// See [`Figures::facing_path_error_degrees_mean`].
        degrees: f64,
    },
}

impl FitWarning {
    /// Returns what is wrong, by the limits of [`Verdicts`](super::Verdicts).
    pub fn of(figures: &Figures) -> Vec<Self> {
        let needs_review = |degrees: &f64| FACING_PATH.verdict(*degrees) == Verdict::NeedsReview;
        let away = figures.facing_path_error_degrees_mean.filter(needs_review);
        let idle = figures.idle_chains.iter().map(|chain| Self::IdleChain { chain: chain.clone() });
        idle.chain(away.map(|degrees| Self::FacesAway { degrees })).collect()
    }

    /// The kind of fault, for scripts.
    pub fn code(&self) -> &'static str {
        match self {
            Self::IdleChain { .. } => "idle-chain",
            Self::FacesAway { .. } => "faces-away",
        }
    }
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IdleChain { chain } => {
                write!(f, "“{chain}” stays still although the motion moves it; map its joints")
            }
            Self::FacesAway { degrees } => write!(
                f,
                "the body faces {degrees:.0}° away from where its source faces along its path; check left and right in the map, \
                 and the rest poses"
            ),
        }
    }
}
