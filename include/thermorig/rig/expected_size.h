// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "thermorig/core/profile.h"
#include "thermorig/rig/plan.h"

namespace thermorig::rig {

/// Bytes that the journal of the whole plan will need, generously.
std::uint64_t expected_journal_bytes(const SweepPlan& plan, const RigProfile& profile);

/// What a session needs beside the journal that it is made of, bytes.
std::uint64_t session_bytes_beside(std::uint64_t journal_bytes);

/// Both: a disk with less is refused before anything moves.
std::uint64_t expected_recording_bytes(const SweepPlan& plan, const RigProfile& profile);

}  // namespace thermorig::rig
