// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/estimate_row.h"
#include "thermorig/core/profile.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/model/model.h"

namespace thermorig::app {

/// The network of a live run, and what a recording says of it.
struct ChosenModel {
  std::optional<model::Model> model;  // none: gyro against servo only
  LiveModel facts;
  network::Precision precision = network::Precision::fp32;
};

/// `precision`: fp32 or fp16. Throws Error(not_a_session) if it is no model, Error(bad_usage) where it has
/// learnt another lens or orientation than this camera's; nothing for an empty path.
ChosenModel read_live_model(const std::filesystem::path& path, const std::string& precision,
                            const CameraProfile& camera);

/// What should be known before the first frame.
std::vector<std::string> warnings_of(const ChosenModel& model, bool simulated_rig, int frames_per_leg);

}  // namespace thermorig::app
