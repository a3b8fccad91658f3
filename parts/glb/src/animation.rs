//! A clip under construction.

use crate::{Glb, List, Object, check_size, quoted};

/// Maximum number of recently written key times that are searched for equal ones.
const MAX_COMPARED: usize = 64;

/// The samplers and channels of an animation.
#[derive(Default)]
pub struct Animation {
    /// Key times that have been written, with their accessors: channels with the same keys share them.
    times: Vec<(Vec<f32>, usize)>,
    samplers: List,
    channels: List,
}

impl Animation {
    /// Adds the keys of a node's property: `path` and `interpolation` are glTF's words.
    ///
    /// # Errors
    ///
    /// If the document becomes too large.
    pub fn add(
        &mut self,
        glb: &mut Glb,
        (node, path): (usize, &str),
        interpolation: &str,
        times: &[f32],
        values: &[f32],
    ) -> Result<(), String> {
        check_size(glb.len().saturating_add(4 * (times.len() + values.len())))?;
        let recent = self.times.iter().rev().take(MAX_COMPARED);
        let input = match recent.into_iter().find(|(others, _)| others == times) {
            Some(&(_, accessor)) => accessor,
            None => {
                let accessor = glb.floats(times, "SCALAR", None, true);
                self.times.push((times.to_vec(), accessor));
                accessor
            }
        };
        let kind = match path {
            "rotation" => "VEC4",
            "weights" => "SCALAR",
            _ => "VEC3",
        };
        let output = glb.floats(values, kind, None, false);
        let mut sampler = Object::new();
        sampler.index("input", input).string("interpolation", interpolation).index("output", output);
        let sampler = self.samplers.push(&sampler.end());
        self.channels
            .push(&format!("{{\"sampler\":{sampler},\"target\":{{\"node\":{node},\"path\":{}}}}}", quoted(path)));
        Ok(())
    }

    /// Appends the animation to the document, unless it has no channels.
    pub fn write(self, name: &str, glb: &mut Glb) {
        if self.channels.is_empty() {
            return;
        }
        let mut json = Object::new();
        if !name.is_empty() {
            json.string("name", name);
        }
        json.raw("samplers", &self.samplers.json()).raw("channels", &self.channels.json());
        glb.animations.push(&json.end());
    }
}
