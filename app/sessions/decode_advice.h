// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "options.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::app {

// `head`: the first bytes of a dump.

/// How the options say that a gyro's lines are to be read.
TextColumns text_columns(const DecodeOptions& options);

CameraProfile camera_profile(const DecodeOptions& options);

/// More messages were damaged or unreadable than good.
bool is_mostly_bad(const wire::Counters& counters);

/// What to try where nothing was decoded.
std::string advice_on_nothing(const DecodeOptions& options, std::span<const std::uint8_t> head,
                              const wire::Counters& counters);

/// What to say where something was decoded: that most of it was bad, or that the lines of a text gyro speak
/// for other columns than those that were read. Empty where all is well.
std::vector<std::string> remarks_on(const DecodeOptions& options, std::span<const std::uint8_t> head,
                                    const wire::Counters& counters);

}  // namespace thermorig::app
