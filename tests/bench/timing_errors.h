// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::bench {

/// Errors of one stream's times in seconds by method, and how the bounds of the final times did.
struct Errors {
  std::map<std::string, std::vector<float>> by_method;
  std::vector<float> widths_s;
  std::size_t bounded = 0;
  std::size_t later_than_bound = 0;
  std::size_t earlier_than_bound = 0;

  void add(const Errors& other);
};

/// In the order of the table: what others do, then ours.
const std::vector<std::string>& method_names();

/// Records a rig at rest for so long and judges every stream: each baseline, and ours as they are live (after
/// 10 s) and final.
PerDevice<Errors> judge(const simulation::VirtualRigConfig& config, double duration_s);

}  // namespace thermorig::bench
