// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "thermorig/rig/gate.h"

namespace thermorig::app {

/// What the gate saw and said; null if nothing was judged.
nlohmann::json gate_json(const std::optional<rig::GateReport>& report);

}  // namespace thermorig::app
