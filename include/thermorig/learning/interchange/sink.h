// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace thermorig::interchange {

/// Where a file's bytes go, one after another: nothing is ever gone back to, so it may be a pipe.
class Sink {
 public:
  virtual ~Sink() = default;

  /// Throws Error(storage).
  virtual void write(std::span<const std::byte> bytes) = 0;

  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
};

}  // namespace thermorig::interchange
