//! Keeps graphics drivers from printing to standard error.

#[cfg(unix)]
use std::fs::File;
#[cfg(unix)]
use std::io::stderr;
#[cfg(unix)]
use std::os::fd::{AsFd, OwnedFd};

/// While this exists, nothing reaches standard error. Mesa, for one, reports that there is no Wayland socket as an error and
/// then works without one.
#[cfg(unix)]
pub(super) struct Quiet(OwnedFd);

#[cfg(unix)]
impl Quiet {
    /// Returns `None`, and lets everything through, if standard error cannot be redirected.
    pub fn start() -> Option<Self> {
        let saved = stderr().as_fd().try_clone_to_owned().ok()?;
        let nowhere = File::options().write(true).open("/dev/null").ok()?;
        rustix::stdio::dup2_stderr(nowhere).ok()?;
        Some(Self(saved))
    }
}

#[cfg(unix)]
impl Drop for Quiet {
    fn drop(&mut self) {
        // It was standard error before.
        let _ = rustix::stdio::dup2_stderr(&self.0);
    }
}

/// Lets everything through: drivers of other systems print nothing.
#[cfg(not(unix))]
pub(super) struct Quiet;

#[cfg(not(unix))]
impl Quiet {
    pub fn start() -> Option<Self> {
        None
    }
}
