// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace thermorig::tests {

/// A process of its own records the simulated rig into the folder, in virtual time, and is killed in the
/// middle of it: it leaves a journal.
void record_and_be_killed(const std::filesystem::path& folder);

}  // namespace thermorig::tests
