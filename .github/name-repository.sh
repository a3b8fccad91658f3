#!/usr/bin/env bash
# Adds `repository` below each `license` of the manifests: `name-repository.sh URL`. Only the workflows that publish know the URL.
set -euo pipefail
cd "$(dirname "$0")/.."
manifests=(Cargo.toml crates/*/Cargo.toml parts/*/Cargo.toml python/Cargo.toml)
for manifest in "${manifests[@]}"; do
  # Without -i, which macOS's sed has differently.
  awk -v url="$1" '{ print } $0 == "license.workspace = true" { print "repository = \"" url "\"" }' "$manifest" > "$manifest.new"
  mv "$manifest.new" "$manifest"
done
