//! How well a retargeted clip follows its source.

mod figures;
mod stage;

pub use figures::{Figures, FootTrack};
pub use stage::StagePair;
