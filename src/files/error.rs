//! Why nothing could be opened, on disk or on the network.

use std::path::PathBuf;

use gaitway_formats::LoadError;
use gaitway_session::ErrorCode;

use super::SortError;

/// Names the file and, where possible, what to do next.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// No files, folders, URLs or samples were given.
    #[error("there is nothing to open: expected files or URLs")]
    Nothing,
    /// No bundled sample has this name.
    #[error("{name}: there is no such sample; the samples are: {}", known.join(", "))]
    NoSuchSample {
        /// As asked for, with `sample:`.
        name: String,
        /// All samples, with `sample:`.
        known: Vec<String>,
    },
    /// Together, the files exceed the memory budget.
    #[error("{name}: exceeds the limit of {} MiB in all{}", max >> 20, memory_hint())]
    TooLarge {
        /// The file that exceeds it.
        name: String,
        /// The budget in bytes.
        max: u64,
    },

    /// A file or folder on disk cannot be read.
    #[error("{}: {}", path.display(), describe(source))]
    Read {
        /// Its path.
        path: PathBuf,
        /// The underlying error, usually from the operating system.
        source: std::io::Error,
    },
    /// A link names a file that the user hasn't named, outside the folders of those named.
    #[error("{}: a link can only name what is opened with it, and files in the same folders or below", path.display())]
    NotGiven {
        /// As the link has it.
        path: PathBuf,
    },
    /// Standard input was named a second time.
    #[error("-: standard input can be read only once; name a file instead")]
    StandardInputTwice,
    /// The folders that are opened together have too many files, counting subfolders.
    #[error("{}: more than {max} files in folders; name the model's own files instead", path.display())]
    TooManyFiles {
        /// The folder that exceeds it.
        path: PathBuf,
        /// Maximum number of files.
        max: usize,
    },

    /// An address on the page does not form a URL.
    #[error("{url}: not a URL; expected something like https://example.org/character.glb")]
    InvalidUrl {
        /// The address as given.
        url: String,
    },
    /// The server answered with a status other than success.
    #[error("{url}: the server answered {status}{}", status_hint(*status, *may_drop))]
    Status {
        /// The requested file.
        url: String,
        /// HTTP status code.
        status: u16,
        /// Whether the user may drop files, which the message then advises.
        may_drop: bool,
    },
    /// The fetch failed although the site answers: CORS, or an error page without CORS headers.
    #[error(
        "{url}: the site is there, but does not allow other pages to read this file (CORS), or there is no such file{}",
        if *may_drop { "; download the file and drop it here instead" } else { "" }
    )]
    Refused {
        /// The requested file.
        url: String,
        /// Whether the user may drop files, which the message then advises.
        may_drop: bool,
    },
    /// The fetch failed and the site does not answer.
    #[error("{url}: the site cannot be reached; check the URL and the connection")]
    Unreachable {
        /// The requested file.
        url: String,
    },
    /// The site sent nothing for too long, before or during the transfer.
    #[error(
        "{url}: nothing has come from the site for {secs} seconds; try again later{}",
        if *may_drop { ", or download the file and drop it here" } else { "" }
    )]
    Silent {
        /// The requested file.
        url: String,
        /// How long, in seconds.
        secs: u32,
        /// Whether the user may drop files, which the message then advises.
        may_drop: bool,
    },
    /// Browsers block http URLs on https pages, except those of the same machine.
    #[error("{url}: a page loaded over https cannot read http URLs; try the same URL with https")]
    Insecure {
        /// The requested file.
        url: String,
    },
    /// The transfer ended early.
    #[error("{url}: the connection was lost after {received} bytes")]
    BrokeOff {
        /// The requested file.
        url: String,
        /// Bytes received until then.
        received: u64,
    },

    /// A file needs a part of the page that cannot be downloaded.
    #[error("{file}: needs Gaitway's {part}, which cannot be loaded: {problem}")]
    PartMissing {
        /// Name of the file.
        file: String,
        /// What the part is called.
        part: &'static str,
        /// Why not.
        problem: String,
    },

    /// The files were read, but cannot be used.
    #[error(transparent)]
    Files(#[from] SortError),
}

