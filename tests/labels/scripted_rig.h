// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/pipeline/labels/labeller.h"

namespace thermorig::labels {

inline HostTime at_s(double seconds) {
  return HostTime(from_s(seconds));
}
inline double seconds(HostTime time) {
  return to_s(time.time_since_epoch());
}

/// A rig by hand: whole runs of telemetry, gyro samples and half-fresh frames from functions of time, without
/// bytes. Defaults: armed, steady at 100 deg/s in leg 1; the angle is the integral of the speed from the low
/// end of the travel, and every 20 ms a pulse starts that shows it.
struct ScriptedRig {
  LabelConfig config;
  std::function<double(double)> rate_dps = [](double) { return 100.0; };
  std::function<double(double)> angle_deg;  // none: the integral of the speed
  std::function<int(double)> leg = [](double) { return 1; };
  std::function<ServoMotion(double)> motion = [](double) { return ServoMotion::steady; };
  std::function<ServoFault(double)> fault = [](double) { return ServoFault::none; };
  std::function<double(double)> measured_deg;  // by a sensor on the shaft; none: nothing measures it
  std::function<double(double)> gyro_dps = [](double) { return 101.5; };
  std::function<bool(double)> telemetry_comes = [](double) { return true; };
  std::function<bool(double)> gyro_comes = [](double) { return true; };
  std::function<void(TimedFrame&, int)> spoil = [](TimedFrame&, int) {};
  double frame_period_s = 0.125;
  double telemetry_s = 0.01;
  double gyro_s = 0.005;
  double offset_s = 0.0013;  // of gyro and telemetry against the frames, so that no times coincide
  double uncertainty_s = 0.0;

  double angle_at(double t) const {
    if (angle_deg) return angle_deg(t);
    double angle = -900.0;
    constexpr double step_s = 0.001;
    for (double from = 0.0; from < t; from += step_s) {
      const double length = std::min(step_s, t - from);
      angle += length * rate_dps(from + 0.5 * length);
    }
    return angle;
  }
  /// Of the pulse that was started last; the firmware takes the angle a millisecond before it starts one.
  double pulse_us_at(double t) const {
    const double start = std::floor((t - offset_s) / 0.02 + 1e-6) * 0.02 + offset_s;
    const double half_us = (config.servo.pulse_max_us - config.servo.pulse_min_us) / 2.0;
    const double part = angle_at(std::max(0.0, start - 0.001)) / (config.servo.travel_deg / 2.0);
    return 1500.0 + half_us * part;
  }

  TimedServo servo_at(double t) const {
    TimedServo servo;
    servo.stamp = {.time = at_s(t), .arrival = at_s(t), .uncertainty_s = static_cast<float>(uncertainty_s)};
    servo.mcu_time_us = std::llround(t * 1e6);
    servo.state.rate_dps = rate_dps(t);
    servo.state.angle_deg = angle_at(t);
    servo.state.pulse_us = static_cast<float>(pulse_us_at(t));
    servo.state.leg = static_cast<std::uint16_t>(leg(t));
    servo.state.motion = motion(t);
    servo.state.fault = fault(t);
    return servo;
  }
  TimedShaft shaft_at(double t) const {
    TimedShaft shaft;
    shaft.stamp = {.time = at_s(t), .arrival = at_s(t)};
    shaft.reading.uncertainty_deg = 0.05F;
    shaft.angle_deg = measured_deg(t);
    return shaft;
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
    const HostTime middle = frame.exposure_end - from_s(frame_period_s);
    const std::size_t newest = index % 2 == 0 ? 0 : 1;
    frame.half[newest] = {middle, frame.exposure_end};
    frame.half[1 - newest] = {frame.exposure_begin, middle};
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
        if (measured_deg) labeller.add(shaft_at(t));
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
