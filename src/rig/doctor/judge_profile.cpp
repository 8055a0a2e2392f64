// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "thermorig/rig/doctor/checks.h"

namespace thermorig::doctor {

namespace {

using Constant = std::pair<std::string, std::string>;  // its name, and when it was measured; empty: assumed

std::string joined_names(const std::vector<Constant>& constants) {
  std::string text;
  for (const auto& [name, utc] : constants) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Check judge_profile(const RigProfile& profile) {
  std::vector<Constant> assumed{{"orientation", profile.camera.orientation_measured_utc},
                                {"lens", profile.camera.lens_measured_utc},
                                {"gyro scale", profile.gyro.scale_measured_utc},
                                {"gyro bias", profile.gyro.bias_measured_utc},
                                {"camera latency", profile.camera.link.latency_measured_utc},
                                {"servo scale", profile.servo.scale_measured_utc}};
  std::vector<Constant> measured;
  for (const Constant& constant : assumed)
    if (!constant.second.empty()) measured.push_back(constant);
  std::erase_if(assumed, [](const Constant& constant) { return !constant.second.empty(); });
  if (measured.empty())
    return {.name = "calibration",
            .result = "no constant of this profile is measured: `thermorig calibrate` measures them"};
  const auto oldest = std::min_element(measured.begin(), measured.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return {.name = "calibration",
          .result = fmt::format(
              "{} measured, the oldest on {}{}; `thermorig calibrate check` shows whether they still hold",
              joined_names(measured), oldest->second.substr(0, 10),
              assumed.empty() ? "" : "; " + joined_names(assumed) + " assumed")};
}

}  // namespace thermorig::doctor
