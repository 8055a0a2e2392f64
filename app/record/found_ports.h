// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "thermorig/rig/discovery/detect.h"

namespace thermorig::app {

/// A profile that the ports are saved in: as it was named, and where that is. Both empty: nowhere.
struct SavedProfile {
  std::string name;
  std::filesystem::path file;
};

/// What `thermorig ports` found.
struct FoundPorts {
  std::vector<rig::PortFinding> findings;  // camera, gyro, servo, then what has no role
  std::vector<std::string> missing;        // roles
  std::vector<std::string> ambiguous;      // sentences about roles that were found twice
  RigProfile profile;                      // with the ports that were found
  SavedProfile saved;

  bool is_whole_rig() const { return missing.empty() && ambiguous.empty() && has_all_ports(); }
  /// False if a gyro was left out, of which nothing says how it is read.
  bool has_all_ports() const {
    return std::all_of(all_devices.begin(), all_devices.end(),
                       [&](Device device) { return !profile.link(device).port.empty(); });
  }
  /// Of a rig that is not whole no_permission, if a port that could be its rest may not be opened, or is in
  /// use.
  ExitCode code() const;
};

/// The ports that were named, described as far as the system knows them; without names all that it lists.
std::vector<io::PortInfo> ports_to_hear(const std::vector<std::string>& named);

/// `profile` keeps everything but its ports: people edit such files.
FoundPorts found_ports(std::vector<rig::PortFinding> findings, const RigProfile& profile, SavedProfile saved);

/// A table of the ports, what is to be known of them, and what to type next.
std::string text_of(const FoundPorts& found);

nlohmann::json json_of(const FoundPorts& found);

}  // namespace thermorig::app
