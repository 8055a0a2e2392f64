// SPDX-License-Identifier: MIT
#include <cmath>

#include "usb_link.h"

namespace thermorig::simulation {
namespace {

constexpr std::int64_t hub_slot_ns = 1'000'000;  // a USB frame

}  // namespace

double SlotDraws::at(std::int64_t slot) const {
  return Random(seed_ + 0x9E3779B97F4A7C15ULL * static_cast<std::uint64_t>(slot), stream_).uniform();
}

SharedBus::SharedBus(const LinksWorld& world, std::uint64_t seed)
    : world_(world),
      jitter_(seed, "hub jitter"),
      stall_begins_(seed, "stall begins"),
      stall_lengths_(seed, "stall lengths") {}

std::int64_t SharedBus::behind_hub_ns(std::int64_t time_ns) const {
  double delay_ms = world_.hub_delay_ms;
  if (world_.hub_jitter_ms > 0.0) delay_ms += world_.hub_jitter_ms * jitter_.at(time_ns / hub_slot_ns);
  return time_ns + std::llround(1e6 * delay_ms);
}

/// One stall in each interval, wherever in it, of any length up to stall_ms.
std::int64_t SharedBus::after_stall_ns(std::int64_t time_ns) const {
  if (world_.stall_ms == 0.0) return time_ns;
  const auto interval_ns = static_cast<std::int64_t>(1e9 * world_.stall_interval_s);
  const std::int64_t slot = time_ns / interval_ns;
  const double length_ns = 1e6 * world_.stall_ms * stall_lengths_.at(slot);
  const double begin_ns = static_cast<double>(slot * interval_ns) +
                          (static_cast<double>(interval_ns) - length_ns) * stall_begins_.at(slot);
  const auto begin = static_cast<std::int64_t>(begin_ns);
  const auto end = static_cast<std::int64_t>(begin_ns + length_ns);
  return begin <= time_ns && time_ns < end ? end : time_ns;
}

}  // namespace thermorig::simulation
