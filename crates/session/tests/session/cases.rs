//! What most of these tests open, and where they begin.

use crate::program::Content;
use crate::world::{Act, World};

pub const FOX: Act = Act::Drop(&[("Fox.glb", Content::Model("fox"))]);
pub const MAN: Act = Act::Drop(&[("Man.glb", Content::Model("man"))]);
pub const DANCE: Act = Act::Drop(&[("dance.bvh", Content::Motion)]);

/// A page that shows the walker. The server has another model, too.
pub fn start() -> World {
    World::at_rest("model=walker", &[("walker", Content::Model("walker")), ("a.glb", Content::Model("a"))])
}
