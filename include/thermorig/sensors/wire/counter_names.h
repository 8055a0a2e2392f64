// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "thermorig/sensors/wire/counters.h"

namespace thermorig::wire {

struct CounterName {
  const char* name;
  std::uint64_t Counters::*member;
};

/// All counters, as sessions and JSON name them.
inline constexpr std::array<CounterName, 12> counter_names{{
    {"bytes_received", &Counters::bytes_received},
    {"bytes_in_messages", &Counters::bytes_in_messages},
    {"bytes_in_damaged", &Counters::bytes_in_damaged},
    {"bytes_skipped", &Counters::bytes_skipped},
    {"bytes_pending", &Counters::bytes_pending},
    {"messages", &Counters::messages},
    {"replies", &Counters::replies},
    {"bad_checksum", &Counters::bad_checksum},
    {"bad_length", &Counters::bad_length},
    {"bad_value", &Counters::bad_value},
    {"lost", &Counters::lost},
    {"resyncs", &Counters::resyncs},
}};

}  // namespace thermorig::wire
