// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "thermorig/wire/counters.h"

namespace thermorig::pipeline {

/// A scanner of a stream that may be interrupted: what a device sends once it is back never completes a
/// message whose beginning it sent before. Spans and counters go on through the whole stream.
template <typename Scanner, typename Message>
class RestartableScanner {
 public:
  explicit RestartableScanner(std::function<Scanner()> make) : make_(std::move(make)), scanner_(make_()) {}

  /// Appends the messages that the bytes complete to `out`.
  void push(std::span<const std::uint8_t> bytes, std::vector<Message>& out) {
    const std::size_t first = out.size();
    scanner_.push(bytes, out);
    settle(first, out);
  }

  /// The stream has ended, for good or for now: messages that waited for the bytes behind them.
  void finish(std::vector<Message>& out) {
    const std::size_t first = out.size();
    scanner_.finish(out);
    settle(first, out);
  }

  /// After finish(): the next byte begins anew.
  void restart() {
    before_ = counters_;
    scanner_ = make_();
  }

  const wire::Counters& counters() const { return counters_; }

 private:
  void settle(std::size_t first, std::vector<Message>& out) {
    for (std::size_t i = first; i < out.size(); ++i) {
      out[i].span.begin += before_.bytes_received;
      out[i].span.end += before_.bytes_received;
    }
    counters_ = before_;
    counters_ += scanner_.counters();
  }

  std::function<Scanner()> make_;
  Scanner scanner_;
  wire::Counters before_;  // of the scanners before this one
  wire::Counters counters_;
};

}  // namespace thermorig::pipeline
