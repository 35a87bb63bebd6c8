#!/usr/bin/env bash
# Passes all tests on a fresh Debian or Ubuntu machine with Rust: installs a C linker and a software GPU if they are not there,
# runs the tests and doctests of the workspace, and closes with a line that counts them.
set -euo pipefail
cd "$(dirname "$0")/.."

# lavapipe is a Vulkan adapter in software; the X libraries and Xvfb open a window without a screen; procps has `kill`.
packages=(gcc libc6-dev procps mesa-vulkan-drivers xvfb libxkbcommon-x11-0 libxcursor1 libxi6 libxrandr2 libx11-xcb1)
missing=()
for package in "${packages[@]}"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if ((${#missing[@]})); then
    as_root=()
    if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
    "${as_root[@]}" apt-get update -q
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
fi

# With the adapter installed, a GPU test that finds none has failed.
export PRT_REQUIRE_GPU=1

# What the light crate leaves out unless it is asked for.
optional=glam,nalgebra,serde

log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
if cargo nextest --version >/dev/null 2>&1; then
    cargo nextest run --workspace --locked --no-fail-fast 2>&1 | tee "$log" || status=1
    cargo nextest run -p sh-core --features "$optional" --test features --locked 2>&1 | tee -a "$log" || status=1
    cargo test --workspace --locked --doc --no-fail-fast 2>&1 | tee -a "$log" || status=1
else
    cargo test --workspace --locked --no-fail-fast 2>&1 | tee "$log" || status=1
    cargo test -p sh-core --features "$optional" --test features --locked 2>&1 | tee -a "$log" || status=1
fi

# nextest closes with "N tests run: P passed, F failed, S skipped"; cargo with "test result: ok. P passed; F failed; I ignored".
count() { sed 's/\x1b\[[0-9;]*m//g' "$log" | grep -E 'tests? run:|^test result:' | grep -oE "[0-9]+ $1" | awk '{n += $1} END {print n + 0}'; }
failed=$(count failed)
if [ "$status" -ne 0 ] && [ "$failed" -eq 0 ]; then
    echo 'the tests did not run to their end'
    exit 1
fi
echo "$(count passed) passed, $failed failed"
exit "$status"
