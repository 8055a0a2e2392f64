// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "../pipeline/virtual_sweep.h"
#include "thermorig/core/live_estimate.h"
#include "thermorig/model/model.h"
#include "thermorig/pipeline/frame_pairs.h"
#include "thermorig/windows/acquisition.h"

namespace thermorig::live {

/// A frame, its sample, and when the chunk arrived that completed the two.
struct CausalPair {
  pipeline::FramePair pair;
  HostTime arrived{};
};

/// Two legs of a simulated rig in the garden: +100 deg/s and -150 deg/s.
pipeline::VirtualSweep two_legs();

/// What a recorder keeps of a sweep: closed a second after its last chunk.
RawRecording recording_of(const pipeline::VirtualSweep& sweep);

/// What a live run of it sees, fed chunk by chunk as a recorder does it: not by way of a replay.
std::vector<CausalPair> pairs_of(const pipeline::VirtualSweep& sweep);

std::vector<LiveEstimate> rows_of(const std::vector<CausalPair>& pairs,
                                  const std::optional<model::Model>& model);

/// What training would make of these frames and samples.
windows::Acquisition acquisition_of(const std::vector<CausalPair>& pairs);

/// Seeded weights, pixels scaled as these frames need it.
model::Model model_for(const windows::Acquisition& acquisition, const network::Shape& shape);

}  // namespace thermorig::live
