// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <utility>

#include "thermorig/rig/detect.h"
#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

namespace {
constexpr double share_needed = 0.3;  // a short look begins and ends in the middle of a message
}  // namespace

Evidence classify(std::span<const std::uint8_t> bytes, double heard_s) {
  Evidence best{.text = bytes.empty() ? "silent"
                                      : fmt::format("{} bytes that no known device sends", bytes.size())};
  for (sensors::Recognised& found : sensors::recognise(bytes, heard_s)) {
    const double share = static_cast<double>(found.evidence.bytes) / static_cast<double>(bytes.size());
    if (share < share_needed || share <= best.explained_share) continue;
    best = {.role = found.role,
            .protocol = std::string(found.protocol),
            .messages = found.evidence.messages,
            .explained_share = share,
            .text = std::move(found.evidence.text),
            .text_format = std::move(found.evidence.text_format)};
  }
  return best;
}

}  // namespace thermorig::rig
