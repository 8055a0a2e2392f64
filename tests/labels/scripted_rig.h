// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/labels/labeller.h"

namespace thermorig::labels {

inline HostTime at_s(double seconds) {
  return HostTime(from_s(seconds));
}
inline double seconds(HostTime time) {
  return to_s(time.time_since_epoch());
}

/// A rig by hand: whole runs of telemetry, gyro samples and half-fresh frames from functions of time, without
/// bytes. Defaults: armed in the middle of the travel, steady at 100 deg/s in leg 1.
struct ScriptedRig {
  LabelConfig config;
  std::function<double(double)> rate_dps = [](double) { return 100.0; };
  std::function<double(double)> angle_deg = [](double) { return 0.0; };
  std::function<int(double)> leg = [](double) { return 1; };
  std::function<ServoMotion(double)> motion = [](double) { return ServoMotion::steady; };
  std::function<ServoFault(double)> fault = [](double) { return ServoFault::none; };
  std::function<double(double)> gyro_dps = [](double) { return 101.5; };
  std::function<bool(double)> telemetry_comes = [](double) { return true; };
  std::function<bool(double)> gyro_comes = [](double) { return true; };
  std::function<void(TimedFrame&, int)> spoil = [](TimedFrame&, int) {};
  double frame_period_s = 0.125;
  double telemetry_s = 0.01;
  double gyro_s = 0.005;
  double offset_s = 0.0013;  // of gyro and telemetry against the frames, so that no times coincide
  double uncertainty_s = 0.0;

  TimedServo servo_at(double t) const {
    TimedServo servo;
    servo.stamp = {.time = at_s(t), .arrival = at_s(t), .uncertainty_s = static_cast<float>(uncertainty_s)};
    servo.mcu_time_us = std::llround(t * 1e6);
    servo.state.rate_dps = rate_dps(t);
    servo.state.angle_deg = angle_deg(t);
    servo.state.leg = static_cast<std::uint16_t>(leg(t));
    servo.state.motion = motion(t);
    servo.state.fault = fault(t);
    return servo;
  }
  TimedGyro gyro_at(double t) const {
    TimedGyro gyro;
    gyro.stamp = {.time = at_s(t), .arrival = at_s(t)};
    gyro.rate_dps = static_cast<float>(gyro_dps(t));
    return gyro;
  }
  /// The frame whose newest exposure ends at `t`.
  TimedFrame frame_at(double t, int index) const {
    TimedFrame frame;
    frame.frame.temp_c.fill(20.0F);
    frame.stamp = {.time = at_s(t), .arrival = at_s(t), .uncertainty_s = static_cast<float>(uncertainty_s)};
    frame.exposure_end = frame.stamp.time;
    frame.exposure_begin = frame.exposure_end - from_s(2 * frame_period_s);
    spoil(frame, index);
    return frame;
  }

  /// Everything from 0 to `duration_s`, in time order; frame i ends its exposure at (i + 1) frame periods.
  std::vector<LabelledSample> run(double duration_s) const {
    Labeller labeller(config);
    std::vector<LabelledSample> samples;
    const auto take = [&](std::vector<LabelledSample> more) {
      samples.insert(samples.end(), more.begin(), more.end());
    };
    double servo_t = offset_s;
    double gyro_t = offset_s;
    int frame = 0;
    const auto frame_t = [&] { return frame_period_s * (frame + 1); };
    while (std::min({servo_t, gyro_t, frame_t()}) <= duration_s) {
      const double t = std::min({servo_t, gyro_t, frame_t()});
      if (t == servo_t) {
        if (telemetry_comes(t)) labeller.add(servo_at(t));
        servo_t += telemetry_s;
      } else if (t == gyro_t) {
        if (gyro_comes(t)) labeller.add(gyro_at(t));
        gyro_t += gyro_s;
      } else {
        labeller.add(frame_at(t, frame));
        ++frame;
      }
      take(labeller.take(at_s(t)));
    }
    take(labeller.finish());
    return samples;
  }
};

inline bool has(const LabelledSample& sample, Reason reason) {
  return (sample.reason_bits & bit(reason)) != 0;
}

}  // namespace thermorig::labels
