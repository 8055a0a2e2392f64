// SPDX-License-Identifier: MIT
#include "thermorig/labels/labeller.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace thermorig::labels {

namespace {
constexpr float coldest_c = -60.0F;
constexpr float hottest_c = 400.0F;
constexpr double rate_step_dps = 0.01;                           // telemetry counts centidegrees per second
constexpr double uniform_deviation = 0.5 / std::numbers::sqrt3;  // of a spread of width 1

std::uint32_t bit_if(Reason reason, bool holds) {
  return holds ? bit(reason) : 0U;
}

bool has_pixel_out_of_range(const ThermalFrame& frame) {
  unsigned within = 0;
  for (const float temp_c : frame.temp_c)  // counted without a branch, so it runs in vectors
    within += static_cast<unsigned>(temp_c >= coldest_c) & static_cast<unsigned>(temp_c <= hottest_c);
  return within < frame_pixels;
}

double uncertainty_dps(const CommandSpan& exposure, double length_s, float frame_uncertainty_s) {
  const double time_s = std::hypot(frame_uncertainty_s, exposure.time_uncertainty_s);
  const double slope_dps2 = length_s > 0.0 ? exposure.rate_change_dps / length_s : 0.0;
  return std::hypot(time_s * slope_dps2, rate_step_dps * uniform_deviation);
}
}  // namespace

Labeller::Labeller(LabelConfig config)
    : config_(config),
      command_(from_s(config.telemetry_gap_s), from_s(config.history_s)),
      gyro_(from_s(config.history_s)) {}

std::uint32_t Labeller::frame_reasons(const TimedFrame& frame) {
  return bit_if(Reason::camera_gap, frame.missing_before > 0) |
         bit_if(Reason::camera_not_fresh, frame.stale) | bit_if(Reason::sync_lost, frame.late) |
         bit_if(Reason::checksum, frame.resync_before) |
         bit_if(Reason::out_of_range, has_pixel_out_of_range(frame.frame));
}

void Labeller::add(const TimedFrame& frame) {
  assert(frame.exposure_begin <= frame.exposure_end);
  const std::uint32_t reasons = frame_reasons(frame);
  pending_.push_back({frame_count_, frame.stamp, frame.exposure_begin, frame.exposure_end, reasons});
  ++frame_count_;
}

bool Labeller::has_all(const PendingFrame& frame) const {
  return command_.reaches(frame.exposure_end) && gyro_.reaches(frame.exposure_end);
}

std::vector<LabelledSample> Labeller::take(HostTime now) {
  std::vector<LabelledSample> samples;
  const HostDuration wait = from_s(config_.wait_s);
  while (!pending_.empty() && (has_all(pending_.front()) || now - pending_.front().stamp.arrival >= wait)) {
    samples.push_back(label(pending_.front()));
    pending_.pop_front();
  }
  return samples;
}

std::vector<LabelledSample> Labeller::finish() {
  std::vector<LabelledSample> samples;
  for (const PendingFrame& frame : pending_) samples.push_back(label(frame));
  pending_.clear();
  return samples;
}

LabelledSample Labeller::label(const PendingFrame& frame) {
  LabelledSample sample;
  sample.frame_index = frame.index;
  sample.exposure_begin = frame.exposure_begin;
  sample.exposure_end = frame.exposure_end;
  sample.time = frame.exposure_end - (frame.exposure_end - frame.exposure_begin) / 4;
  sample.reason_bits = frame.reason_bits;
  label_command(sample, frame.stamp.uncertainty_s);
  label_gyro(sample);
  sample.valid = (sample.reason_bits & ~warning_bits) == 0;
  number_run(sample);
  return sample;
}

void Labeller::label_command(LabelledSample& sample, float frame_uncertainty_s) const {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const CommandSpan exposure = command_.over(sample.exposure_begin, sample.exposure_end);
  const CommandSpan settled =
      command_.over(sample.exposure_begin - from_s(config_.settle_s), sample.exposure_end);
  const double length_s = to_s(sample.exposure_end - sample.exposure_begin);
  const bool known = exposure.covered;
  sample.rate_label_dps = static_cast<float>(exposure.rate_mean_dps);
  sample.rate_label_min_dps = static_cast<float>(known ? exposure.rate_min_dps : unknown);
  sample.rate_label_max_dps = static_cast<float>(known ? exposure.rate_max_dps : unknown);
  sample.label_uncertainty_dps =
      static_cast<float>(known ? uncertainty_dps(exposure, length_s, frame_uncertainty_s) : unknown);
  sample.angle_label_deg = static_cast<float>(command_.angle_deg(sample.time));
  sample.leg = command_.leg(sample.time);
  sample.reason_bits |= exposure_reasons(exposure) | settle_reasons(settled);
  sample.reason_bits |= bit_if(Reason::outside_leg, sample.leg == 0);
}

std::uint32_t Labeller::exposure_reasons(const CommandSpan& exposure) const {
  const double limit_deg = 0.5 * config_.travel_deg - config_.stop_margin_deg;
  const bool beyond = exposure.angle_min_deg < -limit_deg || exposure.angle_max_deg > limit_deg;
  return bit_if(Reason::limit_hit, config_.travel_deg > 0.0 && beyond) |
         bit_if(Reason::reversal, exposure.rate_min_dps < 0.0 && exposure.rate_max_dps > 0.0) |
         bit_if(Reason::outside_leg, exposure.outside_leg) |
         bit_if(Reason::leg_change, exposure.several_legs);
}

std::uint32_t Labeller::settle_reasons(const CommandSpan& settled) const {
  const double spread_dps = settled.rate_max_dps - settled.rate_min_dps;
  return bit_if(Reason::servo_ramp, spread_dps > config_.rate_tolerance_dps) |
         bit_if(Reason::servo_lost, !settled.covered || !settled.able);
}

void Labeller::label_gyro(LabelledSample& sample) const {
  const GyroMean mean = gyro_.over(sample.exposure_begin, sample.exposure_end);
  const double expected = to_s(sample.exposure_end - sample.exposure_begin) * config_.gyro_rate_hz;
  const double needed = config_.gyro_gap_share * expected;
  constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();
  sample.rate_gyro_dps = static_cast<float>(mean.rate_dps);
  sample.gyro_count = static_cast<std::uint16_t>(std::min(mean.count, most));
  sample.reason_bits |= bit_if(Reason::gyro_gap, mean.count == 0 || static_cast<double>(mean.count) < needed);
}

void Labeller::number_run(LabelledSample& sample) {
  if (sample.valid && sample.leg != run_leg_) ++run_;
  run_leg_ = sample.valid ? sample.leg : std::uint16_t{0};
  if (sample.valid) sample.run = run_;
}

}  // namespace thermorig::labels
