//! A clip under construction.

use serde::Serialize;

use crate::{Glb, check_size};

/// Maximum number of recently written key times that are searched for equal ones.
const MAX_COMPARED: usize = 64;

/// An animation under construction, as glTF has it.
#[derive(Default, Serialize)]
pub struct Animation {
    /// Key times that have been written, with their accessors: channels with the same keys share them.
    #[serde(skip)]
    times: Vec<(Vec<f32>, usize)>,
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    samplers: Vec<Sampler>,
    channels: Vec<Channel>,
}

#[derive(Serialize)]
struct Sampler {
    input: usize,
    interpolation: &'static str,
    output: usize,
}

#[derive(Serialize)]
struct Channel {
    sampler: usize,
    target: Target,
}

#[derive(Serialize)]
struct Target {
    node: usize,
    path: &'static str,
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
        (node, path): (usize, &'static str),
        interpolation: &'static str,
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
        self.channels.push(Channel { sampler: self.samplers.len(), target: Target { node, path } });
        self.samplers.push(Sampler { input, interpolation, output });
        Ok(())
    }

    /// Appends the animation to the document, unless it has no channels.
    pub fn write(self, name: &str, glb: &mut Glb) {
        if !self.channels.is_empty() {
            glb.animations.push(Animation { times: Vec::new(), name: name.to_owned(), ..self });
        }
    }
}
