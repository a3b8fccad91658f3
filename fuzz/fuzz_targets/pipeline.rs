//! Retargets, measures, layers, shows and writes any bytes as a motion. `corpus/pipeline` has seeds.
//!
//! `cargo +nightly fuzz run pipeline -- -max_len=20000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::pipeline(bytes));
