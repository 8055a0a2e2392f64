// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "thermorig/learning/study/evaluation.h"
#include "thermorig/network/model/model.h"

namespace thermorig::app {

/// A model on sessions, and what is to be said about it.
struct ModelEvaluation {
  study::Evaluation evaluation;
  std::vector<std::string> warnings;
  bool labelled_by_gyro = false;  // one of the sessions at least: its rig had no servo
};

std::string model_text(const std::string& name, const model::Model& model, const ModelEvaluation& evaluated);
nlohmann::json model_json(const model::Model& model, const ModelEvaluation& evaluated);

}  // namespace thermorig::app
