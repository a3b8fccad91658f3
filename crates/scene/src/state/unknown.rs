//! Names in a view that the model doesn't have.

use std::fmt;

use gaitway_character::sort::sort_by;

/// What a name refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameKind {
    /// A clip, by name or index.
    Clip,
    /// A material variant.
    Variant,
    /// A joint, by name, index or body part.
    Joint,
    /// An avatar's expression.
    Expression,
}

/// A requested clip, variant, joint or expression that doesn't exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownName {
    /// What was requested.
    pub kind: NameKind,
    /// The requested name or index.
    pub name: String,
    /// The names that exist.
    pub names: Vec<String>,
}

impl UnknownName {
    /// Maximum number of names to list: a file may have hundreds of clips.
    const MAX_NAMES: usize = 5;

    /// Describes a valid request.
    pub fn expected(&self) -> &'static str {
        match self.kind {
            NameKind::Clip => "the name or index of a clip",
            NameKind::Variant => "the name of a material variant",
            NameKind::Joint => "the name, index or body part of a joint",
            NameKind::Expression => "the name of an expression",
        }
    }

    /// Returns the most similar names, or the first ones if an index was requested. Few names stay in the file's order.
    fn suggestions(&self) -> Vec<&str> {
        let wanted = beginning(&self.name);
        let similarity = |name: &String| strsim::jaro_winkler(&wanted, &beginning(name));
        let mut names: Vec<(f64, &str)> = self.names.iter().map(|name| (similarity(name), name.as_str())).collect();
        if names.len() > Self::MAX_NAMES && self.name.parse::<i64>().is_err() {
            sort_by(&mut names, |a, b| b.0.total_cmp(&a.0));
        }
        names.into_iter().map(|(_, name)| name).take(Self::MAX_NAMES).collect()
    }
}

/// “expected the name or index of a clip, found “Fly”; its clips are “Walk”, “Idle””.
impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = match self.kind {
            NameKind::Clip => "clips",
            NameKind::Variant => "variants",
            NameKind::Joint => "joints",
            NameKind::Expression => "expressions",
        };
        write!(f, "expected {}, found “{}”; ", self.expected(), self.name)?;
        let names = self.suggestions().iter().map(|name| format!("“{name}”")).collect::<Vec<_>>().join(", ");
        match self.names.len().saturating_sub(Self::MAX_NAMES) {
            _ if names.is_empty() => write!(f, "there are no {plural}"),
            0 => write!(f, "its {plural} are {names}"),
            more => write!(f, "its {plural} are {names} and {more} more"),
        }
    }
}

/// Returns the beginning of a name in lower case, for comparison: names in links and files may be of any length.
fn beginning(name: &str) -> String {
    const MAX_CHARS: usize = 64;
    name.chars().flat_map(char::to_lowercase).take(MAX_CHARS).collect()
}
