# SPDX-License-Identifier: MIT
"""ONNX's own checker, with shape inference, on each file. Prints the files it has accepted."""
import sys

import onnx

for path in sys.argv[1:]:
    model = onnx.load(path)
    onnx.checker.check_model(model, full_check=True)
    inferred = onnx.shape_inference.infer_shapes(model, strict_mode=True, data_prop=True)
    for value in list(inferred.graph.input) + list(inferred.graph.output):
        assert value.type.tensor_type.elem_type == onnx.TensorProto.FLOAT, value.name
    metadata = {entry.key: entry.value for entry in model.metadata_props}
    dims = inferred.graph.input[0].type.tensor_type.shape.dim
    reduction = 1 if metadata.get("scaling") == "window" else int(metadata["reduction"])
    assert [dim.dim_value for dim in dims][1:] == [int(metadata["frames"]), 24 // reduction, 32 // reduction]
    print(path)
