// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <optional>
#include <string_view>

#include "graph_builder.h"
#include "thermorig/network/scaling.h"

namespace thermorig::model {

// network::scale_window() in operators of ONNX, from frames of the camera on.

inline constexpr std::string_view scaled_frames_name = "scaled_frames", speed_scale_name = "speed_scale";

void add_window_scaling(GraphBuilder& graph, const network::Shape& shape);

/// Degrees a frame period that the network calls 1.
inline float speed_scale_of(const network::Scaling& scaling) {
  return scaling.label_scale_dps * scaling.frame_period_s;
}

/// The Nr of a graph that has just these nodes, bit for bit; nothing: it has others.
std::optional<int> reduction_of_window_scaling(const onnx::GraphProto& graph);

}  // namespace thermorig::model
