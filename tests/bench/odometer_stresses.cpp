// SPDX-License-Identifier: MIT
#include "odometer_stresses.h"

#include <cmath>
#include <memory>
#include <random>

namespace thermorig::bench {
namespace {

constexpr double harm_begin_s = 150.0, harm_end_s = 180.0;
constexpr float sensor_noise_k = 0.66F;

bool is_harmed(double seconds) {
  return seconds > harm_begin_s && seconds <= harm_end_s;
}

/// As much beside the camera's own as makes it twice that.
Disturbance twice_the_noise() {
  const auto random = std::make_shared<std::mt19937>(1U);
  return [random](double, Measurement& measurement) {
    std::normal_distribution<float> noise(0.0F, std::sqrt(3.0F) * sensor_noise_k);
    for (float& temp_c : measurement.frame.frame.temp_c) temp_c += noise(*random);
  };
}

Disturbance scaled_gyro(float scale) {
  return [scale](double, Measurement& measurement) {
    for (TimedGyro& sample : measurement.gyro) {
      sample.rate_dps *= scale;
      for (float& axis : sample.reading.rate_dps) axis *= scale;
    }
  };
}

Disturbance stepped_bias(float step_dps) {
  return [step_dps](double seconds, Measurement& measurement) {
    if (seconds <= harm_begin_s) return;
    for (TimedGyro& sample : measurement.gyro) sample.rate_dps += step_dps;
  };
}

Disturbance frozen_gyro() {
  const auto last = std::make_shared<TimedGyro>();
  return [last](double seconds, Measurement& measurement) {
    for (TimedGyro& sample : measurement.gyro) {
      if (is_harmed(seconds)) {
        sample.rate_dps = last->rate_dps;
        sample.reading = last->reading;
      } else {
        *last = sample;
      }
    }
  };
}

/// Something of one temperature before the lens.
Disturbance covered_lens() {
  const auto random = std::make_shared<std::mt19937>(2U);
  return [random](double seconds, Measurement& measurement) {
    if (!is_harmed(seconds)) return;
    std::normal_distribution<float> noise(31.0F, sensor_noise_k);
    for (float& temp_c : measurement.frame.frame.temp_c) temp_c = noise(*random);
  };
}

/// The camera's images stay as they are.
Disturbance frozen_camera() {
  return [](double seconds, Measurement& measurement) {
    if (!is_harmed(seconds)) return;
    measurement.frame.fresh_even = measurement.frame.fresh_odd = 0;
    measurement.frame.stale = true;
  };
}

/// The halves are taken for those of a period before.
Disturbance late_exposures(double period_s) {
  return [period_s](double seconds, Measurement& measurement) {
    if (!is_harmed(seconds)) return;
    for (HalfExposure& half : measurement.frame.half) {
      half.begin -= from_s(period_s);
      half.end -= from_s(period_s);
    }
  };
}

JudgedRun all_along(Disturbance disturb) {
  return {.disturb = std::move(disturb), .harm_begin_s = {}, .harm_end_s = {}};
}

JudgedRun for_a_while(Disturbance disturb) {
  return {.disturb = std::move(disturb), .harm_begin_s = harm_begin_s, .harm_end_s = harm_end_s};
}

JudgedRun frozen_for_a_while() {
  JudgedRun run = for_a_while(frozen_gyro());
  run.loses_turns = true;
  return run;
}

}  // namespace

std::vector<Stress> odometer_stresses() {
  const auto world = [](const std::string& name, const std::string& knobs, double worst_deg) {
    return Stress{.name = name, .world = "honest," + knobs, .run = {}, .worst_deg = worst_deg};
  };
  const auto rows_in = [&](const std::string& name, const std::string& knobs, odometer::RowOrder rows) {
    Stress stress = world(name, knobs, 2.0);
    stress.run.tells_rows = true;
    stress.rows = rows;
    return stress;
  };
  return {{.name = "twice the camera's noise", .run = all_along(twice_the_noise()), .worst_deg = 1.5},
          world("contrast x 0.5", "scene.contrast=0.5", 1.5),
          {.name = "110-degree lens", .field_of_view_deg = 110.0, .run = {}, .worst_deg = 1.5},
          {.name = "10 % of frames lost",
           .run = {.lost_one_of = 10, .harm_begin_s = {}, .harm_end_s = {}},
           .worst_deg = 1.5},
          world("10 % of chess halves lost by the bridge", "camera.lost_subpages=0.1", 1.5),
          {.name = "gyro scale +5 %", .run = all_along(scaled_gyro(1.05F)), .worst_deg = 1.5},
          rows_in("rows all at once", "camera.rolling_rows=0", odometer::RowOrder::at_once),
          rows_in("rows one after the other", "camera.rolling_rows=1", odometer::RowOrder::first_to_last),
          rows_in("rows from the last on", "camera.rolling_rows=-1", odometer::RowOrder::last_to_first),
          world("a person at 20 deg/s", "scene.person_dps=20", 3.0),
          world("camera warms by 2 K", "camera.warm_up_k=2", 3.0),
          world("gyro warms by 10 K", "gyro.self_heating_k=10,gyro.bias_per_k_dps=0.1", 3.0),
          world("pitch of a pixel +1 %", "camera.pitch_error=0.01", 3.0),
          world("tilt 3 deg, roll 2 deg", "camera.tilt_deg=3,camera.roll_deg=2", 3.0),
          {.name = "bias step of 1 deg/s", .run = all_along(stepped_bias(1.0F)), .worst_deg = 3.0},
          {.name = "frozen gyro, 30 s", .run = frozen_for_a_while(), .worst_deg = 3.0},
          {.name = "covered lens, 30 s", .run = for_a_while(covered_lens()), .worst_deg = 3.0},
          {.name = "frozen camera, 30 s", .run = for_a_while(frozen_camera()), .worst_deg = 3.0},
          {.name = "exposures a period early, 30 s",
           .run = for_a_while(late_exposures(0.125)),
           .worst_deg = 3.0}};
}

}  // namespace thermorig::bench
