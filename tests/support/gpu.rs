//! Skipping tests without a graphics adapter.

use std::fmt::Display;

/// Without an adapter, prints `skipped: …` and returns none; with `REQUIRE_GPU=1` it panics instead.
pub fn or_skipped<T>(found: Result<T, impl Display>) -> Option<T> {
    found
        .inspect_err(|problem| {
            let is_required = std::env::var("REQUIRE_GPU").as_deref() == Ok("1");
            assert!(!is_required, "REQUIRE_GPU is set, but: {problem}");
            eprintln!("skipped: {problem}");
        })
        .ok()
}
