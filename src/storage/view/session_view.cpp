// SPDX-License-Identifier: MIT
#include "thermorig/storage/view/session_view.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "thermorig/core/image_bytes.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/rows.h"

namespace thermorig::view {

namespace {

/// A column as the page gets it.
struct ColumnName {
  std::string name;       // with its unit: "shaft_dps"
  std::string_view type;  // f64, f32, u32, u16 or u8
};

/// A table as bytes, one column behind the other: of each the lowest bytes of all values, then their next
/// higher ones, up to the highest. Neighbours are alike that way, and pack well.
class Columns {
 public:
  /// Of a table with `all` rows every n-th, the first one among them; `every`: at least 1.
  Columns(std::size_t all, std::size_t every) : rows_((all + every - 1) / every), every_(every) {}

  /// `at(row)` is the value in that row of the whole table.
  template <typename Value, typename At>
  void add(std::string name, At at) {
    names_.push_back({std::move(name), type_of<Value>()});
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + rows_ * sizeof(Value));
    for (std::size_t row = 0; row < rows_; ++row) {
      const Value value = at(row * every_);
      std::array<char, sizeof(Value)> parts{};
      std::memcpy(parts.data(), &value, sizeof value);
      for (std::size_t i = 0; i < sizeof(Value); ++i) bytes_[begin + i * rows_ + row] = parts[i];
    }
  }

  std::size_t rows() const { return rows_; }
  std::size_t every() const { return every_; }
  const std::vector<ColumnName>& names() const { return names_; }
  const std::string& bytes() const { return bytes_; }

 private:
  template <typename Value>
  static constexpr std::string_view type_of() {
    static_assert(std::endian::native == std::endian::little);
    if constexpr (std::is_same_v<Value, double>) return "f64";
    if constexpr (std::is_same_v<Value, float>) return "f32";
    if constexpr (std::is_same_v<Value, std::uint32_t>) return "u32";
    if constexpr (std::is_same_v<Value, std::uint16_t>) return "u16";
    if constexpr (std::is_same_v<Value, std::uint8_t>) return "u8";
  }

