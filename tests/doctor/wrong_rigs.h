// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rig/simulated_bus.h"
#include "thermorig/rig/doctor/checks.h"

namespace thermorig::doctor::test {

/// Something that is wrong, and what must be said of it.
struct Misconfiguration {
  std::string name;
  std::function<std::vector<Check>()> look;
  std::string check;  // the one that must not be ok
  std::string says;   // a part of its result
  std::string advises;
  std::optional<ExitCode> code;  // none: a warning
};

/// Simulated rigs, each wrong in one way.
std::vector<Misconfiguration> wrong_rigs();

/// What the doctor would hear of a good rig that `wrong` has been done to: nothing is armed. An Error is a
/// check as well.
std::vector<Check> rig_with(const std::function<void(rig::test::SimulatedBus&)>& wrong);

}  // namespace thermorig::doctor::test
