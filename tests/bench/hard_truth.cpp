// SPDX-License-Identifier: MIT
#include "hard_truth.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/replay.h"
#include "timing_truth.h"

namespace thermorig::bench {
namespace {

constexpr double rounding_s = 1e-6;
constexpr HostDuration pulse = std::chrono::milliseconds(20);
// A second of the usual gyro. Sample by sample, a gyro with a filter seems to have a lower scale than it has:
// it rounds what begins and ends (0.13 % at 20 Hz).
constexpr std::size_t summed_samples = 200;

/// Three standard deviations of the constant that was subtracted from the stream's times.
double latency_slack_s(const session::Session& session, Device device) {
  return 3.0 * session.sync.clock[device].latency_uncertainty_s;
}

HostTime truth_of(const TimedServo& servo, const simulation::VirtualRig& rig) {
  return rig.when_servo_clock_read(ServoTime(std::chrono::microseconds(servo.mcu_time_us)));
}

/// Of the shaft's true means over 20 ms within the exposure, by the intervals of the gyro's samples.
double spread_dps(const simulation::SentMessage& frame, const std::vector<simulation::SentMessage>& gyro) {
  const auto begins_before = [](const auto& sample, HostTime time) { return sample.exposure_begin < time; };
  auto last = std::lower_bound(gyro.begin(), gyro.end(), frame.exposure_begin, begins_before);
  RunningStatistics means;
  for (auto first = last; last != gyro.end() && last->exposure_end <= frame.exposure_end; ++last) {
    if (last->exposure_end - first->exposure_begin < pulse - pulse / 20) continue;
    double sum_dps = 0.0;
    for (auto one = first; one <= last; ++one) sum_dps += one->mean_rate_dps;
    means.add(sum_dps / static_cast<double>(last - first + 1));
    ++first;
  }
  return means.count() > 0 ? std::sqrt(means.variance()) : 0.0;
}

/// Whatever it is labelled: it shows what the one before did, or the shaft jerks meanwhile by more than
/// a steady speed may (docs/recording_format.md, V2).
bool is_useless(const simulation::SentMessage& frame, const simulation::SentMessage* before,
                double commanded_dps, const simulation::VirtualRig& rig) {
  const bool repeats = before != nullptr && before->exposure_end == frame.exposure_end;
  return repeats || spread_dps(frame, rig.sent_gyro()) > std::max(1.0, 0.02 * std::abs(commanded_dps));
}

void add(const Stamp& stamp, HostTime truth, double slack_s, TimeErrors& errors) {
  errors.errors_s.push_back(to_s(stamp.time - truth));
  errors.widths_s.push_back(double{stamp.earlier_s} + double{stamp.later_s});
  errors.outside += is_outside(stamp, truth, slack_s);
}

}  // namespace

bool is_outside(const Stamp& stamp, HostTime truth, double more_s) {
  const double later_s = to_s(truth - stamp.time);
  return later_s > static_cast<double>(stamp.later_s) + more_s + rounding_s ||
         -later_s > static_cast<double>(stamp.earlier_s) + more_s + rounding_s;
}

LabelErrors label_errors(const session::Session& session, const simulation::VirtualRig& rig) {
  const auto sent = sent_of(session.frames, rig.sent_frames());
  LabelErrors errors;
  const simulation::SentMessage* before = nullptr;
  for (const LabelledSample& sample : session.samples) {
    const simulation::SentMessage* truth = sent.at(sample.frame_index);
    const simulation::SentMessage* last = std::exchange(before, truth);
    if (truth == nullptr || sample.leg == 0) continue;
    ++errors.frames;
    const bool useless = is_useless(*truth, last, static_cast<double>(sample.rate_commanded_dps), rig);
    errors.useless += useless;
    errors.rejected_useless += useless && !sample.valid;
    if (!sample.valid) continue;
    errors.shaft_dps.push_back(static_cast<double>(sample.rate_shaft_dps) - truth->mean_rate_dps);
    errors.uncertainty_dps.push_back(static_cast<double>(sample.rate_shaft_uncertainty_dps));
    errors.commanded_dps.push_back(static_cast<double>(sample.rate_commanded_dps) - truth->mean_rate_dps);
    errors.commanded_uncertainty_dps.push_back(double{sample.rate_commanded_uncertainty_dps});
    errors.corrected_dps.push_back(static_cast<double>(sample.rate_corrected_dps) - truth->mean_rate_dps);
    errors.corrected_uncertainty_dps.push_back(double{sample.rate_corrected_uncertainty_dps});
  }
  return errors;
}

std::optional<double> true_gyro_scale(const session::Session& session, const simulation::VirtualRig& rig) {
  const auto sent = sent_of(session.gyro, rig.sent_gyro());
  double count = 0.0, of_true = 0.0, of_shown = 0.0, squares = 0.0, products = 0.0;
  for (std::size_t begin = 0; begin + summed_samples <= sent.size(); begin += summed_samples) {
    double true_dps = 0.0, shown_dps = 0.0;
    bool is_whole = true;
    for (std::size_t i = begin; i < begin + summed_samples; ++i) {
      is_whole = is_whole && sent[i] != nullptr;
      true_dps += is_whole ? sent[i]->mean_rate_dps : 0.0;
      shown_dps += static_cast<double>(session.gyro[i].rate_dps);
    }
    if (!is_whole) continue;
    count += 1.0;
    of_true += true_dps;
    of_shown += shown_dps;
    squares += true_dps * true_dps;
    products += true_dps * shown_dps;
  }
  const double spread = count * squares - of_true * of_true;
  if (!(spread > 0.0)) return std::nullopt;
  return (count * products - of_true * of_shown) / spread;
}

PerDevice<TimeErrors> time_errors(const session::Session& session, const simulation::VirtualRig& rig) {
  PerDevice<TimeErrors> errors;
  const auto frames = sent_of(session.frames, rig.sent_frames());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const TimedFrame& frame = session.frames[i];
    if (frames[i] == nullptr || frame.late || frame.stale) continue;
    add(frame.stamp, instant_of(*frames[i], Device::camera), latency_slack_s(session, Device::camera),
        errors[Device::camera]);
  }
  const auto gyro = sent_of(session.gyro, rig.sent_gyro());
  for (std::size_t i = 0; i < gyro.size(); ++i)
    if (gyro[i] != nullptr)
      add(session.gyro[i].stamp, instant_of(*gyro[i], Device::gyro), latency_slack_s(session, Device::gyro),
          errors[Device::gyro]);
  for (const TimedServo& servo : session.servo)
    add(servo.stamp, truth_of(servo, rig), latency_slack_s(session, Device::servo), errors[Device::servo]);
  return errors;
}

LiveServoTimes live_servo_times(const session::Session& session, const simulation::VirtualRig& rig) {
  LiveServoTimes times;
  pipeline::CausalReplay replay(session.raw);
  while (const auto moment = replay.next())
    for (const TimedServo& servo : moment->streams.servo)
      add(servo.stamp, truth_of(servo, rig), latency_slack_s(session, Device::servo), times.errors);
  times.median_width_s = median(times.errors.widths_s);
  return times;
}

}  // namespace thermorig::bench