  std::size_t rows_, every_;
  std::vector<ColumnName> names_;
  std::string bytes_;
};

/// What the estimate of a frame says where there is none.
constexpr std::uint8_t no_estimate = 255;

using session::FrameMarks;
using session::Rows;

constexpr float not_known = std::numeric_limits<float>::quiet_NaN();

/// 0: the frame repeats the one before, 1: one half of it is new, 2: both.
std::uint8_t fresh_halves(const FrameMarks& marks) {
  return static_cast<std::uint8_t>((marks.fresh_even > 0 ? 1 : 0) + (marks.fresh_odd > 0 ? 1 : 0));
}

/// The mean of the gyro without its bias and scale, as far as this session tells them.
float corrected_dps(const LabelledSample& sample, const GyroErrors& errors) {
  return static_cast<float>((double{sample.rate_gyro_dps} - bias_dps_at(errors, sample.time)) /
                            errors.scale.value);
}

void add_speeds(Columns& columns, const Rows& rows) {
  const std::vector<LabelledSample>& samples = rows.session.samples;
  const auto add = [&](const char* name, float LabelledSample::*member) {
    columns.add<float>(name, [&samples, member](std::size_t row) { return samples[row].*member; });
  };
  add("commanded_dps", &LabelledSample::rate_commanded_dps);
  add("shaft_dps", &LabelledSample::rate_shaft_dps);
  add("shaft_sigma_dps", &LabelledSample::rate_shaft_uncertainty_dps);
  add("gyro_dps", &LabelledSample::rate_gyro_dps);
  columns.add<float>("corrected_dps",
                     [&](std::size_t row) { return corrected_dps(samples[row], rows.session.sync.gyro); });
  add("angle_deg", &LabelledSample::angle_commanded_deg);
}

void add_validity(Columns& columns, const Rows& rows) {
  const std::vector<LabelledSample>& samples = rows.session.samples;
  columns.add<std::uint32_t>("reasons", [&](std::size_t row) { return samples[row].reason_bits; });
  columns.add<std::uint32_t>("run", [&](std::size_t row) { return samples[row].run; });
  columns.add<std::uint16_t>("leg", [&](std::size_t row) { return samples[row].leg; });
  columns.add<std::uint16_t>("missing", [&](std::size_t row) { return rows.frames[row].missing_before; });
  columns.add<std::uint8_t>("valid",
                            [&](std::size_t row) -> std::uint8_t { return samples[row].valid ? 1 : 0; });
  columns.add<std::uint8_t>("fresh", [&](std::size_t row) { return fresh_halves(rows.frames[row]); });
}

/// The row of /estimates of each frame, or none: a row and a frame of one index belong together if their
/// times do.
std::vector<const EstimateRow*> estimates_by_frame(const Rows& rows) {
  const std::vector<LabelledSample>& samples = rows.session.samples;
  std::vector<const EstimateRow*> by_frame(samples.size(), nullptr);
  for (const EstimateRow& row : rows.session.raw.estimates) {
    if (row.frame_index >= samples.size()) continue;
    const double apart_s = std::abs(to_s(row.time - samples[row.frame_index].time));
    if (apart_s <= rows.session.frame_period_s / 2) by_frame[row.frame_index] = &row;
  }
  return by_frame;
}

/// What one estimator said; `name`: "estimates.0".
void add_estimates(Columns& columns, const std::vector<const EstimateRow*>& by_frame, std::size_t place,
                   std::size_t values) {
  const std::string name = fmt::format("estimates.{}", place);
  const auto number = [&](const std::string& column, auto get) {
    columns.add<float>(name + column, [&by_frame, place, get](std::size_t row) {
      return by_frame[row] == nullptr ? not_known : static_cast<float>(get(by_frame[row]->estimates[place]));
    });
  };
  const auto word = [&](const std::string& column, auto get) {
    columns.add<std::uint8_t>(name + column, [&by_frame, place, get](std::size_t row) {
      return by_frame[row] == nullptr ? no_estimate
                                      : static_cast<std::uint8_t>(get(by_frame[row]->estimates[place]));
    });
  };
  number(".rate_dps", [](const RateEstimate& estimate) { return estimate.rate_dps; });
  number(".sigma_dps", [](const RateEstimate& estimate) { return estimate.rate_sigma_dps; });
  for (std::size_t i = 0; i < values; ++i)
    number(fmt::format(".values.{}", i), [i](const RateEstimate& estimate) { return estimate.values[i]; });
  word(".state", [](const RateEstimate& estimate) { return estimate.state; });
  word(".reason", [](const RateEstimate& estimate) { return estimate.reason; });
}

/// A row for every n-th frame: its time, its speeds, its validity, and what the estimators of a live run said
/// of it. docs/session_page.md has the list.
Columns frame_columns(const Rows& rows, std::size_t every) {
  const std::vector<LabelledSample>& samples = rows.session.samples;
  const HostTime begin = rows.session.raw.header.time_reference;
  Columns columns(samples.size(), every);
  columns.add<double>("time_s", [&](std::size_t row) { return to_s(samples[row].time - begin); });
  add_speeds(columns, rows);
  add_validity(columns, rows);
  const std::vector<EstimatorColumn>& estimators = rows.session.raw.header.estimators;
  if (estimators.empty()) return columns;
  const std::vector<const EstimateRow*> by_frame = estimates_by_frame(rows);
  columns.add<float>("window_dps", [&](std::size_t row) {
    return by_frame[row] == nullptr ? not_known : by_frame[row]->rate_commanded_dps;
  });
  for (std::size_t place = 0; place < estimators.size(); ++place)
    add_estimates(columns, by_frame, place, estimators[place].values.size());
  return columns;
}

using nlohmann::json;
using session::Session;

/// More are told of by their number alone.
constexpr std::size_t most_listed = 5000;

json number(double value) {
  return std::isfinite(value) ? json(value) : json();
}

template <typename Rows_, typename Object>
json list_of(const Rows_& rows, Object object) {
  json list = json::array();
  for (std::size_t i = 0; i < rows.size() && i < most_listed; ++i) list.push_back(object(rows[i]));
  return list;
}

template <std::size_t size>
json words(const std::array<std::string_view, size>& names) {
  json list = json::array();
  for (const std::string_view name : names) list.push_back(std::string(name));
  return list;
}

/// What measured the shaft, and whether labels are made by it; empty: nothing did.
std::string shaft_text(const Session& session) {
  const std::string& sensor = session.raw.header.shaft_sensor;
  if (sensor.empty()) return "";
  const ShaftReport& shaft = session.sync.shaft;
  if (shaft.used) return "measured by " + sensor + ": labels are made by it";
  return "measured by " + sensor + ", which is not used: " + shaft.why_not;
}

json header_json(const Session& session) {
  const RecordingHeader& header = session.raw.header;
  const session::Place place = session::place_of(session);
  return {{"environment", place.environment},
          {"acquisition", place.acquisition},
          {"start_utc", header.start_time_utc},
          {"simulated", header.simulated},
          {"simulation", header.simulation},
          {"seed", header.simulation_seed ? json(*header.simulation_seed) : json()},
          {"plan", header.plan_name},
          {"frames_per_leg", header.frames_per_leg},
          {"licence", header.licence},
          {"operator", header.operator_name},
          {"place", header.place},
          {"note", header.note},
          {"creator", header.creator},
          {"firmware", header.firmware},
          {"shaft", shaft_text(session)},
          {"model", header.live_model.name}};
}

json legs_json(const Session& session) {
  const HostTime begin = session.raw.header.time_reference;
  return list_of(session.raw.legs, [begin](const LegRecord& leg) -> json {
    return {{"leg", leg.leg},
            {"rate_dps", number(leg.rate_dps)},
            {"begin_s", to_s(leg.begin - begin)},
            {"end_s", to_s(leg.end - begin)},
            {"complete", leg.complete}};
  });
}

json events_json(const Session& session) {
  const HostTime begin = session.raw.header.time_reference;
  return list_of(session.raw.events, [begin](const RecordingEvent& event) -> json {
    return {{"time_s", to_s(event.time - begin)},
            {"kind", std::string(event_kind_names[static_cast<std::size_t>(event.kind)])},
            {"source", event.source ? std::string(name_of(*event.source)) : "host"},
            {"message", event.message}};
  });
}

json annotations_json(const Session& session) {
  return list_of(session.annotations, [](const Annotation& annotation) -> json {
    json object{{"kind", std::string(annotation_kind_names[static_cast<std::size_t>(annotation.kind)])},
                {"made_utc", annotation.made_utc},
                {"text", annotation.text}};
    if (annotation.kind == AnnotationKind::exclusion) {
      object["begin_s"] = annotation.begin_s;
      object["end_s"] = annotation.end_s;
    }
    return object;
  });
}

json estimators_json(const Session& session) {
  return list_of(session.raw.header.estimators, [](const EstimatorColumn& column) -> json {
    return {{"name", column.name}, {"values", column.values}};
  });
}

/// How many frames are valid, and what stands against the others.
json counts_json(const Session& session) {
  std::uint64_t valid = 0, swept = 0;
  for (const LabelledSample& sample : session.samples) {
    valid += sample.valid ? 1 : 0;
    swept += sample.leg != 0 || !session.raw.header.profile.servo.is_there() ? 1 : 0;
  }
  return {{"frames", session.samples.size()}, {"frames_swept", swept}, {"frames_valid", valid}};
}

json sync_json(const Session& session) {
  const GyroErrors& gyro = session.sync.gyro;
  return {{"gyro_bias_dps", gyro.bias_dps ? number(gyro.bias_dps->value) : json()},
          {"gyro_bias_moves", !gyro.bias_course.empty()},
          {"gyro_scale", number(gyro.scale.value)}};
}

/// What stands beside the frames, as one JSON text: where it comes from, plan, verdict, legs, events,
/// annotations, estimators, and the names of the columns. `file`: the session's name.
std::string facts_json(const std::string& file, const Rows& rows, const Columns& columns) {
  const Session& session = rows.session;
  json facts = header_json(session);
  facts.update(counts_json(session));
  facts.update(sync_json(session));
  facts.update({{"file", file},
                {"state", session::name_of(session.state)},
                {"duration_s", to_s(session.raw.end_time - session.raw.header.time_reference)},
                {"frame_period_s", number(session.frame_period_s)},
                {"camera_mode", session.camera_mode},
                {"verdict", rows.verdict},
                {"verdict_reasons", rows.verdict_reasons},
                {"verdict_altered", rows.verdict_altered},
                {"legs", legs_json(session)},
                {"leg_count", session.raw.legs.size()},
                {"events", events_json(session)},
                {"event_count", session.raw.events.size()},
                {"annotations", annotations_json(session)},
                {"estimators", estimators_json(session)},
                {"reason_names", words(reason_names)},
                {"warning_bits", warning_bits},
                {"state_names", words(estimate_state_names)},
                {"estimate_reason_names", words(estimate_reason_names)}});
  facts["rows_every"] = columns.every();
  facts["columns"] = list_of(columns.names(), [](const ColumnName& column) -> json {
    return {{"name", column.name}, {"type", std::string(column.type)}};
  });
  return facts.dump(-1, ' ', true, json::error_handler_t::replace);
}

std::optional<std::uint64_t> take_number(std::string_view& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

SessionView::SessionView(const std::filesystem::path& path, std::uint64_t every) : file_(path) {
  const session::Rows rows = session::read_rows(file_);
  const Columns columns = frame_columns(rows, every);
  frames_ = rows.session.samples.size();
  facts_ = facts_json(path.filename().string(), rows, columns);
  rows_ = columns.bytes();
}

std::string SessionView::images(session::FrameRange range) const {
  const session::Images images = session::read_images(file_, range);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(images.frames.size() * image_bytes);
  for (const ThermalFrame& frame : images.frames) append_image(bytes, frame, images.mirrored);
  return {bytes.begin(), bytes.end()};
}

std::optional<std::string> served_part(const SessionView& view, std::string_view name) {
  constexpr std::string_view block_prefix = "images/";
  if (name == "facts") return view.facts();
  if (name == "rows") return view.rows();
  if (!name.starts_with(block_prefix)) return std::nullopt;
  name.remove_prefix(block_prefix.size());
  const auto block = take_number(name);
  if (!block || !name.empty() || *block > view.frames() / served_images) return std::nullopt;
  const std::uint64_t first = *block * served_images;
  if (first >= view.frames()) return std::nullopt;
  return view.images({first, std::min(served_images, view.frames() - first)});
}

}  // namespace thermorig::view
