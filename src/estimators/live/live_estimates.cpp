// SPDX-License-Identifier: MIT
#include "thermorig/estimators/live/live_estimates.h"

#include <algorithm>
#include <utility>

namespace thermorig::live {

namespace {

EstimateRow row_of(const LabelledSample& sample, HostTime arrived) {
  return {.frame_index = sample.frame_index,
          .time = sample.time,
          .exposure_begin = sample.exposure_begin,
          .exposure_end = sample.exposure_end,
          .arrival = arrived,
          .reason_bits = sample.reason_bits,
          .run = sample.valid ? sample.run : 0,
          .leg = sample.leg};
}

}  // namespace

LiveEstimates::LiveEstimates(estimators::Bank bank)
    : bank_(std::move(bank)),
      rule_(bank_.frames()),
      labels_(static_cast<std::size_t>(bank_.frames()), 1),
      in_a_row_(bank_.frames()) {}

EstimateRow LiveEstimates::add(const Measurement& measurement, HostTime arrived) {
  const TimedFrame& frame = measurement.frame;
  const LabelledSample& sample = measurement.sample;
  const int frames = bank_.frames();
  const int in_a_row = in_a_row_.push(frame);
  const bool sound = (in_a_row > 0 || frame.stands_in) && is_rate(sample.rate_commanded_dps) &&
                     is_rate(sample.rate_gyro_dps);
  labels_.push(sample.rate_commanded_dps);
  EstimateRow row = row_of(sample, arrived);
  row.rate_commanded_dps = network::mean_rate(labels_.all());
  row.counted = rule_.push(sound ? row.run : 0) && (frame.stands_in || in_a_row == frames);
  std::ranges::copy(bank_.add(measurement), row.estimates.begin());
  return row;
}

std::vector<EstimatorColumn> columns_of(const estimators::Bank& bank) {
  std::vector<EstimatorColumn> columns;
  for (const estimators::Entry* entry : bank.entries())
    columns.push_back({std::string(entry->name), {entry->values.begin(), entry->values.end()}});
  return columns;
}

}  // namespace thermorig::live
