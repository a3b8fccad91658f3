//! Reads any bytes as a .glb or .gltf. Real files in `corpus/gltf` serve as seeds.
//!
//! `cargo +nightly fuzz run gltf -- -max_len=300000 -dict=fuzz/gltf.dict -timeout=10 -rss_limit_mb=2048`

#![no_main]

#[path = "../entries.rs"]
mod entries;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| entries::gltf(bytes));
