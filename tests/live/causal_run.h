// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "../pipeline/virtual_sweep.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"
#include "thermorig/network/acquisition.h"
#include "thermorig/network/model/model.h"

namespace thermorig::live {

/// A measurement, and when the chunk arrived that completed it.
struct CausalMeasurement {
  Measurement measurement;
  HostTime arrived{};
};

/// Two legs of a simulated rig in the garden: +100 deg/s and -150 deg/s.
pipeline::VirtualSweep two_legs();

/// What a recorder keeps of a sweep: closed a second after its last chunk.
RawRecording recording_of(const pipeline::VirtualSweep& sweep);

/// What a live run of it sees, fed chunk by chunk as a recorder does it: not by way of a replay.
std::vector<CausalMeasurement> measurements_of(const pipeline::VirtualSweep& sweep);

/// The estimators of the paper: those of them that the model lets run.
estimators::Bank paper_bank(const std::optional<model::Model>& model,
                            network::Precision precision = network::Precision::fp32);

std::vector<EstimateRow> rows_of(const std::vector<CausalMeasurement>& measurements,
                                 const std::optional<model::Model>& model);

/// What training would make of them.
network::Acquisition acquisition_of(const std::vector<CausalMeasurement>& measurements);

/// Seeded weights, pixels scaled as these frames need it.
model::Model model_for(const network::Acquisition& acquisition, const network::Shape& shape);

}  // namespace thermorig::live
