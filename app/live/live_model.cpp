// SPDX-License-Identifier: MIT
#include "live_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "general_model.h"
#include "thermorig/core/error.h"
#include "thermorig/network/turn.h"

namespace thermorig::app {

namespace {

/// Whether frames are half or full only the camera's stream shows; mirror images are mirrored back.
network::CameraView view_like(const network::CameraView& learnt, const CameraProfile& camera) {
  return {
      .width_deg = camera.lens_width_deg(), .half_frames = learnt.half_frames, .mirrored = learnt.mirrored};
}

void require_view(const network::CameraView& learnt, const CameraProfile& camera, const std::string& where) {
  const network::CameraView here = view_like(learnt, camera);
  if (learnt.fits(here)) return;
  throw Error(ExitCode::bad_usage,
              fmt::format("the model has learnt a lens of {:.0f} degrees, and this camera has one of {:.0f}",
                          learnt.width_deg, here.width_deg),
              where, "a model of such a camera, --model none, or another profile: --rig");
}

bool asks_for_network(const LiveOptions& options) {
  return options.estimators.empty() || std::ranges::any_of(options.estimators, [](const std::string& name) {
           return estimators::entry(name).needs_network;
         });
}

std::optional<NamedModel> model_of(const LiveOptions& options, const CameraProfile& camera) {
  std::error_code hidden;
  if (options.model == "none" && !std::filesystem::exists(options.model, hidden)) return std::nullopt;
  const bool by_default = options.model.empty();
  if (by_default && !asks_for_network(options)) return std::nullopt;
  NamedModel named = named_model(by_default ? "general" : options.model, camera.lens_width_deg());
  const auto& view = named.model.provenance.view;
  if (by_default && !(view && view->fits(view_like(*view, camera)))) return std::nullopt;
  if (view) require_view(*view, camera, named.name);
  return named;
}

int turned_of(const LiveOptions& options, const NamedModel& named) {
  const bool has_learnt = named.model.scaling.by_window;
  const int turned = options.turned.value_or(has_learnt ? int{network::Turn::all} : 1);
  if (turned != 1 && !has_learnt)
    throw Error(ExitCode::bad_usage, "this network has not learnt windows that are upside down or backwards",
                named.name, "--turned 1, or a model of preset best");
  return turned;
}

}  // namespace

ChosenModel choose_live_model(const LiveOptions& options, const CameraProfile& camera) {
  ChosenModel chosen;
  std::optional<NamedModel> named = model_of(options, camera);
  if (!named) return chosen;
  chosen.run = {
      .precision = options.precision == "fp16" ? network::Precision::fp16_weights : network::Precision::fp32,
      .turned = turned_of(options, *named)};
  chosen.model = std::move(named->model);
  const network::Shape& shape = chosen.model->weights.shape;
  chosen.facts = {.name = named->name,
                  .hash = named->hash,
                  .frames = shape.frames,
                  .reduction = shape.reduction,
                  .fusion = shape.fusion,
                  .simulated = chosen.model->provenance.simulated,
                  .label_scale_dps = double{chosen.model->scaling.label_scale_dps},
                  .precision = options.precision,
                  .turned = chosen.run.turned};
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
