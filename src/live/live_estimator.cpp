// SPDX-License-Identifier: MIT
#include "thermorig/live/live_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/windows/last_blocks.h"
#include "thermorig/windows/scaling.h"
#include "thermorig/windows/soundness.h"
#include "thermorig/windows/window_index.h"

namespace thermorig::live {

namespace {

/// A network from a stranger's file may say anything.
float finite_or_unknown(float value) {
  return std::isfinite(value) ? value : static_cast<float>(unknown);
}

/// The network and the images of its window.
class ThermalWindow {
 public:
  ThermalWindow(const model::Model& model, network::Precision precision)
      : estimator_(model.weights, precision),
        scaling_(model.scaling),
        prepared_(shape().pixels()),
        images_(static_cast<std::size_t>(shape().frames), shape().pixels()) {}

  void push(std::span<const float> temp_c) {
    windows::prepare_frame(temp_c, shape(), scaling_, prepared_);
    images_.push(prepared_);
  }

  /// Speeds and gain into the row, whose gyro is that of the window.
  void estimate(LiveEstimate& row) {
    const float scale_dps = scaling_.label_scale_dps;
    const bool gyro_known = windows::is_sound_rate(row.rate_gyro_dps);
    const network::Output output =
        estimator_.estimate(images_.all(), gyro_known ? row.rate_gyro_dps / scale_dps : 0.0F);
    row.rate_thermal_dps = finite_or_unknown(output.thermal * scale_dps);
    if (!shape().fusion || !gyro_known) return;
    row.rate_fusion_dps = finite_or_unknown(output.fusion * scale_dps);
    row.gain = finite_or_unknown(output.gain);
  }

 private:
  const network::Shape& shape() const { return estimator_.shape(); }

  network::Estimator estimator_;
  windows::Scaling scaling_;
  std::vector<float> prepared_;
  windows::LastBlocks images_;
};

LiveEstimate row_of(const LabelledSample& sample, HostTime arrived) {
  return {.frame_index = sample.frame_index,
          .time = sample.time,
          .exposure_begin = sample.exposure_begin,
          .exposure_end = sample.exposure_end,
          .arrival = arrived,
          .rate_thermal_dps = unknown,
          .rate_fusion_dps = unknown,
          .gain = unknown,
          .reason_bits = sample.reason_bits,
          .run = sample.valid ? sample.run : 0,
          .leg = sample.leg};
}

bool gap_before(const TimedFrame& frame) {
  return frame.resync_before || frame.missing_before > 0;
}

}  // namespace

struct LiveEstimator::Parts {
  Parts(const std::optional<model::Model>& model, network::Precision precision)
      : frames(model ? model->weights.shape.frames : 1),
        rule(frames),
        labels(static_cast<std::size_t>(frames), 1),
        gyro(static_cast<std::size_t>(frames), 1) {
    if (model) thermal.emplace(*model, precision);
  }

  int frames;
  windows::WindowRule rule;
  windows::LastBlocks labels, gyro;
  std::optional<ThermalWindow> thermal;  // without a network: none
  int in_a_row = 0;                      // sound images without a gap between them, up to `frames`
};

LiveEstimator::LiveEstimator(const std::optional<model::Model>& model, network::Precision precision)
    : parts_(std::make_unique<Parts>(model, precision)) {}

LiveEstimator::~LiveEstimator() = default;
LiveEstimator::LiveEstimator(LiveEstimator&&) noexcept = default;
LiveEstimator& LiveEstimator::operator=(LiveEstimator&&) noexcept = default;

LiveEstimate LiveEstimator::add(const Measurement& measurement, HostTime arrived) {
  Parts& parts = *parts_;
  const TimedFrame& frame = measurement.frame;
  const LabelledSample& sample = measurement.sample;
  const std::span<const float> temp_c(frame.frame.temp_c);
  const bool sound_image = windows::is_sound_image(temp_c);
  const bool sound = (sound_image || frame.stands_in) && windows::is_sound_rate(sample.rate_commanded_dps) &&
                     windows::is_sound_rate(sample.rate_gyro_dps);
  parts.in_a_row = !sound_image ? 0 : gap_before(frame) ? 1 : std::min(parts.in_a_row + 1, parts.frames);
  parts.labels.push(sample.rate_commanded_dps);
  parts.gyro.push(sample.rate_gyro_dps);

  LiveEstimate row = row_of(sample, arrived);
  row.rate_commanded_dps = windows::mean_rate(parts.labels.all());
  row.rate_gyro_dps = windows::mean_rate(parts.gyro.all());
  row.counted = parts.rule.push(sound ? row.run : 0) && (frame.stands_in || parts.in_a_row == parts.frames);
  if (parts.thermal) {
    parts.thermal->push(temp_c);
    if (parts.in_a_row == parts.frames) parts.thermal->estimate(row);
  }
  return row;
}

}  // namespace thermorig::live
