// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::timing {

inline constexpr double ms = 1e-3;

/// One device of a simulated rig: what the host read, the messages in it, and when they really began.
struct RecordedStream {
  PortProfile link;
  double nominal_rate_hz = 0.0;
  RawStream received;
  std::vector<StreamSpan> spans;
  std::vector<HostTime> sample_time;  // of each message: its sample's instant, plus the latency
  std::vector<std::int64_t> index;    // of each message, as the device counts, from its first
  std::unique_ptr<bool[]> suspect;    // bytes were lost before the message

  std::span<const bool> suspects() const { return {suspect.get(), spans.size()}; }

  /// As if the scanner had not understood the messages for which `is_lost` says so.
  RecordedStream without(const std::function<bool(std::size_t)>& is_lost, bool is_flagged) const;
};

/// A link of camera and gyro, and how its host is.
struct TestLink {
  const char* name = "";
  simulation::UsbLink kind = simulation::UsbLink::ftdi;
  double latency_timer_s = 0.016;
  bool loaded_host = false;
};

/// One of each kind, and an FTDI one with its timer at the least.
std::vector<TestLink> links(bool loaded_host);

RecordedStream record_stream(Device device, const TestLink& link, std::uint64_t seed, double duration_s,
                             const std::vector<simulation::Outage>& outages = {});

/// Numbers and final clock in one go.
struct FittedStream {
  std::vector<std::int64_t> number;
  fit::ArrivalClock clock;
};
FittedStream fit_stream(const RecordedStream& stream);

/// Stamps by LinkTiming, message by message as they come.
std::vector<Stamp> stamp_stream(const RecordedStream& stream, double nominal_rate_hz);

/// Sizes of errors, seconds: quantile, and root mean square.
class ErrorSizes {
 public:
  void add(double error_s);
  double quantile(double share) const;
  double largest() const { return quantile(1.0); }
  double rms() const;
  std::size_t count() const { return sizes_s_.size(); }

 private:
  std::vector<double> sizes_s_;
};

}  // namespace thermorig::timing
