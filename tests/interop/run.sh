#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The network beside ONNX Runtime (outputs of our files) and PyTorch (gradients, loss paths, files exported there), for
# every Nf, Nr, fusion and thermal-only. Installs both; --quick compares with PyTorch at Nf = 3, Nr = 1 and 3 alone.
# Usage: bash tests/interop/run.sh [--json] [--quick]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/interop/peers.sh
install_peers
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target network_interop >&2
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONPATH=tests/interop \
  /usr/bin/python3 tests/interop/compare.py "$build/bin/network_interop" "$ONNX_RUNTIME_LIBRARY" "$@"
