// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "thermorig/core/device.h"
#include "thermorig/core/profile.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

/// What a device sends all the time.
struct LinkLoad {
  std::uint64_t message_bytes = 0;  // of one frame, sample or telemetry message, at most
  double rate_hz = 0.0;             // messages a second, nominal
  double bytes_per_s() const { return static_cast<double>(message_bytes) * rate_hz; }
};

LinkLoad link_load(Device device, const RigProfile& profile);

/// Bytes that the journal of the whole plan will need, generously.
std::uint64_t expected_journal_bytes(const SweepPlan& plan, const RigProfile& profile);

/// What a session needs beside the journal that it is made of, bytes.
std::uint64_t session_bytes_beside(std::uint64_t journal_bytes);

/// Both: a disk with less is refused before anything moves.
std::uint64_t expected_recording_bytes(const SweepPlan& plan, const RigProfile& profile);

}  // namespace thermorig::rig
