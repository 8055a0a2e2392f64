// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thermorig::study {

// Estimators that are asked for by name: those of the network, and what it is fed with beside images.
inline constexpr std::string_view thermal_name = "cnn-thermal", fusion_name = "cnn-fusion",
                                  kalman_fusion_name = "cnn-fusion-kalman", gyro_name = "gyro",
                                  kalman_name = "gyro-kalman";

/// Who is compared, by the names of the table (estimators/table.h): those of the network, then all that need
/// none.
std::span<const std::string> all_estimators();

/// Those that need no training.
std::span<const std::string> baselines();

/// Index into all_estimators(). There must be one of that name.
std::size_t place_of(std::string_view name);

/// A value for each of all_estimators().
template <typename Value>
class PerEstimator {
 public:
  PerEstimator() : PerEstimator(Value{}) {}
  explicit PerEstimator(const Value& value) : values_(all_estimators().size(), value) {}

  Value& operator[](std::string_view name) { return values_[place_of(name)]; }
  const Value& operator[](std::string_view name) const { return values_[place_of(name)]; }
  const std::vector<Value>& values() const { return values_; }  // in order

 private:
  std::vector<Value> values_;
};

}  // namespace thermorig::study
