// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "timing_clocks.h"
#include "timing_figures.h"

namespace thermorig::bench {

/// The constant between camera and gyro from 60 s of sweeping, latencies drawn by the simulator.
void add_camera_offset(const TableSize& size, std::vector<Figure>& figures);

/// rate_shaft against the shaft's true mean speed over each exposure, calibrated and not.
void add_labels(const TableSize& size, std::vector<Figure>& figures);

}  // namespace thermorig::bench
