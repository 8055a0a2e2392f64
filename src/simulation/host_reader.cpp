// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "usb_link.h"

namespace thermorig::simulation {
namespace {

constexpr std::size_t read_bytes = 4096;

// An idle desktop: 50 us and an exponential tail, now and then another program's turn.
constexpr double wake_up_s = 50e-6;
constexpr double wake_up_tail_s = 80e-6;
constexpr double spike_share = 0.01;
constexpr double long_spike_share = 0.001;

// A host busy with other work: 5 % of reads stall for 5 to 180 ms.
constexpr double stall_share = 0.05;

}  // namespace

std::int64_t HostReader::wake_up_ns() {
  double late_s = wake_up_s + random_.exponential(wake_up_tail_s);
  if (random_.chance(spike_share)) late_s += random_.uniform(0.001, 0.020);
  if (random_.chance(long_spike_share)) late_s += random_.uniform(0.020, 0.100);
  if (loaded_ && random_.chance(stall_share)) late_s += random_.uniform(0.005, 0.180);
  if (read_delay_s_ > 0.0) late_s += late_.exponential(read_delay_s_);
  return std::llround(late_s * 1e9);
}

TimedBytes HostReader::read_at(std::int64_t time_ns) {
  TimedBytes read{time_ns, {}};
  while (first_ < waiting_.size() && waiting_[first_].time_ns <= time_ns && read.bytes.size() < read_bytes) {
    auto& transfer = waiting_[first_].bytes;
    const auto taken = static_cast<std::ptrdiff_t>(std::min(transfer.size(), read_bytes - read.bytes.size()));
    read.bytes.insert(read.bytes.end(), transfer.begin(), transfer.begin() + taken);
    transfer.erase(transfer.begin(), transfer.begin() + taken);
    if (transfer.empty()) ++first_;
  }
  return read;
}

std::vector<TimedBytes> HostReader::reads(std::int64_t until_ns) {
  std::vector<TimedBytes> result;
  while (first_ < waiting_.size()) {
    if (!next_read_ns_)
      next_read_ns_ = bus_.after_stall_ns(std::max(waiting_[first_].time_ns, last_read_ns_) + wake_up_ns());
    if (*next_read_ns_ > until_ns) break;
    last_read_ns_ = *next_read_ns_;
    next_read_ns_.reset();
    result.push_back(read_at(last_read_ns_));
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(first_));
  first_ = 0;
  return result;
}

}  // namespace thermorig::simulation
