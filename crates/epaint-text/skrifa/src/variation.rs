//! The axes of a variable font, of which there are none: epaint's code that lists them never runs.

use crate::Tag;
use crate::instance::Location;

/// A value that doesn't exist.
#[derive(Debug, Clone, Copy)]
pub enum Never {}

/// The axes of a font.
#[derive(Debug)]
pub struct AxisCollection;

impl AxisCollection {
    /// Iterates over the axes.
    pub fn iter(&self) -> std::iter::Empty<Axis> {
        std::iter::empty()
    }

    /// Returns the only location there is.
    pub fn location<Setting>(&self, _settings: impl IntoIterator<Item = Setting>) -> Location {
        Location
    }
}

/// An axis of a font.
#[derive(Debug)]
pub struct Axis(Never);

impl Axis {
    /// Its tag.
    pub fn tag(&self) -> Tag {
        match self.0 {}
    }

    /// Its name.
    pub fn name_id(&self) -> Never {
        self.0
    }

    /// Its minimum value.
    pub fn min_value(&self) -> f32 {
        match self.0 {}
    }

    /// Its maximum value.
    pub fn max_value(&self) -> f32 {
        match self.0 {}
    }

    /// Its default value.
    pub fn default_value(&self) -> f32 {
        match self.0 {}
    }

    /// Whether user interfaces should hide it.
    pub fn is_hidden(&self) -> bool {
        match self.0 {}
    }
}

/// The translations of a name.
#[derive(Debug)]
pub struct LocalizedStrings(Never);

impl LocalizedStrings {
    /// The English one, if there is one.
    pub fn english_or_first(self) -> Option<LocalizedString> {
        match self.0 {}
    }
}

/// A name in one language.
#[derive(Debug)]
pub struct LocalizedString(Never);

impl LocalizedString {
    /// Its characters.
    pub fn chars(&self) -> std::iter::Empty<char> {
        match self.0 {}
    }
}
