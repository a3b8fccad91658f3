//! Reads any bytes as an .hdr image.
//!
//! `cargo +nightly fuzz run hdr -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::hdr(bytes));
