// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "usb_link.h"

namespace thermorig::simulation {
namespace {

/// FT232: a packet carries 62 bytes (64 with two status bytes), and the driver's request for 8 packets
/// completes when it is full or by the first short packet, which a free-running latency timer sends. Source:
/// FTDI application note AN232B-04.
class FtdiBridge : public UsbBridge {
 public:
  FtdiBridge(const UsbFrames& frames, double latency_timer_s, Random& random)
      : frames_(frames), tick_ns_(latency_timer_s * 1e9), next_tick_ns_(random.uniform() * tick_ns_) {}

  void pass(std::int64_t time_ns, std::vector<TimedBytes>& out) override {
    for (; next_tick_ns_ <= static_cast<double>(time_ns); next_tick_ns_ += tick_ns_)
      complete(static_cast<std::int64_t>(next_tick_ns_), out);
  }

  void take(const TimedByte& byte, std::vector<TimedBytes>& out) override {
    held_.push_back(byte.value);
    if (held_.size() == request_bytes) complete(byte.time_ns, out);
  }

 private:
  static constexpr std::size_t request_bytes = 8 * 62;

  void complete(std::int64_t time_ns, std::vector<TimedBytes>& out) {
    if (held_.empty()) return;
    out.push_back({frames_.at_or_after(time_ns), std::exchange(held_, {})});
  }

  UsbFrames frames_;
  double tick_ns_;
  double next_tick_ns_;
  std::vector<std::uint8_t> held_;
};

/// CH340: packets of 32 bytes, sent when full or after a short silence. No timer can be set; the length of
/// the silence is not documented.
class Ch340Bridge : public UsbBridge {
 public:
  explicit Ch340Bridge(const UsbFrames& frames) : frames_(frames) {}

  void pass(std::int64_t time_ns, std::vector<TimedBytes>& out) override {
    if (!held_.empty() && last_byte_ns_ + silence_ns <= time_ns) complete(last_byte_ns_ + silence_ns, out);
  }

  void take(const TimedByte& byte, std::vector<TimedBytes>& out) override {
    held_.push_back(byte.value);
    last_byte_ns_ = byte.time_ns;
    if (held_.size() == packet_bytes) complete(byte.time_ns, out);
  }

 private:
  static constexpr std::size_t packet_bytes = 32;
  static constexpr std::int64_t silence_ns = 1'500'000;  // longer than a byte at 9600 baud

  void complete(std::int64_t time_ns, std::vector<TimedBytes>& out) {
    out.push_back({frames_.at_or_after(time_ns), std::exchange(held_, {})});
  }

  UsbFrames frames_;
  std::vector<std::uint8_t> held_;
  std::int64_t last_byte_ns_ = 0;
};

/// USB-CDC: the device's firmware hands over what it has in every frame, up to 19 packets of 64 bytes.
class CdcBridge : public UsbBridge {
 public:
  explicit CdcBridge(const UsbFrames& frames) : frames_(frames) {}

  void pass(std::int64_t time_ns, std::vector<TimedBytes>& out) override {
    while (!held_.empty() && due_ns_ <= time_ns) {
      const auto size = static_cast<std::ptrdiff_t>(std::min(held_.size(), frame_bytes));
      out.push_back({due_ns_, {held_.begin(), held_.begin() + size}});
      held_.erase(held_.begin(), held_.begin() + size);
      due_ns_ = frames_.at_or_after(due_ns_ + 1);
    }
  }

  void take(const TimedByte& byte, std::vector<TimedBytes>&) override {
    if (held_.empty()) due_ns_ = std::max(due_ns_, frames_.at_or_after(byte.time_ns));
    held_.push_back(byte.value);
  }

 private:
  static constexpr std::size_t frame_bytes = 19 * 64;

  UsbFrames frames_;
  std::vector<std::uint8_t> held_;
  std::int64_t due_ns_ = 0;
};

}  // namespace

UsbFrames::UsbFrames(Random& random, double jitter_ns, SlotDraws draws)
    : period_ns_(1e6 * (1.0 + random.normal(20e-6))),
      phase_ns_(random.uniform() * 1e6),
      jitter_ns_(jitter_ns),
      draws_(std::move(draws)) {}

std::int64_t UsbFrames::at_or_after(std::int64_t time_ns) const {
  const double frame = std::ceil((static_cast<double>(time_ns) - phase_ns_) / period_ns_);
  double asked_ns = phase_ns_ + frame * period_ns_;
  if (jitter_ns_ > 0.0) asked_ns += jitter_ns_ * draws_.at(static_cast<std::int64_t>(frame));
  return std::max(time_ns, static_cast<std::int64_t>(std::ceil(asked_ns)));
}

std::unique_ptr<UsbBridge> make_bridge(const LinkConfig& link, const UsbFrames& frames, Random& random) {
  switch (link.kind) {
    case UsbLink::ftdi:
      return std::make_unique<FtdiBridge>(frames, link.latency_timer_s, random);
    case UsbLink::ch340:
      return std::make_unique<Ch340Bridge>(frames);
    case UsbLink::cdc:
      break;
  }
  return std::make_unique<CdcBridge>(frames);
}

}  // namespace thermorig::simulation
