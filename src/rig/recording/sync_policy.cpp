// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/sync_policy.h"

#include <charconv>

#include "thermorig/core/error.h"

namespace thermorig::rig {

SyncPolicy sync_policy_from(const std::string& text) {
  constexpr int shortest_ms = 10;
  constexpr int longest_ms = 60'000;
  if (text == "frame") return {.when = SyncWhen::each_frame};
  if (text == "end") return {.when = SyncWhen::end};
  int period_ms = 0;
  const char* const end = text.data() + text.size();
  const auto [at, failure] = std::from_chars(text.data(), end, period_ms);
  if (failure != std::errc() || at != end || period_ms < shortest_ms || period_ms > longest_ms)
    throw Error(ExitCode::bad_usage, "\"" + text + "\" is no time to sync at", "--sync",
                "frame, end, or milliseconds from 10 to 60000");
  return {.when = SyncWhen::period, .period = std::chrono::milliseconds(period_ms)};
}

std::string to_text(const SyncPolicy& policy) {
  if (policy.when == SyncWhen::each_frame) return "frame";
  if (policy.when == SyncWhen::end) return "end";
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(policy.period).count());
}

}  // namespace thermorig::rig
