// SPDX-License-Identifier: MIT
#include "live_model.h"

#include <fmt/format.h>
#include <utility>

#include "general_model.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

/// Whether frames are half or full only the camera's stream shows.
void require_view(const network::CameraView& learnt, const CameraProfile& camera, const std::string& where) {
  const network::CameraView here{
      .width_deg = camera.lens_width_deg(), .half_frames = learnt.half_frames, .mirrored = camera.mirrored};
  if (learnt.fits(here)) return;
  throw Error(
      ExitCode::bad_usage,
      fmt::format("the model has learnt a lens of {:.0f} degrees{}, and this camera has one of {:.0f}{}",
                  learnt.width_deg, learnt.mirrored ? ", mirrored" : "", here.width_deg,
                  here.mirrored ? ", mirrored" : ""),
      where, "a model of such a camera, or another profile: --rig");
}

}  // namespace

ChosenModel read_live_model(const std::filesystem::path& path, const std::string& precision,
                            const CameraProfile& camera) {
  ChosenModel chosen;
  if (path.empty()) return chosen;
  NamedModel named = named_model(path);
  chosen.model = std::move(named.model);
  if (const auto& view = chosen.model->provenance.view) require_view(*view, camera, named.name);
  if (precision == "fp16") chosen.precision = network::Precision::fp16_weights;
  const network::Shape& shape = chosen.model->weights.shape;
  chosen.facts = {.name = named.name,
                  .hash = named.hash,
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
        "the model was trained on simulated data, and this rig is real: its estimates "
        "show that the program works, not what the sensor can do");
  if (frames_per_leg > 0 && model.facts.frames > frames_per_leg)
    warnings.push_back(
        fmt::format("the model looks at {} frames at a time, and a leg has {}: no window lies in "
                    "one leg, so none will be counted",
                    model.facts.frames, frames_per_leg));
  return warnings;
}

}  // namespace thermorig::app
