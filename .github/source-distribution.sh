#!/usr/bin/env bash
# Packs the Python package's source distribution into a folder: `source-distribution.sh FOLDER`. maturin packs the workspace's manifest
# with its patches and without the crates in crates/epaint-text, which are for the page: here the patches are taken out, and
# the lock file is made to fit.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p "$1"
cd "$1"
maturin sdist --manifest-path "$OLDPWD/python/Cargo.toml" --out .
archive=$(ls gaitway-*.tar.gz)
folder=${archive%.tar.gz}
tar -xzf "$archive"
awk '/^\[/ { patches = ($0 == "[patch.crates-io]") } !patches' "$folder/Cargo.toml" > Cargo.toml
mv Cargo.toml "$folder"
cargo metadata --manifest-path "$folder/Cargo.toml" --format-version 1 > /dev/null
tar -czf "$archive" "$folder"
rm -r "$folder"
