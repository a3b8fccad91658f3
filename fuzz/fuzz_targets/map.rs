//! Reads any bytes as a joint map. Real files in `corpus/map` serve as seeds.
//!
//! `cargo +nightly fuzz run map -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::map(bytes));
