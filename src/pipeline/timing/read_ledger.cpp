// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/read_ledger.h"

#include <algorithm>

namespace thermorig::timing {

namespace {
constexpr std::size_t most_open = 8;
// No answer is late by one read for so long: the host reads all that has come.
constexpr int most_unsure = 25;
}  // namespace

void ReadLedger::asked(HostTime time) {
  if (is_unsure() && time - open_.back() >= longest_answer) open_.clear();
  open_.push_back(time);
  if (open_.size() > most_open) open_.pop_front();
  answered_since_ = false;
}

std::optional<ReadLedger::Request> ReadLedger::answered(HostTime begun) {
  if (open_.empty()) return std::nullopt;
  const auto possible = std::count_if(open_.begin(), open_.end(), [&](HostTime t) { return t <= begun; });
  const Request request{open_.front(), possible == 1};
  answered_since_ = true;
  open_.pop_front();
  unsure_ = open_.empty() ? 0 : unsure_ + 1;
  if (unsure_ >= most_unsure) restart();
  return request;
}

}  // namespace thermorig::timing
