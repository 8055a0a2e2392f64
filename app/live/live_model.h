// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/profile.h"
#include "thermorig/estimators/table.h"
#include "thermorig/network/model/model.h"

namespace thermorig::app {

/// The network of a live run, and what a recording says of it.
struct ChosenModel {
  std::optional<model::Model> model;  // none: gyro against servo only
  LiveModel facts;
  estimators::NetworkRun run;
};

/// What the options name, "none" for none. Where they name none, the program's own, if the estimators ask for
/// a network and the camera's lens is one that it has learnt. Throws Error(not_a_session) if it is no model,
/// Error(bad_usage) where it has learnt another lens than this camera's, or not the turns that are wanted.
ChosenModel choose_live_model(const LiveOptions& options, const CameraProfile& camera);

/// What should be known before the first frame.
std::vector<std::string> warnings_of(const ChosenModel& model, bool simulated_rig, int frames_per_leg);

}  // namespace thermorig::app