impl OpenError {
    /// Returns what kind of failure this is.
    pub fn code(&self) -> ErrorCode {
        match self {
            Self::Nothing | Self::StandardInputTwice | Self::InvalidUrl { .. } => ErrorCode::Malformed,
            Self::NoSuchSample { .. }
            | Self::Read { .. }
            | Self::NotGiven { .. }
            | Self::Status { .. }
            | Self::Unreachable { .. }
            | Self::Silent { .. }
            | Self::BrokeOff { .. }
            | Self::PartMissing { .. } => ErrorCode::NotFound,
            Self::Refused { .. } | Self::Insecure { .. } => ErrorCode::CrossOrigin,
            Self::TooLarge { .. } | Self::TooManyFiles { .. } => ErrorCode::TooLarge,
            Self::Files(problem) => match problem {
                SortError::Load(problem) => load_code(problem),
                SortError::Map { .. } | SortError::Hdr { .. } => ErrorCode::Malformed,
                SortError::MapTooLarge { .. } | SortError::TooManyModels { .. } | SortError::TooManyMotions { .. } => {
                    ErrorCode::TooLarge
                }
                SortError::SeveralModels { .. } | SortError::NoModel { .. } | SortError::SeveralMaps { .. } => {
                    ErrorCode::Unsupported
                }
            },
        }
    }
}

fn load_code(problem: &LoadError) -> ErrorCode {
    match problem {
        LoadError::NoSuchFile { .. } | LoadError::MissingFile { .. } => ErrorCode::NotFound,
        LoadError::NoModel { .. }
        | LoadError::SeveralModels { .. }
        | LoadError::UnsupportedFormat { .. }
        | LoadError::UnsupportedVersion { .. }
        | LoadError::RequiredExtension { .. } => ErrorCode::Unsupported,
        LoadError::TooLarge { .. } => ErrorCode::TooLarge,
        LoadError::Json { .. }
        | LoadError::Invalid { .. }
        | LoadError::Archive { .. }
        | LoadError::Conversion { .. } => ErrorCode::Malformed,
    }
}

/// Describes an error of the operating system without its number.
pub(crate) fn describe(problem: &std::io::Error) -> String {
    use std::io::ErrorKind;
    let text = match problem.kind() {
        ErrorKind::NotFound => "there is no such file",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::IsADirectory => "this is a folder, not a file",
        ErrorKind::NotADirectory => "a part of this path is a file, not a folder",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "there is no space left",
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only",
        _ => {
            let text = problem.to_string();
            return text.rsplit_once(" (os error").map_or(text.clone(), |(text, _)| text.to_owned());
        }
    };
    text.to_owned()
}

fn memory_hint() -> &'static str {
    if cfg!(target_arch = "wasm32") {
        ", more than a browser can hold; try the desktop window (`gaitway FILE`)"
    } else {
        ", the most that is read at once"
    }
}

fn status_hint(status: u16, may_drop: bool) -> &'static str {
    match status {
        401 | 403 if may_drop => " (not allowed); download the file and drop it here instead",
        401 | 403 => " (not allowed)",
        404 | 410 => " (there is no such file)",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_those_who_may_drop_files_are_advised_to() {
        let url = "https://example.org/fox.glb";
        let errors = |may_drop| {
            let url = || url.to_owned();
            let status = |status| OpenError::Status { url: url(), status, may_drop };
            let silent = OpenError::Silent { url: url(), secs: 20, may_drop };
            [status(401), status(403), OpenError::Refused { url: url(), may_drop }, silent]
                .map(|error| error.to_string())
        };
        for (advised, plain) in errors(true).iter().zip(errors(false)) {
            assert!(advised.contains("download the file and drop it here"), "{advised}");
            assert!(!plain.contains("drop"), "{plain}");
            assert!(advised.starts_with(&plain), "{plain}");
        }
    }
}
