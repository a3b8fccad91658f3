//! Why nothing could be opened, on disk or on the network.

use std::path::PathBuf;

use super::SortError;

/// Names the file and, where possible, what to do next.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("there is nothing to open: expected files or URLs")]
    Nothing,
    #[error("{name}: there is no such sample; the samples are: {}", known.join(", "))]
    NoSuchSample { name: String, known: Vec<String> },
    #[error("{name}: more than {max} bytes in total{}", memory_hint())]
    TooLarge { name: String, max: u64 },

    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: more than {max} files in the folder; name the model's own files instead", path.display())]
    TooManyFiles { path: PathBuf, max: usize },

    #[error("{url}: not a URL; expected something like https://example.org/character.glb")]
    InvalidUrl { url: String },
    #[error("{url}: the server answered {status}{}", status_hint(*status))]
    Status { url: String, status: u16 },
    #[error(
        "{url}: the site is there, but does not allow other pages to read this file (CORS), or there is no such file; \
         download the file and drop it here instead"
    )]
    Refused { url: String },
    #[error("{url}: the site cannot be reached; check the URL and the connection")]
    Unreachable { url: String },
    #[error(
        "{url}: nothing has come from the site for {secs} seconds; try again later, or download the file and drop it here"
    )]
    Silent { url: String, secs: u32 },
    #[error("{url}: a page loaded over https cannot read http URLs; try the same URL with https")]
    Insecure { url: String },
    #[error("{url}: the connection was lost after {received} bytes")]
    BrokeOff { url: String, received: u64 },

    #[error(transparent)]
    Files(#[from] SortError),
}

fn memory_hint() -> &'static str {
    if cfg!(target_arch = "wasm32") {
        ", more than a browser can hold; try the desktop window (`gaitway FILE`)"
    } else {
        ", the most that is read at once"
    }
}

fn status_hint(status: u16) -> &'static str {
    match status {
        401 | 403 => " (not allowed); download the file and drop it here instead",
        404 | 410 => " (there is no such file)",
        _ => "",
    }
}
