// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <time.h>

#include "thermorig/io/port.h"

namespace thermorig::io {

namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;

std::int64_t clock_ns(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<std::int64_t>(time.tv_sec) * ns_per_s + time.tv_nsec;
}

}  // namespace

HostTime now() {
  return host_time_ns(clock_ns(CLOCK_MONOTONIC));
}

std::int64_t realtime_offset_ns() {
  // The steady clock is read on both sides of the other one, so that a pause between two reads cancels.
  const std::int64_t before = clock_ns(CLOCK_MONOTONIC);
  const std::int64_t realtime = clock_ns(CLOCK_REALTIME);
  const std::int64_t after = clock_ns(CLOCK_MONOTONIC);
  return realtime - (before + (after - before) / 2);
}

std::string utc_text(HostTime time, std::int64_t realtime_offset_ns) {
  const std::int64_t ns = to_ns(time) + realtime_offset_ns;
  const std::int64_t ns_in_s = (ns % ns_per_s + ns_per_s) % ns_per_s;
  const time_t seconds = (ns - ns_in_s) / ns_per_s;
  tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, ns_in_s / 1000);
}

}  // namespace thermorig::io
