#!/bin/bash -eu
# Builds every fuzz target with the sanitizer that OSS-Fuzz chooses, also for the FBX reader's C code, and packs seeds and options.

# The repository pins a stable toolchain; the image has the nightly one that the sanitizers need.
rm --force rust-toolchain.toml
cargo fuzz build --release

for target in fuzz/fuzz_targets/*.rs; do
  name=$(basename "$target" .rs)
  cp "fuzz/target/x86_64-unknown-linux-gnu/release/$name" "$OUT/"
  printf '[libfuzzer]\ntimeout = 10\nrss_limit_mb = 2048\n' > "$OUT/$name.options"
done
cp fuzz/gltf.dict "$OUT/"
printf 'dict = gltf.dict\nmax_len = 300000\n' >> "$OUT/gltf.options"

(cd assets/samples && zip --quiet "$OUT/gltf_seed_corpus.zip" ./*.glb && zip --quiet "$OUT/bvh_seed_corpus.zip" ./*.bvh)
