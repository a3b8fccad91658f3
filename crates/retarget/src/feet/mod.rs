//! Foot contacts, and feet planted where they touch the ground.

mod body;
mod contacts;
mod height;
mod leg;
mod level;
mod plan;
mod plant;
mod sole;
mod width;

pub use contacts::{SourceContacts, contacts_of, ranges, source_contacts, source_height};
pub use height::standing_height;
pub use leg::{Leg, solve_leg};
pub use plant::{Planting, planted_channels};
pub use sole::{Sole, Soles, foot_pairs};
