// SPDX-License-Identifier: MIT
#include "thermorig/estimators/live/live_estimates.h"

#include <algorithm>
#include <utility>

#include "thermorig/network/frames_in_a_row.h"
#include "thermorig/network/last_blocks.h"
#include "thermorig/network/window_index.h"

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

struct LiveEstimates::Parts {
  explicit Parts(estimators::Bank given)
      : bank(std::move(given)),
        rule(bank.frames()),
        labels(static_cast<std::size_t>(bank.frames()), 1),
        in_a_row(bank.frames()) {}

  estimators::Bank bank;
  network::WindowRule rule;
  network::LastBlocks labels;
  network::FramesInARow in_a_row;
};

LiveEstimates::LiveEstimates(estimators::Bank bank) : parts_(std::make_unique<Parts>(std::move(bank))) {}

LiveEstimates::~LiveEstimates() = default;
LiveEstimates::LiveEstimates(LiveEstimates&&) noexcept = default;
LiveEstimates& LiveEstimates::operator=(LiveEstimates&&) noexcept = default;

EstimateRow LiveEstimates::add(const Measurement& measurement, HostTime arrived) {
  Parts& parts = *parts_;
  const TimedFrame& frame = measurement.frame;
  const LabelledSample& sample = measurement.sample;
  const int frames = parts.bank.frames();
  const int in_a_row = parts.in_a_row.push(frame);
  const bool sound = (in_a_row > 0 || frame.stands_in) && is_rate(sample.rate_commanded_dps) &&
                     is_rate(sample.rate_gyro_dps);
  parts.labels.push(sample.rate_commanded_dps);
  EstimateRow row = row_of(sample, arrived);
  row.rate_commanded_dps = network::mean_rate(parts.labels.all());
  row.counted = parts.rule.push(sound ? row.run : 0) && (frame.stands_in || in_a_row == frames);
  std::ranges::copy(parts.bank.add(measurement), row.estimates.begin());
  return row;
}

const estimators::Bank& LiveEstimates::bank() const {
  return parts_->bank;
}

std::vector<EstimatorColumn> columns_of(const estimators::Bank& bank) {
  std::vector<EstimatorColumn> columns;
  for (const estimators::Entry* entry : bank.entries())
    columns.push_back({std::string(entry->name), {entry->values.begin(), entry->values.end()}});
  return columns;
}

}  // namespace thermorig::live
