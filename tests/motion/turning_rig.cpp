// SPDX-License-Identifier: MIT
#include "turning_rig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <random>

#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "thermorig/simulation/firmware.h"

namespace thermorig::motion {
namespace {

constexpr double step_s = 0.01;
constexpr double rest_begin_s = 1.4;  // the servo, armed, has gone where it should be
constexpr double rest_end_s = 2.0;    // the first leg begins

pipeline::Streams drive(simulation::VirtualRig& rig, const RigProfile& profile, const std::vector<Leg>& legs,
                        double duration_s) {
  pipeline::Pipeline pipeline(profile);
  const auto script = tests::servo_script(profile.servo, legs);
  auto next = script.begin();
  for (int step = 0; step * step_s < duration_s; ++step) {
    const HostTime now(from_s(step * step_s));
    for (; next != script.end() && next->time_s <= step * step_s; ++next)
      rig.send(Device::servo, next->bytes, now);
    if (step % 4 == 0) rig.send(Device::servo, wire::refresh_bytes(), now);
    for (const Chunk& chunk : rig.advance(now + from_s(step_s)))
      pipeline.feed(chunk.device, chunk.bytes, chunk.arrived);
  }
  pipeline.finish();
  return pipeline.take_streams();
}

/// The half that a camera of that seed exposes last in a full-fresh frame: a half-fresh one's second frame
/// shows the same.
unsigned newer_half_of(simulation::VirtualRigConfig config) {
  config.half_fresh = true;
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  const auto frames = drive(rig, config.profile, {}, 1.0).frames;
  return labels::Freshness{frames.at(1).fresh_even, frames.at(1).fresh_odd}.odd_fresh() ? 1U : 0U;
}

void time_frames(std::vector<TimedFrame>& frames, const std::vector<simulation::SentMessage>& sent,
                 bool half_fresh, unsigned newer) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    TimedFrame& frame = frames[i];
    const labels::Freshness fresh{frame.fresh_even, frame.fresh_odd};
    frame.stale = frame.late = false;
    frame.exposure_begin = sent[i].exposure_begin;
    frame.exposure_end = sent[i].exposure_end;
    frame.stamp.time = frame.exposure_end;
    const HostTime middle = frame.exposure_begin + (frame.exposure_end - frame.exposure_begin) / 2;
    if (half_fresh) newer = fresh.odd_fresh() ? 1U : 0U;
    frame.half[newer] = {middle, frame.exposure_end};
    frame.half[newer ^ 1U] = {frame.exposure_begin, middle};
  }
  const HostTime begin(
      from_s(rest_begin_s));  // in the very first frame which half was new is not known either
  std::erase_if(frames, [begin](const TimedFrame& frame) { return frame.exposure_begin < begin; });
}

/// Regression of readings on true rates.
double slope_of(const std::vector<TimedGyro>& gyro, const std::vector<simulation::SentMessage>& sent) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto n = static_cast<double>(gyro.size());
  for (std::size_t i = 0; i < gyro.size(); ++i) {
    const auto rate_dps = static_cast<double>(gyro[i].rate_dps);
    x += sent[i].mean_rate_dps / n;
    y += rate_dps / n;
    xx += sent[i].mean_rate_dps * sent[i].mean_rate_dps / n;
    xy += sent[i].mean_rate_dps * rate_dps / n;
  }
  return xx - x * x > 0.0 ? (xy - x * y) / (xx - x * x) : 1.0;
}

}  // namespace

Turning turn(const simulation::VirtualRigConfig& config, const std::vector<Leg>& legs, double duration_s) {
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  rig.keep_truth(true);
  pipeline::Streams streams = drive(rig, config.profile, legs, duration_s);
  Turning turning{.frames = std::move(streams.frames), .gyro = std::move(streams.gyro), .errors = {}};
  turning.frames.resize(std::min(turning.frames.size(), rig.sent_frames().size()));
  turning.gyro.resize(std::min(turning.gyro.size(), rig.sent_gyro().size()));
  turning.newer_half = newer_half_of(config);
  time_frames(turning.frames, rig.sent_frames(), config.half_fresh, turning.newer_half);
  for (std::size_t i = 0; i < turning.gyro.size(); ++i) {
    const simulation::SentMessage& sent = rig.sent_gyro()[i];
    turning.gyro[i].stamp.time = sent.exposure_begin + (sent.exposure_end - sent.exposure_begin) / 2;
  }
  turning.true_scale = slope_of(turning.gyro, rig.sent_gyro());
  double sum_dps = 0.0;
  double count = 0.0;
  for (const TimedGyro& sample : turning.gyro) {
    const double time_s = to_s(sample.stamp.time.time_since_epoch());
    if (time_s < rest_begin_s || time_s > rest_end_s) continue;
    sum_dps += static_cast<double>(sample.rate_dps);
    count += 1.0;
  }
  if (count > 0.0) turning.errors.bias_dps = Estimate{sum_dps / count, 0.01};
  return turning;
}

std::vector<Leg> back_and_forth(double rate_dps, double leg_s, double until_s) {
  std::vector<Leg> legs;
  double sign = 1.0;
  for (double begin_s = 2.0; begin_s + leg_s <= until_s; begin_s += leg_s + 0.5, sign = -sign)
    legs.push_back({begin_s, leg_s, sign * rate_dps});
  return legs;
}

void shift_frames(Turning& turning, double by_s) {
  const HostDuration by = from_s(by_s);
  for (TimedFrame& frame : turning.frames) {
    for (HalfExposure& half : frame.half) half = {half.begin + by, half.end + by};
    frame.exposure_begin += by;
    frame.exposure_end += by;
    frame.stamp.time += by;
  }
}

void make_wall(Turning& turning, float noise_k) {
  std::mt19937 random(1);
  for (TimedFrame& frame : turning.frames)
    for (float& temp_c : frame.frame.temp_c) {
      float sum = -6.0F;  // twelve uniform draws have a variance of one
      for (int i = 0; i < 12; ++i) sum += static_cast<float>(random()) * 0x1p-32F;
      temp_c = 22.0F + noise_k * sum;
    }
}

std::string environment_of(unsigned seed) {
  constexpr std::array<const char*, 4> names{"laboratory", "garden", "dining", "kitchen"};
  return names[seed % names.size()];
}

}  // namespace thermorig::motion
