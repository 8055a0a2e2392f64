// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/shard.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

std::optional<int> count_from(std::string_view text) {
  int count = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, count);
  return error == std::errc() && at == end ? std::optional(count) : std::nullopt;
}

}  // namespace

Shard shard_from(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto index = count_from(text.substr(0, slash));
  const auto count = slash == std::string_view::npos ? std::nullopt : count_from(text.substr(slash + 1));
  constexpr const char* example = "--shard 1/8 to --shard 8/8; for an array of Slurm: --array=1-8";
  if (!index || !count || *count < 1)
    throw Error(ExitCode::bad_usage, fmt::format("\"{}\" is not a part of a study", text), "", example);
  if (*index < 1 || *index > *count)
    throw Error(ExitCode::bad_usage,
                fmt::format("there is no part {} of {}: they count from 1", *index, *count), "", example);
  return {*index, *count};
}

std::vector<Job> jobs_of(const Shard& shard, std::span<const Job> jobs) {
  std::vector<Job> chosen;
  for (auto i = static_cast<std::size_t>(shard.index) - 1; i < jobs.size();
       i += static_cast<std::size_t>(shard.count))
    chosen.push_back(jobs[i]);
  return chosen;
}

}  // namespace thermorig::study
