// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "options.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/text_format.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::app {

// `head`: the first bytes of a dump.

/// How the options say that a gyro's lines are to be read.
TextColumns text_columns(const DecodeOptions& options);

CameraProfile camera_profile(const DecodeOptions& options);

/// More messages were damaged or unreadable than good.
bool is_mostly_bad(const wire::Counters& counters);

/// How a gyro's bytes are read, where no option says it: by what is recognised in them.
struct Recognition {
  std::string gyro_protocol;                       // in the table of protocols
  std::map<std::string, double> settings;          // of it
  std::optional<sensors::TextFormat> text_format;  // of lines whose words say all
};
Recognition recognise_gyro(std::span<const std::uint8_t> head);

/// Why nothing was decoded, as far as the bytes say it, and what to try.
struct Advice {
  std::string reason;  // "hex text of a dump"; may be empty
  std::string what_to_try;
};
Advice advice_on_nothing(const DecodeOptions& options, std::span<const std::uint8_t> head,
                         const wire::Counters& counters);

/// What to say where something was decoded: that most of it was bad, or that the lines of a text gyro speak
/// for other columns than those that were read. Empty where all is well.
std::vector<std::string> remarks_on(const DecodeOptions& options, const Recognition& recognition,
                                    std::span<const std::uint8_t> head, const wire::Counters& counters);

}  // namespace thermorig::app
