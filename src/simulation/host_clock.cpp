// SPDX-License-Identifier: MIT
#include "host_clock.h"

#include <algorithm>
#include <cmath>

namespace thermorig::simulation {
namespace {

constexpr double slewed_ns = 120e9;  // from the begin of each cycle
constexpr double cycle_ns = 240e9;

}  // namespace

std::int64_t HostClock::host_ns(std::int64_t rig_ns) const {
  if (slew_ == 0.0) return rig_ns;
  const auto time_ns = static_cast<double>(rig_ns);
  const double cycles = std::floor(time_ns / cycle_ns);
  const double slewed_so_far_ns = cycles * slewed_ns + std::min(time_ns - cycles * cycle_ns, slewed_ns);
  return rig_ns + static_cast<std::int64_t>(std::floor(slew_ * slewed_so_far_ns));
}

std::int64_t HostClock::rig_ns(std::int64_t host_ns) const {
  if (slew_ == 0.0) return host_ns;
  const auto time_ns = static_cast<double>(host_ns);
  const double gained_ns = slew_ * slewed_ns;  // in a cycle
  const double cycles = std::floor(time_ns / (cycle_ns + gained_ns));
  const double in_cycle_ns = time_ns - cycles * (cycle_ns + gained_ns);
  const double slewed_part_ns = std::min(in_cycle_ns / (1.0 + slew_), slewed_ns);
  return host_ns - static_cast<std::int64_t>(std::ceil(cycles * gained_ns + slew_ * slewed_part_ns));
}

}  // namespace thermorig::simulation
