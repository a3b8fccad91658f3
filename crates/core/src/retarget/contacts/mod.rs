//! Contacts of the body with itself and of hands and knees with the ground: where the source touches, and whether the target does.
//! Bodies are approximated by one solid per body part, fitted to the vertices that follow it or, without a mesh, guessed from the
//! skeleton.

mod arm;
mod body;
mod ground;
mod keep;
mod knees;
mod parts;
mod scene;
mod shape;
mod smooth;
mod solid;
mod touch;

pub use body::{Bodies, BodyMotion};
pub use ground::Ground;
pub use keep::kept_hands;
pub use knees::rested_knees;
pub use scene::Scene;
pub use touch::TouchFigures;
