// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <utility>
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

/// A stream in place of a port, for all that needs no terminal: this side plays the device.
class Wire {
 public:
  Wire() {
    std::array<int, 2> ends{};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    device_ = files::Descriptor(ends[0]);
    program_ = files::Descriptor(ends[1]);
    const int least = 1;  // as little room as a terminal has
    for (const int end : ends) setsockopt(end, SOL_SOCKET, SO_SNDBUF, &least, sizeof least);
  }

  /// The program's side, once.
  files::Descriptor plug() { return std::move(program_); }

  bool is_open() const {
    pollfd state{.fd = device_.get(), .events = 0, .revents = 0};
    poll(&state, 1, 0);
    return (state.revents & POLLHUP) == 0;
  }

  /// How many bytes there was room for.
  std::size_t write(std::span<const std::uint8_t> bytes) const {
    return static_cast<std::size_t>(
        std::max<ssize_t>(send(device_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL), 0));
  }

  Bytes read() const {
    Bytes bytes(65536);
    const ssize_t size = recv(device_.get(), bytes.data(), bytes.size(), 0);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return bytes;
  }

  void unplug() { device_.close(); }

 private:
  files::Descriptor device_, program_;
};

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
