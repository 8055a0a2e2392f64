#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The network beside ONNX Runtime, libtorch and PyTorch (both with OpenBLAS), which it installs: inference of one window and
# a training step of 32, on one core, warm, in turn on the same data; Nf = 3, Nr = 1, fusion. Ratios are of medians of
# processor time. Each figure with what it must be; exit code 1 if one is not met.
# --quick: fewer rounds. --model: a trained model for the half-precision check (default: those in docs/models).
# Usage: bash tests/bench/network_peers.sh [--json] [--quick] [--model MODEL.onnx]
set -euo pipefail
cd "$(dirname "$0")/../.."
options=() models=(docs/models/*.onnx)
while [ $# -gt 0 ]; do
  case "$1" in
    --json | --quick) options+=("$1") ;;
    --model) models=("$2"); shift ;;
    *) echo "usage: network_peers.sh [--json] [--quick] [--model MODEL.onnx]" >&2; exit 2 ;;
  esac
  shift
done
bash app/setup.sh bench >&2
source tests/interop/peers.sh
install_peers
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" -j "$(nproc)" --target thermorig network_interop network_bench network_peer_ours \
  network_peer_onnx_runtime network_peer_libtorch network_fp16_difference >&2

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for model in "${models[@]}"; do
  [ -f "$model" ] && options+=(--model "$model")
done
"$build/bin/thermorig" record --environment garden --simulated=71 --world honest --fast --plan quick --output "$folder" >&2

# One core for all, the last one: the first has most of the interrupts.
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONPATH=tests/interop taskset -c "$(($(nproc) - 1))" \
  /usr/bin/python3 tests/bench/network_peers/measure.py "$build/bin" "$ONNX_RUNTIME_LIBRARY" \
  "$ONNX_RUNTIME_FOLDER/node_modules" --sessions "$folder"/garden/*.h5 "${options[@]}"
