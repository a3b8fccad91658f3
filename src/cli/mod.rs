//! The command line: thin entries over the same functions as the page.

/// Runs the program; the result is its exit status.
pub fn main() -> std::process::ExitCode {
    std::process::ExitCode::from(2)
}
