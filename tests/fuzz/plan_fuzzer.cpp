// SPDX-License-Identifier: MIT
// Any text as a sweep plan: refused, or a plan that comes back the same and whose checks end.
#include <cmath>
#include <cstdint>
#include <string>

#include "fuzz_require.h"
#include "thermorig/rig/sweep/plan.h"

namespace {

using namespace thermorig;

void read(const std::string& text) {
  test::read_or_refuse(ExitCode::bad_usage, [&] {
    const rig::SweepPlan plan = rig::parse_plan(text, "fuzz", 1);
    for (const double rate_dps : plan.leg_rates_dps) test::fuzz_require(std::isfinite(rate_dps));
    test::fuzz_require(plan.frames_per_leg > 0 && plan.opening_rest_s >= 0 && plan.closing_rest_s >= 0);
    const rig::SweepPlan again = rig::parse_plan(rig::to_toml(plan), "written", 1);
    test::fuzz_require(again.leg_rates_dps == plan.leg_rates_dps &&
                       rig::to_toml(again) == rig::to_toml(plan));
    rig::check_plan(plan, ServoProfile(), CameraProfile());
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = rig::to_toml(rig::load_plan("quick", "garden", 1));
  read({reinterpret_cast<const char*>(data), size});
  read(test::spliced(sound, data, size));
  return 0;
}
