//! How well a retargeted clip follows its source, and the source beside it.

mod figures;
mod foot_track;
mod smoothness;
mod stage;
mod verdict;

pub use figures::{Figures, MeasuredClip, measure};
pub use foot_track::FootTrack;
pub use stage::{StagePair, model_from_source, stage_pairs};
pub use verdict::{Verdict, Verdicts};
