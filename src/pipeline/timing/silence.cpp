// SPDX-License-Identifier: MIT
#include "silence.h"

#include <algorithm>

namespace thermorig::timing {

namespace {
constexpr double fewest_due = 20.0;
constexpr double fewest_cut_share = 0.1;  // of those that are due if the link cuts anywhere
// An assumption: adaptors without a timer that can be set answer within a few USB frames.
constexpr double longest_wait_s = 0.003;
}  // namespace

double longest_silence_s(const LineUse& use) {
  if (use.step_s <= 0.0 || use.message_s <= 0.0) return 0.0;
  const double due = std::min(1.0, use.message_s / use.step_s) * static_cast<double>(use.chunks);
  if (due < fewest_due || static_cast<double>(use.cuts) > fewest_cut_share * due) return 0.0;
  return std::clamp(use.step_s - use.message_s, 0.0, longest_wait_s);
}

}  // namespace thermorig::timing
