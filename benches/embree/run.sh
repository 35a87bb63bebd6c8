#!/usr/bin/env bash
# Traces the same rays with prt-bake and with Embree, one thread each, in turns: `repro -- prt/embree`. Installs Embree 3 from Debian's
# libembree-dev if it is missing. An argument names a mesh instead of the four of the test data.
set -euo pipefail
cd "$(dirname "$0")/../.."

if ! [ -e /usr/include/embree3/rtcore.h ] || ! command -v g++ > /dev/null; then
    apt-get install -y --no-install-recommends libembree-dev g++
fi
export PRT_EMBREE_PEER=${CARGO_TARGET_DIR:-$PWD/target}/embree-peer
g++ -O3 -march=native -o "$PRT_EMBREE_PEER" benches/embree/peer.cpp -lembree3
cargo run --release --locked -p prt-benches --bin repro -- prt/embree "$@"
