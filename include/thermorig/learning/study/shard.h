// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// One of `count` parts of a study, counted from 1.
struct Shard {
  int index = 1;
  int count = 1;
};

/// "3/8". Throws Error(bad_usage) for what is none: 0/8 as well, since parts count from 1.
Shard shard_from(std::string_view text);

/// Every count-th job from the index-th on, in their order: the parts differ by one job at most. There may be
/// none.
std::vector<Job> jobs_of(const Shard& shard, std::span<const Job> jobs);

}  // namespace thermorig::study
