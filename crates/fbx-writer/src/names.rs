//! Names of objects: not empty, and unique even for programs that don't tell capitals apart.

use std::collections::{BTreeMap, BTreeSet};

/// The names that are taken.
#[derive(Debug, Default)]
pub struct Names {
    taken: BTreeSet<String>,
    /// The number to try first for a name that is taken.
    next: BTreeMap<String, u32>,
}

impl Names {
    /// Returns a name that no other object has, in capitals or not: `wanted`, or that with a number.
    pub fn unique(&mut self, wanted: &str) -> String {
        // A zero byte ends a name for programs written in C, and begins the class of an object.
        let wanted: String = wanted.chars().filter(|c| !matches!(c, '\0' | '\u{1}')).collect();
        let key = wanted.to_lowercase();
        if !key.is_empty() && self.taken.insert(key.clone()) {
            return wanted;
        }
        let next = self.next.entry(key.clone()).or_insert(2);
        loop {
            let number = *next;
            *next += 1;
            if self.taken.insert(format!("{key}_{number}")) {
                return format!("{wanted}_{number}");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Names;

    #[test]
    fn names_are_unique_without_capitals() {
        let mut names = Names::default();
        let wanted = ["Hips", "hips", "HIPS", "hips_2", "", "a\0\u{1}b"];
        let found = wanted.map(|name| names.unique(name));
        assert_eq!(found, ["Hips", "hips_2", "HIPS_3", "hips_2_2", "_2", "ab"]);
    }
}
