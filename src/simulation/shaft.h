// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace thermorig::simulation {

/// An instant and where the shaft was.
struct ShaftMark {
  std::int64_t time_ns = 0;
  double angle_deg = 0.0;
};

/// Mean rate from one mark to the other.
double mean_rate_dps(const ShaftMark& from, const ShaftMark& to);

/// The shaft's recent past: its angle on a fixed grid of rig time, for the devices that turn with it.
class Shaft {
 public:
  static constexpr std::int64_t step_ns = 250'000;

  explicit Shaft(double angle_deg) : angles_deg_{angle_deg} {}

  /// The angle one step after the last one.
  void append(double angle_deg);

  /// Rig time up to which the angle is known.
  std::int64_t known_until_ns() const { return last_index() * step_ns; }

  /// Between grid points linear; before the start at rest. Not beyond known_until_ns(), and not older than
  /// the kept half second.
  double angle_deg(std::int64_t time_ns) const;

 private:
  static constexpr std::int64_t kept_steps = 2000;
  std::int64_t last_index() const { return first_index_ + static_cast<std::int64_t>(angles_deg_.size()) - 1; }

  std::vector<double> angles_deg_;
  std::int64_t first_index_ = 0;  // grid index of angles_deg_[0]
};

}  // namespace thermorig::simulation
