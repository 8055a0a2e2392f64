// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/core/profile.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::app {

/// How many valid windows each speed of the plan yields, what is impossible and why, how long the quota
/// takes. A table with a line a speed, of a plan that has legs.
std::string yield_text(const rig::SweepPlan& plan, const RigProfile& profile);

/// The same: `speeds[]` with arrays by frames a window, from 1. Null in place of infinite numbers.
nlohmann::json yield_json(const rig::SweepPlan& plan, const RigProfile& profile);

}  // namespace thermorig::app
