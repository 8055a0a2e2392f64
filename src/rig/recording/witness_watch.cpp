// SPDX-License-Identifier: MIT
#include "witness_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/fit/shaft/witnesses.h"

namespace thermorig::rig {

namespace {
constexpr double period_s = 2.5;  // of legs, from one comparison to the next
constexpr double longest_s = 60.0;
constexpr double longest_step_s = 0.1;         // a hole in telemetry is no time in a leg
constexpr std::size_t most_at_rest = 100'000;  // samples before the first leg: minutes
}  // namespace

void WitnessWatch::gyro(const TimedGyro& sample) {
  if (done_) return;
  if (gyro_.size() >= most_at_rest) {
    if (in_legs_s_ > 0.0) return stop();  // its legs wait for something: memory stays bounded
    gyro_.erase(gyro_.begin(), gyro_.begin() + most_at_rest / 2);
  }
  gyro_.push_back(sample);
}

std::optional<std::string> WitnessWatch::servo(const TimedServo& state) {
  if (done_) return std::nullopt;
  if (in_legs_s_ == 0.0 && servo_.size() >= most_at_rest)
    servo_.erase(servo_.begin(), servo_.begin() + most_at_rest / 2);
  if (!servo_.empty() && state.state.leg != 0)
    in_legs_s_ += std::clamp(to_s(state.stamp.time - servo_.back().stamp.time), 0.0, longest_step_s);
  servo_.push_back(state);
  if (in_legs_s_ - compared_at_s_ < period_s) return std::nullopt;
  compared_at_s_ = in_legs_s_;
  auto sentence = compare();
  if (sentence || in_legs_s_ > longest_s) stop();
  return sentence;
}

std::optional<std::string> WitnessWatch::compare() {
  if (gyro_.empty()) return std::nullopt;
  // No leg ends later than the gyro is known: its samples may come a little after telemetry.
  const auto later = std::partition_point(servo_.begin(), servo_.end(), [&](const TimedServo& state) {
    return state.stamp.time < gyro_.back().stamp.time;
  });
  const std::span<const TimedServo> servo(servo_.begin(), later);
  const GyroErrors errors = fit::fit_gyro_errors(gyro_, servo, profile_.gyro);
  const Witnesses witnesses = fit::compare_witnesses(servo, gyro_, errors, profile_);
  if (witnesses.cause.empty()) return std::nullopt;
  return fmt::format("{}; try: {}", witnesses.cause, witnesses.remedy);
}

void WitnessWatch::stop() {
  done_ = true;
  gyro_ = {};
  servo_ = {};
}

}  // namespace thermorig::rig
