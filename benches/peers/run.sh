#!/usr/bin/env bash
# Times `sh-core` side by side with other libraries, one thread each, and writes the table into sh-core/README.md.
# Installs the peers with pip in a folder of its own under target/. Needs python3 with venv.
set -euo pipefail
cd "$(dirname "$0")/../.."

venv=${CARGO_TARGET_DIR:-target}/peers
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet numpy==2.4.6 sphericart==2.0.4 ducc0==0.42.0

export OMP_NUM_THREADS=1
export PRT_PEERS_PYTHON=$venv/bin/python
cargo run --release --locked -p prt-benches --bin repro -- sh-core/peers sh-core/README.md
