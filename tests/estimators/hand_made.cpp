// SPDX-License-Identifier: MIT
#include "hand_made.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "simulation/random.h"
#include "support/at_s.h"

namespace thermorig::estimators {

namespace {

constexpr double frame_period_s = 0.125, gyro_period_s = 0.005, telemetry_period_s = 0.01;

TimedFrame frame_at(double end_s, double exposure_s, int index) {
  TimedFrame frame;
  frame.exposure_begin = at_s(end_s - exposure_s);
  frame.exposure_end = frame.stamp.time = at_s(end_s);
  frame.fresh_even = 384;
  frame.frame.sensor_temp_c = 30.0F;
  for (std::size_t p = 0; p < frame_pixels; ++p)
    frame.frame.temp_c[p] = 20.0F + static_cast<float>((static_cast<std::size_t>(index) * 7 + p) % 50);
  return frame;
}

TimedGyro sample_at(double time_s, float rate_dps) {
  TimedGyro sample;
  sample.stamp.time = at_s(time_s);
  sample.rate_dps = rate_dps;
  sample.reading.rate_dps = {0.0F, 0.0F, rate_dps};
  return sample;
}

TimedServo state_at(double time_s, bool is_told_to_move) {
  TimedServo state;
  state.stamp.time = at_s(time_s);
  state.state.motion = is_told_to_move ? ServoMotion::steady : ServoMotion::holding;
  state.state.rate_dps = is_told_to_move ? 100.0 : 0.0;
  return state;
}

template <typename Sample>
auto first_after(HostTime time, const std::vector<Sample>& samples) {
  return std::partition_point(samples.begin(), samples.end(),
                              [time](const Sample& sample) { return sample.stamp.time <= time; });
}

/// Those after one time, up to another.
template <typename Sample>
std::vector<Sample> between(HostTime after, HostTime until, const std::vector<Sample>& samples) {
  return {first_after(after, samples), first_after(until, samples)};
}

float mean_dps(const std::vector<TimedGyro>& samples) {
  if (samples.empty()) return std::numeric_limits<float>::quiet_NaN();
  double sum_dps = 0.0;
  for (const TimedGyro& sample : samples) sum_dps += double{sample.rate_dps};
  return static_cast<float>(sum_dps / static_cast<double>(samples.size()));
}

bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}
bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace

std::vector<Measurement> measurements_of(const HandMadeRig& rig) {
  simulation::Random random(1, "noise");
  std::vector<TimedGyro> gyro;
  for (int i = 0; i * gyro_period_s < rig.duration_s; ++i) {
    const double time_s = (i + 0.5) * gyro_period_s;
    const auto noise_dps = static_cast<float>(random.normal(rig.noise_dps));
    if (rig.has_gyro(time_s)) gyro.push_back(sample_at(time_s, rig.gyro_dps(time_s) + noise_dps));
  }
  std::vector<TimedServo> servo;
  for (int i = 0; rig.has_servo && i * telemetry_period_s < rig.duration_s; ++i)
    servo.push_back(state_at(i * telemetry_period_s, rig.is_told_to_move(i * telemetry_period_s)));
  std::vector<Measurement> measurements;
  HostTime before = at_s(-1.0);
  for (int i = 0; 0.25 + i * frame_period_s <= rig.duration_s; ++i) {
    Measurement measurement;
    measurement.frame = frame_at(0.25 + i * frame_period_s, rig.exposure_s, i);
    const HostTime begin = measurement.frame.exposure_begin, end = measurement.frame.exposure_end;
    measurement.sample.frame_index = static_cast<std::uint32_t>(i);
    measurement.sample.rate_gyro_dps = mean_dps(between(begin, end, gyro));
    measurement.gyro = between(before, end, gyro);
    measurement.servo = between(before, end, servo);
    measurements.push_back(std::move(measurement));
    before = end;
  }
  return measurements;
}

HandMadeRig rest_and_speed(double rest_s, double speed_dps, double bias_dps) {
  HandMadeRig rig;
  rig.is_told_to_move = [=](double time_s) { return time_s >= rest_s; };
  rig.gyro_dps = [=](double time_s) {
    return static_cast<float>(bias_dps + (time_s >= rest_s ? speed_dps : 0.0));
  };
  return rig;
}

GyroProfile exact_gyro() {
  GyroProfile gyro;
  gyro.scale_uncertainty = 0.0;
  gyro.bias_uncertainty_dps = 0.0;
  gyro.link.latency_uncertainty_s = 0.0;
  return gyro;
}

Bank bank_of(const std::string& name, const GyroProfile& gyro, const std::optional<model::Model>& model) {
  RigProfile profile;
  profile.gyro = gyro;
  return Bank(std::vector{name}, model, profile);
}

std::vector<RateEstimate> estimates_of(Bank& bank, const std::vector<Measurement>& measurements) {
  std::vector<RateEstimate> estimates;
  for (const Measurement& measurement : measurements) estimates.push_back(bank.add(measurement).front());
  return estimates;
}

std::vector<RateEstimate> estimates_of(const std::string& name, const GyroProfile& gyro,
                                       const std::vector<Measurement>& measurements) {
  Bank bank = bank_of(name, gyro);
  return estimates_of(bank, measurements);
}

std::vector<std::vector<RateEstimate>> all_estimates_of(Bank& bank,
                                                        const std::vector<Measurement>& measurements) {
  std::vector<std::vector<RateEstimate>> all;
  for (const Measurement& measurement : measurements) {
    const auto estimates = bank.add(measurement);
    all.emplace_back(estimates.begin(), estimates.end());
  }
  return all;
}

model::Model untrained_model(const network::Shape& shape) {
  model::Model model;
  model.weights = network::initial_weights(shape, 4);
  model.scaling = {.label_scale_dps = 150.0F, .temp_mean_c = 30.0F, .temp_deviation_c = 5.0F};
  return model;
}

model::Model untrained_model_with_sigma() {
  model::Model model = untrained_model();
  model.scaling = network::scaling_by_window();
  model.scaling.gate_states_sigma = true;
  return model;
}

bool are_same(const RateEstimate& a, const RateEstimate& b) {
  return same(a.rate_dps, b.rate_dps) && same(a.rate_sigma_dps, b.rate_sigma_dps) &&
         same(a.angle_deg, b.angle_deg) && same(a.angle_sigma_deg, b.angle_sigma_deg) && a.state == b.state &&
         a.reason == b.reason &&
         std::equal(a.values.begin(), a.values.end(), b.values.begin(),
                    [](float one, float other) { return same(one, other); });
}

bool are_same(std::span<const RateEstimate> a, std::span<const RateEstimate> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const RateEstimate& one, const RateEstimate& other) { return are_same(one, other); });
}

}  // namespace thermorig::estimators
