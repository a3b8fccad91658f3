//! Contacts of the body with itself and of hands and knees with the ground: where the source touches, and whether the target does.
//! Bodies are approximated by one solid per body part, fitted to the vertices that follow it or, without a mesh, guessed from the
//! skeleton.
//!
//! Solids instead of meshes, so that a place on one body has its counterpart on the other. Fitting them takes about half a
//! millisecond, so each retargeting does it when it first needs them. The ground is the one that planted feet stand on
//! (`feet`).
//!
//! Hips and legs come first (`knees`), then the trunk, where arms are too short (`trunk`), then wrists and ankles (`limbs`).
//! Each step corrects the clip of the one before. The figures look at the same `SourceScene`.

mod arm;
mod bodies;
mod body;
mod ground;
mod knees;
mod limb;
mod limbs;
mod parts;
mod scene;
mod shape;
mod smooth;
mod solid;
mod touch;
mod trunk;
mod wish;

pub use bodies::Bodies;
pub use body::BodyMotion;
pub use knees::grounded_knees;
pub use limbs::kept_limbs;
pub use scene::{Scene, SourceScene};
pub use touch::TouchFigures;
pub use trunk::leaning_trunk;

/// Shares of the body's height: a wrist, an ankle, a knee or the hips are never moved further than the first, and moves below the second are
/// none.
const MAX_MOVE: f64 = 0.105;
const MIN_MOVE: f64 = 1e-4;

/// How far a bone of an arm or a leg may be turned, and how fast.
const MAX_TURN_DEGREES: f64 = 50.0;
const MAX_TURN_DEGREES_PER_SEC: f64 = 250.0;
