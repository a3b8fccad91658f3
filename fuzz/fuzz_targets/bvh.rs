//! Reads any bytes as a .bvh. Real files in `corpus/bvh` serve as seeds.
//!
//! `cargo +nightly fuzz run bvh -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::bvh(bytes));
