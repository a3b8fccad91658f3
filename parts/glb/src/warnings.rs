//! What could not be carried over, in sentences.

/// Maximum number of sentences.
const MAX_SENTENCES: usize = 100;

/// Sentences for the user, each once.
#[derive(Default)]
pub struct Warnings {
    sentences: Vec<String>,
    /// Number of sentences beyond the maximum.
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

    /// Returns the sentences in the order they were added.
    pub fn into_sentences(mut self) -> Vec<String> {
        if self.more > 0 {
            self.sentences.push(format!("{} more warnings.", self.more));
        }
        self.sentences
    }
}
