// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/freshness.h"

#include <utility>

namespace thermorig::labels {

HalvesWitness HalvesOrder::push(const Freshness& freshness, CameraMode mode) {
  const Freshness before = std::exchange(before_, freshness);
  if (mode != CameraMode::half_fresh) return HalvesWitness::unsure;
  if (before.none_fresh() || freshness.none_fresh()) return HalvesWitness::unsure;
  if (freshness.both_fresh()) return HalvesWitness::frames_missing;
  if (before.both_fresh()) return HalvesWitness::unsure;
  return before.even_fresh() == freshness.even_fresh() ? HalvesWitness::due_half_missing
                                                       : HalvesWitness::none_missing;
}

void ModeVote::push(const Freshness& freshness) {
  if (freshness.both_fresh()) ++full_;
  if (freshness.one_fresh()) ++half_;
}

}  // namespace thermorig::labels
