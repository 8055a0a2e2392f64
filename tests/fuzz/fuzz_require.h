// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::test {

inline void fuzz_require(bool holds) {
  if (!holds) std::abort();
}

/// Runs `read`; what it refuses must be an Error of this code that says what is wrong.
template <typename Read>
void read_or_refuse(ExitCode code, Read read) {
  try {
    read();
  } catch (const Error& error) {
    fuzz_require(error.code() == code && !error.what_happened().empty());
  }
}

/// Reads the fuzzer's input piece by piece; beyond its end there are zeros.
class FuzzScript {
 public:
  FuzzScript(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
  bool done() const { return left_ == 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *at_++;
  }
  template <typename Number>
  Number number() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) value |= std::uint64_t{byte()} << (8 * i);
    return static_cast<Number>(value);
  }
  std::string text(std::size_t size) {
    std::string text;
    while (text.size() < size && !done()) text += static_cast<char>(byte());
    return text;
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

/// A sound text in which the input replaces pieces: what is wrong then is not the whole.
inline std::string spliced(std::string text, const std::uint8_t* data, std::size_t size) {
  FuzzScript script(data, size);
  for (int edits = 0; edits < 4 && !script.done(); ++edits) {
    const std::size_t at = script.number<std::uint16_t>() % (text.size() + 1);
    const std::size_t removed = script.byte() % 32U;
    text.replace(at, removed, script.text(script.byte() % 32U));
  }
  return text;
}

}  // namespace thermorig::test
