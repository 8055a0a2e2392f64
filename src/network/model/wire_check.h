// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace thermorig::model {

/// Walks the bytes of an ONNX file before protobuf does, without keeping anything. Throws Refusal for bytes
/// that are cut off or no protobuf, for parts that this network has no use for (functions, graphs within
/// graphs, sparse tensors), and for more fields than a file of this size can need: a field of two bytes may
/// become a message of 300 in memory.
void check_wire(std::span<const std::uint8_t> bytes);

}  // namespace thermorig::model
