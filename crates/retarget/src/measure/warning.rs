//! What is visibly wrong with a retargeted clip, in words.

use std::fmt;

use super::figures::Figures;
use super::verdict::{FACING_PATH, Verdict};

/// Skin that is stretched more than this by joints out of place is torn. Clips of bodies in one piece stretch it by less than 1 %.
const MAX_TEAR: f64 = 1.1;

/// A fault that figures show, and where.
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    /// A limb stays still although the motion's moves.
    IdleChain {
        /// A part of the body or the name of the first joint.
        chain: String,
    },
    /// The skin is stretched by joints that aren't where they rest on their parents.
    TornSkin {
        /// See [`Figures::skin_tear_max_joint`].
        joint: String,
        /// See [`Figures::skin_tear_max`].
        stretch: f64,
    },
    /// The body faces another way along its path than its source does.
    FacesAway {
        /// See [`Figures::facing_path_error_degrees_mean`].
        degrees: f64,
    },
    /// Feet aren't planted and contacts aren't kept.
    TooLong,
}

impl FitWarning {
    /// Returns what is wrong, by the limits of [`Verdicts`](super::Verdicts).
    pub fn of(figures: &Figures) -> Vec<Self> {
        let needs_review = |degrees: &f64| FACING_PATH.verdict(*degrees) == Verdict::NeedsReview;
        let away = figures.facing_path_error_degrees_mean.filter(needs_review);
        let idle = figures.idle_chains.iter().map(|chain| Self::IdleChain { chain: chain.clone() });
        let torn = figures.skin_tear_max.filter(|&stretch| stretch > MAX_TEAR).zip(figures.skin_tear_max_joint.clone());
        let torn = torn.map(|(stretch, joint)| Self::TornSkin { joint, stretch });
        let too_long = figures.is_too_long.then_some(Self::TooLong);
        idle.chain(torn).chain(away.map(|degrees| Self::FacesAway { degrees })).chain(too_long).collect()
    }

    /// The kind of fault, for scripts.
    pub fn code(&self) -> &'static str {
        match self {
            Self::IdleChain { .. } => "idle-chain",
            Self::TornSkin { .. } => "torn-skin",
            Self::FacesAway { .. } => "faces-away",
            Self::TooLong => "too-long",
        }
    }
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IdleChain { chain } => {
                write!(f, "“{chain}” stays still although the motion moves it; map its joints")
            }
            Self::TornSkin { joint, stretch } => write!(
                f,
                "the skin around “{joint}” is torn, {stretch:.1} times as long as it should be: a joint leaves its place on its \
                 parent; check which joint follows which"
            ),
            Self::FacesAway { degrees } => write!(
                f,
                "the body faces {degrees:.0}° away from where its source faces along its path; check left and right in the map, \
                 and the rest poses"
            ),
            Self::TooLong => f.write_str(
                "the clip is too long for its feet to be planted or its contacts to be kept; cut it into shorter ones",
            ),
        }
    }
}
