// SPDX-License-Identifier: MIT
#include "metadata.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <charconv>

#include "names.h"
#include "refusal.h"
#include "text.h"

namespace thermorig::model {

namespace {

constexpr const char* scaling_advice =
    "write label_scale_dps, temp_mean_c and temp_deviation_c of the training into it with "
    "onnx.helper.set_model_props: docs/model_format.md has the lines";

std::string name_of_network(const network::Shape& shape) {
  return shape.fusion ? "fusion" : "thermal-only";
}

class Entries {
 public:
  template <class Value>
  void add(std::string_view key, const Value& value) {
    entries_.emplace_back(key, fmt::format("{}", value));
  }
  void add_text(std::string_view key, const std::string& text) {
    entries_.emplace_back(key, plain_text(text));
  }
  void add_data(std::string_view key, const std::vector<Provenance::Data>& data) {
    for (std::size_t i = 0; i < data.size(); ++i)
      add_text(fmt::format("{}_{}", key, i + 1), data[i].hash + " " + data[i].name);
  }
  std::vector<std::pair<std::string, std::string>> take() { return std::move(entries_); }

 private:
  std::vector<std::pair<std::string, std::string>> entries_;
};

void add_window_scaling(Entries& entries, const Model& model) {
  const Provenance& from = model.provenance;
  entries.add(key::scaling, by_window);
  entries.add(key::frame_period_s, model.scaling.frame_period_s);
  entries.add(key::gate_states_sigma, model.scaling.gate_states_sigma);
  if (from.view) {
    entries.add(key::view_width_deg, from.view->width_deg);
    entries.add(key::half_frames, from.view->half_frames);
    entries.add(key::mirrored, from.view->mirrored);
  }
  entries.add(key::made_windows, from.made_windows);
  entries.add_text(key::begun_from, from.begun_from);
}

}  // namespace

std::string sum_of(const network::Weights& weights) {
  return fmt::format("{:08x}",
                     libdeflate_crc32(0, weights.values.data(), weights.values.size() * sizeof(float)));
}

std::vector<std::pair<std::string, std::string>> metadata_of(const Model& model) {
  const network::Shape& shape = model.weights.shape;
  const Provenance& from = model.provenance;
  Entries entries;
  entries.add(key::format, format_name);
  entries.add(key::format_version,
              model.scaling.by_window ? format_version_by_window : format_version_by_data_set);
  entries.add(key::network, name_of_network(shape));
  entries.add(key::frames, shape.frames);
  entries.add(key::reduction, shape.reduction);
  entries.add(key::padding1, shape.padding1);
  entries.add(key::padding2, shape.padding2);
  entries.add(key::crop_left, shape.crop_left);
  entries.add(key::label_scale_dps, model.scaling.label_scale_dps);
  if (model.scaling.by_window) {
    add_window_scaling(entries, model);
  } else {
    entries.add(key::temp_mean_c, model.scaling.temp_mean_c);
    entries.add(key::temp_deviation_c, model.scaling.temp_deviation_c);
  }
  entries.add_text(key::preset, from.preset);
  entries.add(key::seed, from.seed);
  entries.add(key::epochs, from.epochs);
  entries.add(key::epoch_kept, from.epoch_kept);
  entries.add(key::simulated, from.simulated);
  entries.add_text(key::data_licence, from.data_licence);
  entries.add(key::label, from.label ? name_of(*from.label) : "");
  entries.add_data(key::training_data, from.training);
  entries.add_data(key::held_out_data, from.held_out);
  // The last, and required: a file that was cut off after any entry lacks it.
  entries.add(key::weights_crc32, sum_of(model.weights));
  return entries.take();
}

Metadata::Metadata(const std::vector<std::pair<std::string, std::string>>& entries) {
  for (const auto& [key, value] : entries) {
    if (!is_plain_text(key) || !is_plain_text(value))
      throw Refusal(fmt::format("its metadata {} is no plain text", in_quotes(key)));
    if (!entries_.emplace(key, value).second)
      throw Refusal(fmt::format("its metadata has {} twice", in_quotes(key)));
  }
  ours_ = find(key::format) == format_name;
  by_window_ = has(key::scaling);
  if (by_window_ && text(key::scaling) != by_window)
    throw Refusal(fmt::format("its frames are scaled by {}, which this program does not know",
                              in_quotes(text(key::scaling))),
                  "use the program that wrote it, or a newer one");
  if (ours_ && number<int>(key::format_version) !=
                   (by_window_ ? format_version_by_window : format_version_by_data_set))
    throw Refusal(fmt::format("it is a model file of version {}, this program knows versions {} and {}",
                              in_quotes(text(key::format_version)), format_version_by_data_set,
                              format_version_by_window),
                  "use the program that wrote it, or a newer one");
}

std::optional<std::string> Metadata::find(std::string_view key) const {
  const auto found = entries_.find(key);
  if (found != entries_.end()) return found->second;
  if (ours_) throw Refusal(fmt::format("its metadata lacks '{}'", key));
  return std::nullopt;
}

std::string Metadata::text(std::string_view key) const {
  return find(key).value_or("");
}

template <class Number>
std::optional<Number> Metadata::number(std::string_view key) const {
  const auto text = find(key);
  if (!text) return std::nullopt;
  Number value{};
  const auto [end, failure] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (failure != std::errc{} || end != text->data() + text->size())
    throw Refusal(fmt::format("its metadata {} is {}, which is no such number", key, in_quotes(*text)));
  return value;
}

bool Metadata::flag(std::string_view key) const {
  const auto text = find(key);
  if (text && text != "true" && text != "false")
    throw Refusal(fmt::format("its metadata {} is {}, neither true nor false", key, in_quotes(*text)));
  return text == "true";
}

void Metadata::compare(std::string_view key, int shown) const {
  const auto said = number<int>(key);
  if (said && *said != shown)
    throw Refusal(fmt::format("its metadata says {} = {}, its graph shows {}", key, *said, shown));
}

void Metadata::complete(network::Shape& shape) const {
  const auto network = find(key::network);
  if (network && *network != name_of_network(shape))
    throw Refusal(
        fmt::format("its metadata says {}, its graph is {}", in_quotes(*network), name_of_network(shape)));
  compare(key::frames, shape.frames);
  compare(key::reduction, shape.reduction);
  compare(key::padding1, shape.padding1);
  compare(key::padding2, shape.padding2);
  shape.crop_left = number<int>(key::crop_left).value_or(0);
  if (const auto fault = network::fault_of(shape)) throw Refusal("its metadata does not fit: " + *fault);
}

float Metadata::scale(std::string_view key) const {
  const auto value = number<float>(key);
  if (!value) throw Refusal(fmt::format("it does not say its {}", key), scaling_advice);
  return *value;
}

network::Scaling Metadata::scaling() const {
  network::Scaling scaling{.label_scale_dps = scale(key::label_scale_dps)};
  if (by_window_) {
    scaling.by_window = true;
    scaling.frame_period_s = scale(key::frame_period_s);
    scaling.gate_states_sigma = flag(key::gate_states_sigma);
  } else {
    scaling.temp_mean_c = scale(key::temp_mean_c);
    scaling.temp_deviation_c = scale(key::temp_deviation_c);
  }
  const auto within = [](float value, float least, float most) { return least <= value && value <= most; };
  if (!within(scaling.label_scale_dps, 1e-3F, 1e6F))
    throw Refusal("its label_scale_dps is not between 0.001 and 1,000,000 deg/s", scaling_advice);
  if (by_window_ && !within(scaling.frame_period_s, 1e-3F, 100.0F))
    throw Refusal("its frame_period_s is not between 0.001 and 100 s", scaling_advice);
  if (!within(scaling.temp_mean_c, -300.0F, 1e4F))
    throw Refusal("its temp_mean_c is not between -300 and 10,000 degrees", scaling_advice);
  if (!within(scaling.temp_deviation_c, 1e-4F, 1e4F))
    throw Refusal("its temp_deviation_c is not between 0.0001 and 10,000 degrees", scaling_advice);
  return scaling;
}

std::vector<Provenance::Data> Metadata::data(std::string_view key) const {
  std::vector<Provenance::Data> data;
  for (;;) {
    const auto found = entries_.find(fmt::format("{}_{}", key, data.size() + 1));
    if (found == entries_.end()) return data;
    const std::string& text = found->second;
    const std::size_t space = text.find(' ');
    if (space == std::string::npos)
      throw Refusal(fmt::format("its metadata {} is not a hash and a name", in_quotes(found->first)));
    data.push_back({text.substr(space + 1), text.substr(0, space)});
  }
}

std::optional<network::CameraView> Metadata::view() const {
  if (!by_window_ || !has(key::view_width_deg)) return std::nullopt;
  const network::CameraView view{.width_deg = number<double>(key::view_width_deg).value_or(0.0),
                                 .half_frames = flag(key::half_frames),
                                 .mirrored = flag(key::mirrored)};
  if (!(view.width_deg >= 1.0 && view.width_deg <= 360.0))
    throw Refusal("its view_width_deg is not between 1 and 360 degrees");
  return view;
}

/// Ours did not say it while there was no choice.
std::optional<Label> Metadata::label() const {
  const auto found = entries_.find(key::label);
  if (found == entries_.end()) return ours_ ? std::optional(Label::commanded) : std::nullopt;
  if (found->second.empty()) return std::nullopt;
  if (const auto label = find_label(found->second)) return label;
  throw Refusal(fmt::format("its metadata {} is {}, which is no label known here", key::label,
                            in_quotes(found->second)));
}

Provenance Metadata::provenance(const std::string& producer) const {
  Provenance from;
  from.producer = producer;
  from.preset = text(key::preset);
  from.label = label();
  from.seed = number<std::uint64_t>(key::seed).value_or(0);
  from.epochs = number<int>(key::epochs).value_or(0);
  from.epoch_kept = number<int>(key::epoch_kept).value_or(0);
  if (from.epochs < 0 || from.epoch_kept < 0 || from.epoch_kept > from.epochs)
    throw Refusal(fmt::format("it claims to keep epoch {} of {}", from.epoch_kept, from.epochs));
  from.training = data(key::training_data);
  from.held_out = data(key::held_out_data);
  from.simulated = flag(key::simulated);
  from.data_licence = text(key::data_licence);
  if (!by_window_) return from;
  from.view = view();
  from.made_windows = number<std::uint64_t>(key::made_windows).value_or(0);
  from.begun_from = text(key::begun_from);
  return from;
}

void Metadata::check(const network::Weights& weights) const {
  const auto said = find(key::weights_crc32);
  if (said && *said != sum_of(weights))
    throw Refusal(
        "its weights differ from their checksum",
        "copy the file again; if the weights were changed on purpose, remove the metadata weights_crc32");
}

}  // namespace thermorig::model
