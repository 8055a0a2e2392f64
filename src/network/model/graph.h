// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <cstdint>

#include "thermorig/network/scaling.h"
#include "thermorig/network/weights.h"

namespace thermorig::model {

/// The network as a graph (paper section III, Fig. 2, equation 2), with the scaling of a window where that is
/// by the window. `weights` without values: a graph without them. `batch` > 0 fixes N.
void fill_graph(onnx::GraphProto& graph, const network::Weights& weights, const network::Scaling& scaling,
                std::int64_t batch);

/// Throws Refusal, saying where it differs, unless it is what fill_graph() makes, whatever its weights are.
void require_graph(const onnx::GraphProto& graph, const network::Shape& shape,
                   const network::Scaling& scaling);

}  // namespace thermorig::model
