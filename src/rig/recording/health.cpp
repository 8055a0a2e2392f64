// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/health.h"

#include <algorithm>

namespace thermorig::rig {

namespace {
constexpr auto window = std::chrono::seconds(1);
constexpr std::size_t windows_kept = 10;
}  // namespace

void RateMeter::roll(HostTime now) const {
  if (now - window_begin_ > windows_kept * window) {  // silent for long: every kept window is empty
    windows_.assign(windows_kept, 0);
    current_ = 0;
    window_begin_ = now;
  }
  while (now - window_begin_ >= window) {
    windows_.push_back(current_);
    if (windows_.size() > windows_kept) windows_.pop_front();
    current_ = 0;
    window_begin_ += window;
  }
}

void RateMeter::message(HostTime arrived) {
  if (!last_) window_begin_ = arrived;
  roll(arrived);
  ++current_;
  ++count_;
  last_ = arrived;
}

DeviceHealth RateMeter::health(HostTime now, const wire::Counters& counters) const {
  DeviceHealth health;
  health.messages = count_;
  health.lost = counters.lost;
  health.bad = counters.bad_checksum + counters.bad_length + counters.bad_value;
  health.skipped_bytes = counters.bytes_skipped;
  if (!last_) return health;
  roll(now);
  health.age_s = to_s(now - *last_);
  if (windows_.empty()) return health;
  const auto [slowest, fastest] = std::minmax_element(windows_.begin(), windows_.end());
  health.rate_min_hz = *slowest;
  health.rate_max_hz = *fastest;
  return health;
}

}  // namespace thermorig::rig
