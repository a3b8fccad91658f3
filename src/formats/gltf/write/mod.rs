//! Writing GLB: a model's own file with clips added, a model of another format, or a skeleton with clips and nothing else.
//!
//! What a model's file says is not understood and said again: its JSON is kept as text, member by member, and only grows
//! where clips need it. So extensions and extras that are not known here survive, and so does every digit.

mod asset;
mod clip;
mod error;
mod glb;
mod json;
mod model;
mod motion;

pub use asset::asset;
pub use error::WriteError;
pub use model::model;
pub use motion::motion;
