//! What tests do where there is no graphics adapter.

use std::fmt::Display;

/// None, and a line that says so, when there is no adapter; a failure with `REQUIRE_GPU=1`.
pub fn or_skipped<T>(found: Result<T, impl Display>) -> Option<T> {
    found
        .inspect_err(|problem| {
            let is_required = std::env::var("REQUIRE_GPU").as_deref() == Ok("1");
            assert!(!is_required, "REQUIRE_GPU is set, but: {problem}");
            eprintln!("skipped: {problem}");
        })
        .ok()
}
