// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/rig/doctor/check.h"
#include "thermorig/rig/doctor/host_facts.h"
#include "thermorig/rig/recording/preflight.h"

namespace thermorig::doctor {

/// One check for each thing that was looked at; pure. Ports that have no role, since nobody asked for them,
/// give warnings at most.
std::vector<Check> judge_host(const HostFacts& facts);

/// Of these what a rig without ports needs as well.
std::vector<Check> judge_machine(const HostFacts& facts);

/// How a disk took a short test.
struct DiskSpeed {
  double bytes_per_s = 0.0;
  double sync_s = 0.0;  // the longest of the syncs
};

/// Writes 8 MiB into a file of its own in `folder`, syncing after each, and removes it. Throws Error(storage)
/// if that fails.
DiskSpeed measure_disk(files::Disk& disk, const std::filesystem::path& folder,
                       const std::function<HostTime()>& now);

/// `needed_bytes_per_s`: what a recording writes.
Check judge_disk(const DiskSpeed& speed, double needed_bytes_per_s);

/// Of a folder what killed programs left in it; none where nothing is.
std::optional<Check> judge_left_parts(const std::filesystem::path& folder,
                                      const std::vector<std::filesystem::path>& parts);

/// Which constants of a profile were measured, and since when the oldest of them has stood. Whether they
/// still hold only motion tells: it names the command.
Check judge_profile(const RigProfile& profile);

/// The figures of the preflight check, a line a device and one for the rest; what only a doctor says
/// (warm-up, brown-out) as warnings.
std::vector<Check> judge_rig(const rig::PreflightReport& report);

}  // namespace thermorig::doctor
