// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/simulation/virtual_rig.h"
#include "timing_rig.h"

namespace thermorig::bench {

/// Errors of one stream's times in seconds by method, and how the bounds of the final times did.
struct Errors {
  std::map<std::string, std::vector<float>> by_method;
  std::vector<float> widths_s;
  std::size_t bounded = 0;
  std::size_t later_than_bound = 0;
  std::size_t earlier_than_bound = 0;
  std::size_t repeats = 0;  // frames that the program says repeat the one before: in none of the errors

  void add(const Errors& other);
};

/// In the order of the table: what others do, then ours.
const std::vector<std::string>& method_names();

/// The name of a method's errors once what is constant of them in a recording is taken off.
std::string less_constant(const std::string& method);

/// Records a rig at rest for so long and judges every stream: each baseline, and ours as they are live and
/// final. The first 10 s are left out of the errors of all, of no bound.
PerDevice<Errors> judge(const simulation::VirtualRigConfig& config, double duration_s);

/// The same of a recording's camera, its errors from some instant on.
Errors judge_camera(const Recorded& recorded, const std::vector<TimeEstimate>& final, HostTime from);

}  // namespace thermorig::bench
