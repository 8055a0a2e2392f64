# SPDX-License-Identifier: MIT
"""Makes a seed for the model fuzzer: a model file without its weights, which the fuzzer fills in again.

Usage: without_weights.py MODEL.onnx SEED.onnx   (needs Debian's python3-onnx)
"""
import sys

import onnx

source, target = sys.argv[1:]
model = onnx.load(source)
for tensor in model.graph.initializer:
    if len(tensor.raw_data) > 4:
        tensor.ClearField("raw_data")
kept = [entry for entry in model.metadata_props if entry.key not in ("format", "weights_crc32")]
del model.metadata_props[:]
model.metadata_props.extend(kept)
model.ClearField("doc_string")
for node in model.graph.node:
    node.ClearField("doc_string")
onnx.save(model, target)
