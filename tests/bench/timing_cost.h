// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "timing_clocks.h"
#include "timing_figures.h"

namespace thermorig::bench {

/// Processor time: a causal update a chunk, and finalising an hour.
void add_cost(const TableSize& size, std::vector<Figure>& figures);

}  // namespace thermorig::bench
