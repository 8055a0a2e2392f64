// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/sensors/text_format.h"

namespace thermorig::app {

/// `prefix "a/g:", columns 3,4,5 as x,y,z, 0.00763359 deg/s a unit, time in column 0 (0.001 s)`.
std::string columns_text(const TextColumns& columns);

/// The same as options of `decode`, ready for a shell.
std::string options_text(const TextColumns& columns);

/// What the columns were concluded from, as one sentence.
std::string assumptions_text(const sensors::TextFormat& format);

nlohmann::json format_json(const sensors::TextFormat& format);

}  // namespace thermorig::app
