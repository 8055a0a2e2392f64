// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "thermorig/sensors/wire/counters.h"

namespace thermorig::sensors {

/// Where a stream was joined. In the middle of a line of text, its tail may read as a whole line with a false
/// number.
enum class StreamStart : std::uint8_t { anywhere, at_line_start };

/// Bytes of one device to messages, whatever its protocol: holds any scanner that has these functions.
template <typename Message>
class Scanner {
 public:
  template <typename Concrete>
  explicit Scanner(Concrete scanner) : scanner_(std::make_unique<Of<Concrete>>(std::move(scanner))) {}
  Scanner(Scanner&&) noexcept = default;
  Scanner& operator=(Scanner&&) noexcept = default;
  Scanner(const Scanner& other) : scanner_(other.scanner_->copy()) {}
  Scanner& operator=(const Scanner&) = delete;
  ~Scanner() = default;

  /// This was written to the device: whole messages, in the order of time with what is pushed. Most scanners
  /// have no use for it.
  void sent(std::span<const std::uint8_t> bytes) { scanner_->sent(bytes); }
  /// Appends the messages that the bytes complete to `out`. Pieces may be cut anywhere.
  void push(std::span<const std::uint8_t> bytes, std::vector<Message>& out) { scanner_->push(bytes, out); }
  /// The stream ends here, for good or for now: what only waits for the bytes behind it is decided.
  void finish(std::vector<Message>& out) { scanner_->finish(out); }
  /// After finish(): the device was away, or sent what nobody can read. No message reaches over that; what
  /// was learnt of the device before, the scanner keeps or forgets as is right for it. Spans and counters go
  /// on.
  void restart() { scanner_->restart(); }
  const wire::Counters& counters() const { return scanner_->counters(); }

 private:
  struct Any {
    virtual ~Any() = default;
    virtual void sent(std::span<const std::uint8_t> bytes) = 0;
    virtual void push(std::span<const std::uint8_t> bytes, std::vector<Message>& out) = 0;
    virtual void finish(std::vector<Message>& out) = 0;
    virtual void restart() = 0;
    virtual const wire::Counters& counters() const = 0;
    virtual std::unique_ptr<Any> copy() const = 0;
  };

  template <typename Concrete>
  struct Of final : Any {
    explicit Of(Concrete made) : scanner(std::move(made)) {}
    void sent(std::span<const std::uint8_t> bytes) override {
      if constexpr (requires { scanner.sent(bytes); }) scanner.sent(bytes);
    }
    void push(std::span<const std::uint8_t> bytes, std::vector<Message>& out) override {
      scanner.push(bytes, out);
    }
    void finish(std::vector<Message>& out) override { scanner.finish(out); }
    void restart() override { scanner.restart(); }
    const wire::Counters& counters() const override { return scanner.counters(); }
    std::unique_ptr<Any> copy() const override { return std::make_unique<Of>(scanner); }
    Concrete scanner;
  };

  std::unique_ptr<Any> scanner_;
};

}  // namespace thermorig::sensors
