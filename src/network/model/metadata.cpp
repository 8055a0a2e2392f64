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
  if (text(key::format) != format_name) throw Refusal("its metadata says that it is another kind of model");
  by_window_ = entries_.contains(key::scaling);
  if (by_window_ && text(key::scaling) != by_window)
    throw Refusal(fmt::format("its frames are scaled by {}, which this program does not know",
                              in_quotes(text(key::scaling))),
                  "use the program that wrote it, or a newer one");
  if (number<int>(key::format_version) !=
      (by_window_ ? format_version_by_window : format_version_by_data_set))
    throw Refusal(fmt::format("it is a model file of version {}, this program knows versions {} and {}",
                              in_quotes(text(key::format_version)), format_version_by_data_set,
                              format_version_by_window),
                  "use the program that wrote it, or a newer one");
}

const std::string& Metadata::text(std::string_view key) const {
  const auto found = entries_.find(key);
  if (found == entries_.end()) throw Refusal(fmt::format("its metadata lacks '{}'", key));
  return found->second;
}

template <class Number>
Number Metadata::number(std::string_view key) const {
  const std::string& said = text(key);
  Number value{};
  const auto [end, failure] = std::from_chars(said.data(), said.data() + said.size(), value);
  if (failure != std::errc{} || end != said.data() + said.size())
    throw Refusal(fmt::format("its metadata {} is {}, which is no such number", key, in_quotes(said)));
  return value;
}

bool Metadata::flag(std::string_view key) const {
  const std::string& said = text(key);
  if (said != "true" && said != "false")
    throw Refusal(fmt::format("its metadata {} is {}, neither true nor false", key, in_quotes(said)));
  return said == "true";
}

network::Shape Metadata::shape() const {
  network::Shape shape{.frames = number<int>(key::frames),
                       .reduction = number<int>(key::reduction),
                       .fusion = text(key::network) == "fusion",
                       .padding1 = number<int>(key::padding1),
                       .padding2 = number<int>(key::padding2),
                       .crop_left = number<int>(key::crop_left)};
  if (text(key::network) != name_of_network(shape))
    throw Refusal(
        fmt::format("its metadata says {}, which is no network known here", in_quotes(text(key::network))));
  if (const auto fault = network::fault_of(shape)) throw Refusal("its metadata does not fit: " + *fault);
  if (by_window_ && shape.crop_left != 0)
    throw Refusal("its graph averages from the first column on, and its metadata has a crop_left");
  return shape;
}

network::Scaling Metadata::scaling() const {
  network::Scaling scaling{.label_scale_dps = number<float>(key::label_scale_dps)};
  if (by_window_) {
    scaling.by_window = true;
    scaling.frame_period_s = number<float>(key::frame_period_s);
    scaling.gate_states_sigma = flag(key::gate_states_sigma);
  } else {
    scaling.temp_mean_c = number<float>(key::temp_mean_c);
    scaling.temp_deviation_c = number<float>(key::temp_deviation_c);
  }
  const auto within = [](float value, float least, float most) { return least <= value && value <= most; };
  if (!within(scaling.label_scale_dps, 1e-3F, 1e6F))
    throw Refusal("its label_scale_dps is not between 0.001 and 1,000,000 deg/s");
  if (by_window_ && !within(scaling.frame_period_s, 1e-3F, 100.0F))
    throw Refusal("its frame_period_s is not between 0.001 and 100 s");
  if (!within(scaling.temp_mean_c, -300.0F, 1e4F))
    throw Refusal("its temp_mean_c is not between -300 and 10,000 degrees");
  if (!within(scaling.temp_deviation_c, 1e-4F, 1e4F))
    throw Refusal("its temp_deviation_c is not between 0.0001 and 10,000 degrees");
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
  if (!by_window_ || !entries_.contains(key::view_width_deg)) return std::nullopt;
  const network::CameraView view{.width_deg = number<double>(key::view_width_deg),
                                 .half_frames = flag(key::half_frames),
                                 .mirrored = flag(key::mirrored)};
  if (!(view.width_deg >= 1.0 && view.width_deg <= 360.0))
    throw Refusal("its view_width_deg is not between 1 and 360 degrees");
  return view;
}

/// Files did not say it while there was no choice.
std::optional<Label> Metadata::label() const {
  const auto found = entries_.find(key::label);
  if (found == entries_.end()) return Label::commanded;
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
  from.seed = number<std::uint64_t>(key::seed);
  from.epochs = number<int>(key::epochs);
  from.epoch_kept = number<int>(key::epoch_kept);
  if (from.epochs < 0 || from.epoch_kept < 0 || from.epoch_kept > from.epochs)
    throw Refusal(fmt::format("it claims to keep epoch {} of {}", from.epoch_kept, from.epochs));
  from.training = data(key::training_data);
  from.held_out = data(key::held_out_data);
  from.simulated = flag(key::simulated);
  from.data_licence = text(key::data_licence);
  if (!by_window_) return from;
  from.view = view();
  from.made_windows = number<std::uint64_t>(key::made_windows);
  from.begun_from = text(key::begun_from);
  return from;
}

void Metadata::check(const network::Weights& weights) const {
  const std::string& said = text(key::weights_crc32);
  if (!said.empty() && said != sum_of(weights))
    throw Refusal(
        "its weights differ from their checksum",
        "copy the file again; if they were changed on purpose, make its metadata weights_crc32 empty");
}

}  // namespace thermorig::model
