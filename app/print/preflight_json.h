// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "thermorig/rig/recording/preflight.h"

namespace thermorig::app {

/// What the preflight check saw and said; null if nothing was judged.
nlohmann::json preflight_json(const std::optional<rig::PreflightReport>& report);

}  // namespace thermorig::app
