// SPDX-License-Identifier: MIT
#include "thermorig/rig/doctor/check.h"

#include <algorithm>

namespace thermorig::doctor {

ExitCode exit_code_of(const std::vector<Check>& checks) {
  const auto first =
      std::find_if(checks.begin(), checks.end(), [](const Check& check) { return check.failed(); });
  return first == checks.end() ? ExitCode::ok : first->code;
}

}  // namespace thermorig::doctor
