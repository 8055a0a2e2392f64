// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

using Bytes = std::vector<std::uint8_t>;

constexpr HostDuration tick_period = std::chrono::milliseconds(1);
constexpr int patience_ticks = 10'000;

/// Runs the loop until `done`, which is asked at every tick, gives true; fails the test if it never does.
inline void run_until(Loop& loop, const std::function<bool()>& done) {
  int ticks = 0;
  bool finished = false;
  loop.every(tick_period, [&](HostTime) {
    finished = done();
    if (finished || ++ticks > patience_ticks) loop.stop();
  });
  loop.run();
  loop.every(tick_period, [](HostTime) {});
  EXPECT_TRUE(finished) << "what the test waits for did not happen";
}

inline void run_ticks(Loop& loop, int ticks) {
  run_until(loop, [&ticks] { return ticks-- == 0; });
}

inline PortProfile port_at(const std::string& path) {
  PortProfile link;
  link.port = path;
  return link;
}

/// Handlers that collect what arrives.
struct Collected {
  Bytes bytes;
  std::vector<HostTime> times;
  std::vector<std::string> losses;

  Loop::PortHandlers handlers() {
    return {[this](std::span<const std::uint8_t> chunk, HostTime time) {
              bytes.insert(bytes.end(), chunk.begin(), chunk.end());
              times.push_back(time);
            },
            [this](const std::string& why) { losses.push_back(why); }};
  }
};

/// Bytes in which a lost, doubled or swapped one shows: the index, folded.
inline Bytes numbered_bytes(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i ^ (i >> 8U) ^ (i >> 16U));
  return bytes;
}

/// What `open` throws; fails the test if it throws nothing.
inline Error refusal_of(const std::function<void()>& open) {
  try {
    open();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return Error(ExitCode::ok, "", "", "");
}

}  // namespace thermorig::io
