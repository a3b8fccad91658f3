//! How well a retargeted clip follows its source, and the source beside it.

mod facing;
mod figures;
mod foot_track;
mod limbs;
mod moments;
mod played;
mod smoothness;
mod stage;
mod stretch;
mod verdict;
mod warning;

pub use figures::{Figures, MeasuredClip, measure};
pub use foot_track::FootTrack;
pub use stage::{StagePair, model_from_source, stage_pairs};
pub use verdict::{Verdict, Verdicts};
pub use warning::FitWarning;
