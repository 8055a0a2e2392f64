// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::calibration {

enum class ConstantVerdict : std::uint8_t { holds, contradicts, not_checked };

/// "holds", "contradicts", "not checked".
std::string_view name_of(ConstantVerdict verdict);

/// What a profile says of one constant, and what a session says of it. Texts are ready to print.
struct CheckedConstant {
  std::string name;                 // "gyro scale", "servo at +200 deg/s": unique in a check
  std::string unit;                 // "s", "s/row", "deg/s", "ppm"; empty: a ratio
  std::optional<Estimate> profile;  // none: no profile states it, or this one does not
  std::optional<Estimate> session;  // none: it does not tell
  ConstantVerdict verdict = ConstantVerdict::not_checked;
  std::string why;     // it was not checked, or what may be behind a contradiction; empty where it holds
  std::string advice;  // what measures it again or mends it; empty: nothing need be done
};

/// Every constant of the profile with which `session` was recorded, in a fixed order. A constant holds where
/// the two are within three standard deviations of their difference, and the session tells it well enough to
/// see a change that matters. What was never measured may contradict, but does not hold: it is an assumption.
/// A short session knows a scale to no better than 0.1 % and a latency to 1 ms, whatever it claims.
std::vector<CheckedConstant> check_constants(const session::Session& session);

/// Whether one of them contradicts.
bool is_contradicted(const std::vector<CheckedConstant>& constants);

}  // namespace thermorig::calibration
