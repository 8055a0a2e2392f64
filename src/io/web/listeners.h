// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

namespace thermorig::web {

/// Sockets that listen on one port of 127.0.0.1 and, where the machine has it, of ::1. No other address.
class Listeners {
 public:
  /// Port 0: any that is free. Nothing if the port is in use; throws Error(failed) for everything else.
  static std::optional<Listeners> open(std::uint16_t port);
  ~Listeners();
  Listeners(Listeners&& other) noexcept;
  Listeners& operator=(Listeners&&) = delete;

  std::uint16_t port() const { return port_; }

  /// The caller closes them from then on; -1: there is no ::1.
  int take_v4();
  int take_v6();

 private:
  Listeners() = default;

  int v4_ = -1, v6_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace thermorig::web
