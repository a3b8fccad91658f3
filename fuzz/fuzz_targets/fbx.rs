//! Reads any bytes as an .fbx file with ufbx, a library in C. `corpus/fbx` has seeds.
//!
//! `cargo +nightly fuzz run fbx -- -max_len=100000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::fbx(bytes));
