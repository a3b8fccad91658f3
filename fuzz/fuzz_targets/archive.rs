//! Reads any bytes as a zip, or a file without a name. Real files in `corpus/archive` serve as seeds.
//!
//! `cargo +nightly fuzz run archive -- -max_len=300000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::archive(bytes));
