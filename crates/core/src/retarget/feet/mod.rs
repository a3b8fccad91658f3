//! Foot contacts, and feet planted where they touch the ground.

mod body;
mod contacts;
mod height;
mod leg;
mod level;
mod limit;
mod plan;
mod plant;
mod sole;
mod width;

pub use body::near;
pub use contacts::{SourceContacts, source_contacts, source_height};
pub use leg::limb_rotations;
pub use limit::limit_turns;
pub use plant::{Planting, dense_times, planted_channels};
pub use sole::{Sole, Soles};
