// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>

#include "usb_link.h"

namespace thermorig::simulation {

UartLine::UartLine(std::uint32_t baud, double baud_error)
    : byte_ns_(baud == 0 ? 0.0 : 10e9 / (baud * (1.0 + baud_error))) {}

std::int64_t UartLine::backlog_ns(std::int64_t ready_ns) const {
  return std::max<std::int64_t>(0, std::llround(free_ns_) - ready_ns);
}

void UartLine::send(std::span<const std::uint8_t> bytes, std::int64_t ready_ns, std::vector<TimedByte>& out) {
  const double begin_ns = std::max(free_ns_, static_cast<double>(ready_ns));
  for (std::size_t i = 0; i < bytes.size(); ++i)
    out.push_back({std::llround(begin_ns + byte_ns_ * static_cast<double>(i + 1)), bytes[i]});
  free_ns_ = begin_ns + byte_ns_ * static_cast<double>(bytes.size());
}

UsbPath::UsbPath(const LinkConfig& link, std::uint64_t seed, std::string_view name, const LinksWorld& world)
    : random_(seed, std::string("usb ") += name),
      frames_(random_, 1e6 * world.frame_jitter_ms, {seed, std::string("usb frame jitter ") += name}),
      bridge_(make_bridge(link, frames_, random_)),
      bus_(world, seed),
      reader_(link.loaded_host, Random(seed, std::string("host reads ") += name), bus_,
              1e-3 * world.read_delay_ms, Random(seed, std::string("host reads late ") += name)) {}

void UsbPath::push(std::span<const TimedByte> bytes) {
  coming_.insert(coming_.end(), bytes.begin(), bytes.end());
}

std::vector<TimedBytes> UsbPath::reads(std::int64_t until_ns) {
  std::size_t taken = 0;
  for (; taken < coming_.size() && coming_[taken].time_ns <= until_ns; ++taken) {
    bridge_->pass(coming_[taken].time_ns - 1, transfers_);
    bridge_->take(coming_[taken], transfers_);
  }
  bridge_->pass(until_ns, transfers_);
  coming_.erase(coming_.begin(), coming_.begin() + static_cast<std::ptrdiff_t>(taken));
  for (auto& transfer : transfers_) {
    delivered_ns_ = transfer.time_ns = std::max(delivered_ns_, bus_.behind_hub_ns(transfer.time_ns));
    reader_.deliver(std::move(transfer));
  }
  transfers_.clear();
  return reader_.reads(until_ns);
}

}  // namespace thermorig::simulation
