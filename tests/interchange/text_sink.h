// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <string>

#include "thermorig/learning/interchange/formats.h"

namespace thermorig::interchange {

/// Keeps what is written, and how much of it came at once at most.
struct TextSink final : Sink {
  using Sink::write;
  void write(std::span<const std::byte> bytes) override {
    text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    most_at_once = std::max(most_at_once, bytes.size());
  }

  std::string text;
  std::size_t most_at_once = 0;
};

}  // namespace thermorig::interchange
