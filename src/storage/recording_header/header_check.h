// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "thermorig/core/raw_recording.h"

namespace thermorig::recording_header {

/// What makes this header unfit to be stored or believed, as a sentence; nothing if it is sound. Files come
/// from strangers too: what is used as an index, a divisor or part of a file name is bounded here.
std::optional<std::string> problem_of(const RecordingHeader& header);

}  // namespace thermorig::recording_header
