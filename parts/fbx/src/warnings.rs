//! What could not be carried over, in sentences.

use ufbx::Scene;

/// Most sentences.
const MAX_SENTENCES: usize = 100;

/// Sentences for the user, each once.
#[derive(Default)]
pub struct Warnings {
    sentences: Vec<String>,
    /// How many more there would have been.
    more: usize,
}

impl Warnings {
    /// Adds a sentence.
    pub fn add(&mut self, sentence: String) {
        if self.sentences.contains(&sentence) {
            return;
        }
        if self.sentences.len() < MAX_SENTENCES {
            self.sentences.push(sentence);
        } else {
            self.more += 1;
        }
    }

    /// Adds "3 curves left out: …" if there are any.
    pub fn left_out(&mut self, count: usize, one: &str, many: &str, reason: &str) {
        if count > 0 {
            let noun = if count == 1 { one } else { many };
            self.add(format!("{count} {noun} left out: {reason}."));
        }
    }

    /// Adds what ufbx had to correct and what glTF has no place for.
    pub fn add_scene(&mut self, scene: &Scene) {
        let corrections = scene.metadata.warnings.as_ref();
        for (index, warning) in corrections.iter().enumerate() {
            let same = |other: &&ufbx::Warning| *other.description == *warning.description;
            if corrections[..index].iter().any(|other| same(&other)) {
                continue;
            }
            let count: usize = corrections.iter().filter(same).map(|warning| warning.count.max(1)).sum();
            let times = if count > 1 { format!(" ({count} times)") } else { String::new() };
            self.add(format!("Damaged FBX data corrected: {}{times}.", &*warning.description));
        }
        self.left_out(
            scene.nurbs_curves.count + scene.nurbs_surfaces.count + scene.nurbs_trim_surfaces.count,
            "NURBS object",
            "NURBS objects",
            "convert NURBS to polygons before exporting",
        );
        self.left_out(scene.line_curves.count, "line object", "line objects", "only meshes are converted");
        self.left_out(
            scene.cache_deformers.count,
            "geometry cache",
            "geometry caches",
            "bake the deformation to a skeleton or blend shapes",
        );
        let constraints = scene.constraints.as_ref().iter().filter(|constraint| constraint.active).count();
        self.left_out(
            constraints,
            "constraint",
            "constraints",
            "bake the animation before exporting if it moves wrongly",
        );
    }

    /// Returns the sentences in the order they were added.
    pub fn into_sentences(mut self) -> Vec<String> {
        if self.more > 0 {
            self.sentences.push(format!("{} more warnings.", self.more));
        }
        self.sentences
    }
}
