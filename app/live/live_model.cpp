// SPDX-License-Identifier: MIT
#include "live_model.h"

#include <fmt/format.h>
#include <sha2.h>

#include "thermorig/io/files/existing.h"

namespace thermorig::app {

namespace {

std::string sha256_of(const std::filesystem::path& path) {
  char text[SHA256_DIGEST_STRING_LENGTH] = {};
  return SHA256File(path.c_str(), text) == nullptr ? std::string() : std::string(text);
}

}  // namespace

ChosenModel read_live_model(const std::filesystem::path& path, const std::string& precision) {
  ChosenModel chosen;
  if (path.empty()) return chosen;
  files::require_existing(path);
  chosen.model = model::read_model(path);
  if (precision == "fp16") chosen.precision = network::Precision::fp16_weights;
  const network::Shape& shape = chosen.model->weights.shape;
  chosen.facts = {.name = path.filename().string(),
                  .hash = sha256_of(path),
                  .frames = shape.frames,
                  .reduction = shape.reduction,
                  .fusion = shape.fusion,
                  .simulated = chosen.model->provenance.simulated,
                  .label_scale_dps = double{chosen.model->scaling.label_scale_dps},
                  .precision = precision};
  return chosen;
}

std::vector<std::string> warnings_of(const ChosenModel& model, bool simulated_rig, int frames_per_leg) {
  std::vector<std::string> warnings;
  if (!model.model) return warnings;
  if (model.facts.simulated && !simulated_rig)
    warnings.push_back(
        "the model was trained on data of a simulated rig, and this rig is real: its estimates "
        "show that the program works, not what the sensor can do");
  if (frames_per_leg > 0 && model.facts.frames > frames_per_leg)
    warnings.push_back(
        fmt::format("the model looks at {} frames at a time, and a leg has {}: no window lies in "
                    "one leg, so none will be counted",
                    model.facts.frames, frames_per_leg));
  return warnings;
}

}  // namespace thermorig::app
