//! Reads any bytes as a .npz file. Real files in `corpus/npz` serve as seeds.
//!
//! `cargo +nightly fuzz run npz -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::npz(bytes));
