//! Reads any bytes as a .glb with compressed meshes, or as the input of the Draco decoder. `corpus/draco` has seeds.
//!
//! `cargo +nightly fuzz run draco -- -max_len=100000 -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::draco(bytes));
