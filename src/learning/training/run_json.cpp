// SPDX-License-Identifier: MIT
#include "run_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace thermorig::training {

namespace {

nlohmann::json to_json(const network::Shape& shape) {
  return {{"frames", shape.frames},     {"reduction", shape.reduction}, {"fusion", shape.fusion},
          {"padding1", shape.padding1}, {"padding2", shape.padding2},   {"crop_left", shape.crop_left}};
}

nlohmann::json to_json(const MadeRooms& made) {
  if (made.windows == 0) return nullptr;
  return {{"windows", made.windows},
          {"width_deg", made.view.width_deg},
          {"half_frames", made.view.half_frames},
          {"mirrored", made.view.mirrored},
          {"steps_an_epoch", made.steps_an_epoch},
          {"rounds_kept", made.rounds_kept}};
}

nlohmann::json to_json(const TrainingConfig& config) {
  return {{"preset", config.preset},
          {"shape", to_json(config.shape)},
          {"epochs", config.epochs},
          {"batch", config.batch},
          {"berhu_fraction", config.loss.berhu_fraction},
          {"likelihood", config.loss.likelihood},
          {"auxiliary_thermal", config.loss.auxiliary_thermal},
          {"rate", config.adam.rate},
          {"beta1", config.adam.beta1},
          {"beta2", config.adam.beta2},
          {"epsilon", config.adam.epsilon},
          {"wide_rate", config.adam.wide_rate},
          {"cosine", config.cosine},
          {"symmetries", config.symmetries},
          {"window_scaling", config.window_scaling},
          {"made_rooms", to_json(config.made)},
          {"from", config.from ? config.from->name : "none"},
          {"choose_epoch", config.choose_epoch},
          {"history", config.history},
          {"seed", config.seed},
          {"label_scale_dps", config.label_scale_dps}};
}

std::string data_difference(const nlohmann::json& then, const nlohmann::json& now) {
  if (then.size() != now.size())
    return fmt::format("the data ({} acquisitions, now {})", then.size(), now.size());
  return "the data (other recordings, or labelled anew)";
}

std::string brief(const nlohmann::json& value) {
  return value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace).substr(0, 60);
}

void add(std::string& text, const std::string& difference) {
  if (!text.empty()) text += ", ";
  text += difference;
}

void compare_settings(const nlohmann::json& then, const nlohmann::json& now, std::string& text) {
  const nlohmann::json flat = now.flatten();
  for (const auto& [key, value] : flat.items()) {
    const nlohmann::json::json_pointer place(key);
    const nlohmann::json before = then.contains(place) ? then.at(place) : nlohmann::json();
    if (before != value)
      add(text, fmt::format("{} ({}, now {})", key.substr(key.rfind('/') + 1), brief(before), brief(value)));
  }
}

}  // namespace

nlohmann::json to_json(const RunDescription& description) {
  nlohmann::json data = nlohmann::json::array();
  for (const auto& acquisition : description.data)
    data.push_back({{"name", acquisition.name}, {"sha256", acquisition.hash}});
  nlohmann::json settings = to_json(description.config);
  settings["label"] = name_of(description.label);
  return {{"settings", settings},
          {"data", data},
          {"instruction_set", description.instruction_set},
          {"producer", description.producer}};
}

nlohmann::json to_json(const EpochReport& report, const TrainingConfig& config) {
  nlohmann::json line{{"epoch", report.epoch},
                      {"loss", report.loss},
                      {"training_mse", report.training_mse},
                      {"training_rmse_dps", rmse_dps(report.training_mse, config)},
                      {"held_out_mse", report.held_out_mse},
                      {"held_out_rmse_dps", rmse_dps(report.held_out_mse, config)},
                      {"held_out_thermal_mse", report.held_out_thermal_mse},
                      {"kept", report.kept},
                      {"seconds", report.seconds}};
  line["gain_mean"] = config.shape.fusion ? nlohmann::json(report.gain_mean) : nlohmann::json();
  return line;
}

std::optional<nlohmann::json> description_from(std::string_view text) {
  constexpr int depth_max = 8;
  const auto is_shallow = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    return depth <= depth_max;  // what lies deeper is dropped while it is read
  };
  nlohmann::json found = nlohmann::json::parse(text, is_shallow, false);
  if (found.is_discarded()) return std::nullopt;
  return found;
}

std::string differences(const nlohmann::json& then, const nlohmann::json& now) {
  std::string text;
  if (!then.is_object() || !then.contains("settings") || !then.contains("data"))
    return "everything: it is no run's description";
  compare_settings(then["settings"], now["settings"], text);
  // Another label is other data as well: one of the two says it all.
  const bool same_label =
      then["settings"].contains("label") && then["settings"]["label"] == now["settings"]["label"];
  if (same_label && then["data"] != now["data"]) add(text, data_difference(then["data"], now["data"]));
  for (const char* key : {"instruction_set", "producer"})
    if (then.value(key, nlohmann::json()) != now[key])
      add(text,
          fmt::format("{} ({}, now {})", key, brief(then.value(key, nlohmann::json())), brief(now[key])));
  return text;
}

}  // namespace thermorig::training
