//! Reads any bytes as the four files of a skinning exercise. Real files in `corpus/exercise` serve as seeds.
//!
//! `cargo +nightly fuzz run exercise -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::exercise(bytes));
