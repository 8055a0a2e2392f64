// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/freshness.h"

namespace thermorig::labels {

void ModeVote::push(const Freshness& freshness) {
  if (freshness.both_fresh()) ++full_;
  if (freshness.one_fresh()) ++half_;
}

}  // namespace thermorig::labels
