// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/storage/session/session.h"

namespace thermorig::app {

/// Everything that `inspect --timing` says: clocks, bounds, gaps, offsets, gyro, servo, residuals, the
/// session's verdict and remarks.
std::string timing_text(const std::filesystem::path& path, const session::Session& session,
                        const session::Quality& quality);
nlohmann::json timing_json(const session::Session& session, const session::Quality& quality);

/// How well times and labels are known, in one line for `inspect`.
std::string timing_line(const std::filesystem::path& path, const session::Session& session,
                        const session::Quality& quality);

}  // namespace thermorig::app
