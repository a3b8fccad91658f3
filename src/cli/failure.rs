//! Why a command failed: a text for people and, with `--json`, its parts for scripts.

use std::fmt::Display;

use gaitway_formats::{LoadError, WriteError};
use gaitway_retarget::{MapError, RetargetError};
use gaitway_scene::library::BorrowError;
use gaitway_scene::state::UnknownName;
use serde::Serialize;

use crate::files::{OpenError, SaveError, SortError};

/// The result of a command or a part of one.
pub type Outcome<T = ()> = Result<T, Failure>;

/// The member `error` of the document that `--json` prints. Unknown parts are left out. Boxed strings keep results small.
#[derive(Debug, Default, Serialize)]
pub struct Failure {
    /// All of it, as people read it: `FILE: PLACE: expected X, found Y; HINT`.
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<Box<str>>,
    /// A JSON path, or a line of a text format.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    place: Option<Box<str>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<Box<str>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    found: Option<Box<str>>,
    /// What to do, or which alternatives exist.
    #[serde(skip_serializing_if = "Option::is_none")]
    hint: Option<Box<str>>,
}

impl Failure {
    pub(super) fn new(message: impl Display) -> Self {
        Self::default().saying(message)
    }

    pub(super) fn expected(expected: impl Into<String>, found: impl Into<String>) -> Self {
        let (expected, found) = (expected.into(), found.into());
        let message = format!("expected {expected}, found {found}");
        Self::parts(None, None, Some(&expected), Some(&found)).saying(message)
    }

    /// Adds what to do.
    pub(super) fn with_hint(self, hint: impl Display) -> Self {
        let message = format!("{}; {hint}", self.message);
        self.saying(message)
    }

    /// Adds the place in the file, before the file itself.
    pub(super) fn at(mut self, place: &str) -> Self {
        self.message = format!("{place}: {}", self.message);
        self.place = Some(place.into());
        self
    }

    /// Adds the name of the file.
    pub(super) fn in_file(mut self, file: impl Display) -> Self {
        self.message = format!("{file}: {}", self.message);
        self.file = Some(file.to_string().into());
        self
    }

    /// Returns the message for people.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Sets the message. All our messages have the hint, if any, after the last semicolon.
    fn saying(mut self, message: impl Display) -> Self {
        self.message = message.to_string();
        let file = self.file.as_deref().unwrap_or_default();
        let text = self.message.strip_prefix(file).unwrap_or(&self.message);
        self.hint = text.rsplit_once("; ").map(|(_, hint)| hint.into());
        self
    }

    /// Keeps the parts and adds the text that they are from.
    fn parts(file: Option<&str>, place: Option<&str>, expected: Option<&str>, found: Option<&str>) -> Self {
        let [file, place, expected, found] = [file, place, expected, found].map(|part| part.map(Into::into));
        Self { file, place, expected, found, ..Self::default() }
    }

    fn of_file(file: &str) -> Self {
        Self::parts(Some(file), None, None, None)
    }
}

impl From<UnknownName> for Failure {
    fn from(unknown: UnknownName) -> Self {
        let found = format!("“{}”", unknown.name);
        Self::parts(None, None, Some(unknown.expected()), Some(&found)).saying(unknown)
    }
}

fn load_parts(error: &LoadError) -> Failure {
    match error {
        LoadError::Invalid { file, place, expected, found } | LoadError::TooLarge { file, place, expected, found } => {
            let place = Some(place.as_str()).filter(|place| !place.is_empty());
            Failure::parts(Some(file), place, Some(expected), Some(found))
        }
        LoadError::Json { file, place, .. } => Failure::parts(Some(file), Some(place), None, None),
        LoadError::MissingFile { file, place, uri } => Failure::parts(Some(file), Some(place), Some(uri), None),
        LoadError::UnsupportedFormat { file, .. }
        | LoadError::UnsupportedVersion { file, .. }
        | LoadError::RequiredExtension { file, .. }
        | LoadError::Archive { file, .. }
        | LoadError::Conversion { file, .. } => Failure::of_file(file),
        LoadError::NoModel { .. } | LoadError::NoSuchFile { .. } | LoadError::SeveralModels { .. } => {
            Failure::default()
        }
    }
}

fn map_parts(error: &MapError) -> Failure {
    let (expected, found) = error.expected_and_found().unzip();
    Failure::parts(None, error.path(), expected.as_deref(), found.as_deref())
}

fn sort_parts(error: &SortError) -> Failure {
    match error {
        SortError::Load(error) => load_parts(error),
        SortError::Map { file, problem } => Failure { file: Some(file.as_str().into()), ..map_parts(problem) },
        _ => Failure::default(),
    }
}

fn open_parts(error: &OpenError) -> Failure {
    match error {
        OpenError::Read { path, .. } | OpenError::NotGiven { path } | OpenError::TooManyFiles { path, .. } => {
            Failure::of_file(&path.display().to_string())
        }
        OpenError::NoSuchSample { name, .. } | OpenError::TooLarge { name, .. } => Failure::of_file(name),
        OpenError::Files(error) => sort_parts(error),
        _ => Failure::default(),
    }
}

fn save_parts(error: &SaveError) -> Failure {
    let (SaveError::IsInput { path } | SaveError::NoFolder { path, .. } | SaveError::Write { path, .. }) = error;
    Failure::of_file(&path.display().to_string())
}

fn write_parts(error: &WriteError) -> Failure {
    match error {
        WriteError::Read(error) => load_parts(error),
        WriteError::OtherSkeleton { file, .. } | WriteError::OtherParent { file, .. } => Failure::of_file(file),
        WriteError::EmptyClip { .. }
        | WriteError::NotFinite { .. }
        | WriteError::NoBody { .. }
        | WriteError::TooLong { .. }
        | WriteError::TooLarge { .. } => Failure::default(),
    }
}

fn borrow_parts(error: &BorrowError) -> Failure {
    match error {
        BorrowError::Map { motion, problem } => Failure { file: Some(motion.as_str().into()), ..map_parts(problem) },
        BorrowError::Retarget { motion, .. } => Failure::of_file(motion),
    }
}

macro_rules! failure_from {
    ($($error:ty: $parts:expr,)*) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                let parts: fn(&$error) -> Failure = $parts;
                parts(&error).saying(&error)
            }
        })*
    };
}

failure_from! {
    LoadError: load_parts,
    MapError: map_parts,
    OpenError: open_parts,
    SortError: sort_parts,
    SaveError: save_parts,
    WriteError: write_parts,
    BorrowError: borrow_parts,
    RetargetError: |_| Failure::default(),
}

#[cfg(feature = "render")]
failure_from! {
    gaitway_render::HeadlessError: |_| Failure::default(),
    gaitway_render::UploadError: |_| Failure::default(),
}

#[cfg(feature = "viewer")]
failure_from! {
    crate::app::WindowError: |_| Failure::default(),
}

/// The text of an operation that reports no parts.
impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::new(message)
    }
}
