// SPDX-License-Identifier: MIT
#include "frame_columns.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace thermorig::view {

namespace {

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

}  // namespace

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

}  // namespace thermorig::view
