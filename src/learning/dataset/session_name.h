// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/core/raw_recording.h"

namespace thermorig::dataset {

/// "<environment>_acq-<number>", as the file is named but for the time: a simulated session that is recorded
/// again has the same name.
std::string name_of(const RecordingHeader& header);

}  // namespace thermorig::dataset
