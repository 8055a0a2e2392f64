// SPDX-License-Identifier: MIT
#include "thermorig/wire/gyro_scanner.h"

namespace thermorig::wire {

GyroScanner::GyroScanner(const GyroProfile& profile, StreamStart start)
    : protocol_(profile.protocol), text_(profile.text, start) {}

void GyroScanner::push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out) {
  if (protocol_ == GyroProtocol::witmotion)
    witmotion_.push(bytes, out);
  else
    text_.push(bytes, out);
}

void GyroScanner::finish(std::vector<GyroMessage>& out) {
  if (protocol_ == GyroProtocol::witmotion)
    witmotion_.finish(out);
  else
    text_.finish(out);
}

const Counters& GyroScanner::counters() const {
  return protocol_ == GyroProtocol::witmotion ? witmotion_.counters() : text_.counters();
}

}  // namespace thermorig::wire
