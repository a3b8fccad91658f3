//! Reads any bytes as the part of a link after its #. Real files in `corpus/link` serve as seeds.
//!
//! `cargo +nightly fuzz run link -- -max_len=4000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::link(bytes));
