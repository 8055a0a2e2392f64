// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "thermorig/network/model/model.h"

namespace thermorig::app {

inline constexpr const char* general_model_name = "the general model";

/// The network that the program brings along for such a camera, which has learnt from made-up rooms alone;
/// nothing: it has none for it.
std::optional<model::Model> general_model(const network::CameraView& view);

/// A model, and what it is called.
struct NamedModel {
  model::Model model;
  std::string name;  // of its file
  std::string hash;  // SHA-256 of the file, hexadecimal
};

/// The model file at that path; "general", where there is no such file, is the program's own for half frames
/// and the lens, of 55 or 110 degrees, that is nearer to `width_deg`. Throws as model::read_model().
NamedModel named_model(const std::filesystem::path& path, double width_deg = network::CameraView().width_deg);

}  // namespace thermorig::app
