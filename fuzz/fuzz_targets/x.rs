//! Reads any bytes as a .x file. Real files in `corpus/x` serve as seeds.
//!
//! `cargo +nightly fuzz run x -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::x(bytes));
