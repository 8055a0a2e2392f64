// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <cstdint>
#include <span>
#include <vector>

namespace thermorig::model {

/// Copies a tensor of floats of just these dimensions, or of the transposed ones, into `out`. Throws Refusal
/// for another type or shape, values outside the file, too few or too many of them, NaN and infinity.
void copy_floats(const onnx::TensorProto& tensor, const std::vector<int>& dimensions, bool transposed,
                 std::span<float> out);

/// The values of a tensor of at most 8 whole numbers (shapes, axes). Throws Refusal for anything else.
std::vector<std::int64_t> integers_of(const onnx::TensorProto& tensor);

/// Is it the number 1, as float?
bool is_one(const onnx::TensorProto& tensor);

}  // namespace thermorig::model
