// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "thermorig/wire/counters.h"
#include "thermorig/wire/gyro_message.h"

namespace thermorig::sensors {

/// Where a stream was joined. In the middle of a line of text, its tail may read as a whole line with a false
/// number.
enum class StreamStart : std::uint8_t { anywhere, at_line_start };

/// Bytes of one gyro to samples, whatever its protocol: holds any scanner that has these functions.
class GyroScanner {
 public:
  template <typename Scanner>
  explicit GyroScanner(Scanner scanner) : scanner_(std::make_unique<Of<Scanner>>(std::move(scanner))) {}
  GyroScanner(GyroScanner&&) noexcept = default;
  GyroScanner& operator=(GyroScanner&&) noexcept = default;
  GyroScanner(const GyroScanner& other) : scanner_(other.scanner_->copy()) {}
  GyroScanner& operator=(const GyroScanner&) = delete;
  ~GyroScanner() = default;

  /// Appends the samples that the bytes complete to `out`. Pieces may be cut anywhere.
  void push(std::span<const std::uint8_t> bytes, std::vector<wire::GyroMessage>& out) {
    scanner_->push(bytes, out);
  }
  /// The stream ends here: what only waits for the bytes behind it is decided. The last call.
  void finish(std::vector<wire::GyroMessage>& out) { scanner_->finish(out); }
  const wire::Counters& counters() const { return scanner_->counters(); }

 private:
  struct Any {
    virtual ~Any() = default;
    virtual void push(std::span<const std::uint8_t> bytes, std::vector<wire::GyroMessage>& out) = 0;
    virtual void finish(std::vector<wire::GyroMessage>& out) = 0;
    virtual const wire::Counters& counters() const = 0;
    virtual std::unique_ptr<Any> copy() const = 0;
  };

  template <typename Scanner>
  struct Of final : Any {
    explicit Of(Scanner made) : scanner(std::move(made)) {}
    void push(std::span<const std::uint8_t> bytes, std::vector<wire::GyroMessage>& out) override {
      scanner.push(bytes, out);
    }
    void finish(std::vector<wire::GyroMessage>& out) override { scanner.finish(out); }
    const wire::Counters& counters() const override { return scanner.counters(); }
    std::unique_ptr<Any> copy() const override { return std::make_unique<Of>(scanner); }
    Scanner scanner;
  };

  std::unique_ptr<Any> scanner_;
};

}  // namespace thermorig::sensors
