//! Reads any bytes as the input of the KTX2 decoder. `corpus/ktx2` has seeds.
//!
//! `cargo +nightly fuzz run ktx2 -- -max_len=100000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::ktx2(bytes));
