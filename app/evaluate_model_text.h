// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "thermorig/model/model.h"
#include "thermorig/study/evaluation.h"

namespace thermorig::app {

/// The acquisitions of one environment together.
struct EnvironmentErrors {
  std::string name;
  std::size_t acquisitions = 0;
  std::array<study::Errors, study::estimator_count> errors;
};

/// A model on sessions, and what is to be said about it.
struct ModelEvaluation {
  study::Evaluation evaluation;
  std::vector<EnvironmentErrors> environments;
  bool simulated = false;
  std::vector<std::string> warnings;
};

std::string model_text(const std::string& name, const model::Model& model, const ModelEvaluation& evaluated);
nlohmann::json model_json(const model::Model& model, const ModelEvaluation& evaluated);

}  // namespace thermorig::app
