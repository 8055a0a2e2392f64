// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/table.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "facts.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/validity.h"

namespace thermorig::interchange {

namespace {

using session::Session;

template <typename Type, std::size_t Index = 0>
constexpr std::size_t index_of() {
  if constexpr (std::is_same_v<Type, std::variant_alternative_t<Index, Value>>)
    return Index;
  else
    return index_of<Type, Index + 1>();
}

/// The columns of a table whose rows are elements of `rows`.
template <typename Row>
class ColumnsOf {
 public:
  ColumnsOf(const std::vector<Row>& rows, HostTime reference) : rows_(rows), reference_(reference) {}

  template <typename Get>
  void add(std::string name, std::string units, Get get) {
    using Type = std::decay_t<std::invoke_result_t<Get, const Row&>>;
    columns_.push_back({std::move(name), std::move(units), index_of<Type>(),
                        [&rows = rows_, get](std::size_t row) { return Value(get(rows[row])); }});
  }

  template <typename Get>
  void add_time(std::string name, Get get) {
    add(std::move(name), "s",
        [reference = reference_, get](const Row& row) { return to_s(get(row) - reference); });
  }

  Table take() { return {rows_.size(), std::move(columns_)}; }

 private:
  const std::vector<Row>& rows_;
  HostTime reference_;
  std::vector<Column> columns_;
};

std::string reasons_text(std::uint32_t bits) {
  std::string text;
  for (std::uint32_t i = 0; i < reason_count; ++i)
    if ((bits >> i & 1U) != 0) text.append(text.empty() ? "" : " ").append(reason_names[i]);
  return text;
}

Table samples_of(const Session& session) {
  using Row = LabelledSample;
  ColumnsOf<Row> columns(session.samples, session.raw.header.time_reference);
  columns.add_time("time", [](const Row& row) { return row.time; });
  columns.add("frame", "", [](const Row& row) { return row.frame_index; });
  columns.add("rate_commanded", "deg/s", [](const Row& row) { return row.rate_commanded_dps; });
  columns.add("rate_commanded_uncertainty", "deg/s",
              [](const Row& row) { return row.rate_commanded_uncertainty_dps; });
  columns.add("rate_corrected", "deg/s", [](const Row& row) { return row.rate_corrected_dps; });
  columns.add("rate_corrected_uncertainty", "deg/s",
              [](const Row& row) { return row.rate_corrected_uncertainty_dps; });
  columns.add("rate_shaft", "deg/s", [](const Row& row) { return row.rate_shaft_dps; });
  columns.add("rate_shaft_uncertainty", "deg/s",
              [](const Row& row) { return row.rate_shaft_uncertainty_dps; });
  if (has_measured_shaft(session.raw)) {
    columns.add("rate_measured", "deg/s", [](const Row& row) { return row.rate_measured_dps; });
    columns.add("rate_measured_uncertainty", "deg/s",
                [](const Row& row) { return row.rate_measured_uncertainty_dps; });
    columns.add("angle_measured", "deg", [](const Row& row) { return row.angle_measured_deg; });
  }
  columns.add("rate_gyro", "deg/s", [](const Row& row) { return row.rate_gyro_dps; });
  columns.add("gyro_count", "", [](const Row& row) { return row.gyro_count; });
  columns.add("gyro_spread", "deg/s", [](const Row& row) { return row.gyro_spread_dps; });
  columns.add("angle_commanded", "deg", [](const Row& row) { return row.angle_commanded_deg; });
  columns.add("valid", "", [](const Row& row) { return std::uint8_t{row.valid}; });
  columns.add("reason_bits", "", [](const Row& row) { return row.reason_bits; });
  columns.add("reasons", "", [](const Row& row) { return reasons_text(row.reason_bits); });
  columns.add("leg", "", [](const Row& row) { return row.leg; });
  columns.add("run", "", [](const Row& row) { return row.run; });
  columns.add_time("exposure_begin", [](const Row& row) { return row.exposure_begin; });
  columns.add_time("exposure_end", [](const Row& row) { return row.exposure_end; });
  return columns.take();
}

Table camera_of(const Session& session) {
  using Row = TimedFrame;
  ColumnsOf<Row> columns(session.frames, session.raw.header.time_reference);
  columns.add_time("time", [](const Row& row) { return row.stamp.time; });
  columns.add("time_uncertainty", "s", [](const Row& row) { return row.stamp.uncertainty_s; });
  columns.add("sensor_temperature", "degC", [](const Row& row) { return row.frame.sensor_temp_c; });
  columns.add("missing_before", "", [](const Row& row) { return row.missing_before; });
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    columns.add(fmt::format("temperature_{}_{}", pixel / frame_columns, pixel % frame_columns), "degC",
                [pixel](const Row& row) { return row.frame.temp_c[pixel]; });
  return columns.take();
}

Table gyro_of(const Session& session) {
  using Row = TimedGyro;
  ColumnsOf<Row> columns(session.gyro, session.raw.header.time_reference);
  columns.add_time("time", [](const Row& row) { return row.stamp.time; });
  columns.add("time_uncertainty", "s", [](const Row& row) { return row.stamp.uncertainty_s; });
  columns.add("rate", "deg/s", [](const Row& row) { return row.rate_dps; });
  for (std::size_t axis = 0; axis < 3; ++axis)
    columns.add(fmt::format("rate_{}", "xyz"[axis]), "deg/s",
                [axis](const Row& row) { return row.reading.rate_dps[axis]; });
  columns.add("saturated", "", [](const Row& row) { return std::uint8_t{row.reading.saturated}; });
  columns.add("lost_before", "", [](const Row& row) { return std::uint8_t{row.lost_before}; });
  return columns.take();
}

Table servo_of(const Session& session) {
  using Row = TimedServo;
  ColumnsOf<Row> columns(session.servo, session.raw.header.time_reference);
  columns.add_time("time", [](const Row& row) { return row.stamp.time; });
  columns.add("time_uncertainty", "s", [](const Row& row) { return row.stamp.uncertainty_s; });
  columns.add("angle_commanded", "deg", [](const Row& row) { return row.state.angle_deg; });
  columns.add("rate_commanded", "deg/s", [](const Row& row) { return row.state.rate_dps; });
  columns.add("pulse_width", "us", [](const Row& row) { return row.state.pulse_us; });
  columns.add("leg", "", [](const Row& row) { return row.state.leg; });
  return columns.take();
}

Table events_of(const Session& session) {
  using Row = RecordingEvent;
  ColumnsOf<Row> columns(session.raw.events, session.raw.header.time_reference);
  columns.add_time("time", [](const Row& row) { return row.time; });
  columns.add("kind", "", [](const Row& row) {
    return std::string(event_kind_names[static_cast<std::size_t>(row.kind)]);
  });
  columns.add("source", "",
              [](const Row& row) { return std::string(row.source ? name_of(*row.source) : "host"); });
  columns.add("message", "", [](const Row& row) { return row.message; });
  return columns.take();
}

Table estimates_of(const Session& session) {
  using Row = EstimateRow;
  ColumnsOf<Row> columns(session.raw.estimates, session.raw.header.time_reference);
  columns.add_time("time", [](const Row& row) { return row.time; });
  columns.add("frame", "", [](const Row& row) { return row.frame_index; });
  columns.add("rate_commanded", "deg/s", [](const Row& row) { return row.rate_commanded_dps; });
  columns.add("counted", "", [](const Row& row) { return std::uint8_t{row.counted}; });
  const std::vector<EstimatorColumn>& estimators = session.raw.header.estimators;
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const std::string& name = estimators[i].name;
    columns.add(name + ".rate", "deg/s", [i](const Row& row) { return row.estimates[i].rate_dps; });
    columns.add(name + ".rate_sigma", "deg/s",
                [i](const Row& row) { return row.estimates[i].rate_sigma_dps; });
    columns.add(name + ".angle", "deg", [i](const Row& row) { return row.estimates[i].angle_deg; });
    columns.add(name + ".angle_sigma", "deg",
                [i](const Row& row) { return row.estimates[i].angle_sigma_deg; });
    columns.add(name + ".state", "",
                [i](const Row& row) { return std::string(name_of(row.estimates[i].state)); });
    for (std::size_t k = 0; k < estimators[i].values.size(); ++k)
      columns.add(fmt::format("{}.{}", name, estimators[i].values[k]), "",
                  [i, k](const Row& row) { return row.estimates[i].values[k]; });
  }
  return columns.take();
}

struct NamedTable {
  std::string_view name;
  Table (*make)(const Session& session);
};

constexpr std::array<NamedTable, 6> tables{{{"samples", samples_of},
                                            {"camera", camera_of},
                                            {"gyro", gyro_of},
                                            {"servo", servo_of},
                                            {"estimates", estimates_of},
                                            {"events", events_of}}};

}  // namespace

const std::vector<std::string>& table_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const NamedTable& table : tables) all.emplace_back(table.name);
    return all;
  }();
  return names;
}

Table table_of(const session::Session& session, std::string_view name) {
  for (const NamedTable& table : tables)
    if (table.name == name) return table.make(session);
  return {};
}

}  // namespace thermorig::interchange
