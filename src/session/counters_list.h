// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "thermorig/wire/counters.h"

namespace thermorig::session {

struct CounterName {
  const char* name;
  std::uint64_t wire::Counters::*member;
};

/// The attributes of /raw/<device> that hold its counters.
inline constexpr std::array<CounterName, 12> counter_names{{
    {"bytes_received", &wire::Counters::bytes_received},
    {"bytes_in_messages", &wire::Counters::bytes_in_messages},
    {"bytes_in_damaged", &wire::Counters::bytes_in_damaged},
    {"bytes_skipped", &wire::Counters::bytes_skipped},
    {"bytes_pending", &wire::Counters::bytes_pending},
    {"messages", &wire::Counters::messages},
    {"replies", &wire::Counters::replies},
    {"bad_checksum", &wire::Counters::bad_checksum},
    {"bad_length", &wire::Counters::bad_length},
    {"bad_value", &wire::Counters::bad_value},
    {"lost", &wire::Counters::lost},
    {"resyncs", &wire::Counters::resyncs},
}};

}  // namespace thermorig::session
