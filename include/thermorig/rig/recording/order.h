// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace thermorig::rig {

enum class OrderKind : std::uint8_t {
  stop,   // the servo to rest, then the end
  mark,   // an event with the operator's note
  start,  // motion may begin: see RecordingOptions::wait_for_start
  gate,   // an event: the network's gate has collapsed
  info,   // an event: what a watcher has to say
};

/// What somebody who watches a recording asks of it. Taken at its next tick.
struct Order {
  OrderKind kind = OrderKind::stop;
  std::string note;  // of a mark, gate or info: its text; of a stop: who asked for it
};

}  // namespace thermorig::rig
