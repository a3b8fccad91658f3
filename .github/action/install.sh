#!/usr/bin/env bash
# Downloads the release of this checkout into $RUNNER_TEMP/gaitway and compares its checksum. For pictures on Linux, it also
# installs a Vulkan driver unless there is one.
set -euo pipefail
checkout=$(cd "$(dirname "$0")/../.." && pwd)
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$checkout/Cargo.toml" | head -n 1)
case "$RUNNER_OS-$RUNNER_ARCH" in
  Linux-X64) name=gaitway-x86_64-unknown-linux-gnu.tar.gz ;;
  Linux-ARM64) name=gaitway-aarch64-unknown-linux-gnu.tar.gz ;;
  macOS-X64) name=gaitway-x86_64-apple-darwin.tar.gz ;;
  macOS-ARM64) name=gaitway-aarch64-apple-darwin.tar.gz ;;
  Windows-X64) name=gaitway-x86_64-pc-windows-msvc.zip ;;
  *)
    echo "::error::There is no release of Gaitway for $RUNNER_OS on $RUNNER_ARCH"
    exit 1
    ;;
esac
cd "$RUNNER_TEMP"
curl --fail --silent --show-error --location --retry 3 --remote-name-all "$RELEASES/v$version/$name" "$RELEASES/v$version/$name.sha256"
# macOS has no sha256sum.
if command -v sha256sum > /dev/null; then sha256sum --check "$name.sha256"; else shasum --algorithm 256 --check "$name.sha256"; fi
rm -rf gaitway
case $name in
  *.zip) 7z x -y "$name" > /dev/null ;;
  *) tar -xzf "$name" ;;
esac
folder=${name%.zip}
mv "${folder%.tar.gz}" gaitway
if [ "$RUNNER_OS" = Linux ] && [ "$NEEDS_GRAPHICS" = true ] && ! ls /usr/share/vulkan/icd.d/*.json > /dev/null 2>&1; then
  sudo apt-get update
  sudo apt-get install --yes --no-install-recommends libvulkan1 mesa-vulkan-drivers
fi
