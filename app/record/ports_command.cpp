// SPDX-License-Identifier: MIT
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "commands.h"
#include "found_ports.h"
#include "print/output.h"
#include "profile_path.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/rig/profile/profile_file.h"

namespace thermorig::app {

namespace {

/// The ports that were named, described as far as the system knows them; without names all that it lists.
std::vector<io::PortInfo> ports_to_hear(const std::vector<std::string>& named) {
  std::vector<io::PortInfo> listed = io::list_ports();
  if (named.empty()) return listed;
  std::vector<io::PortInfo> ports;
  for (const std::string& name : named) {
    const std::string path = io::resolve_port(name);
    const auto known =
        std::find_if(listed.begin(), listed.end(), [&](const auto& port) { return port.path == path; });
    ports.push_back(known == listed.end() ? io::PortInfo{.path = path} : *known);
  }
  return ports;
}

/// The one to save in as it is so far; else a new one of that name.
RigProfile profile_before(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) return rig::read_profile(file);
  RigProfile profile;
  profile.name = file.stem().string();
  return profile;
}

}  // namespace

ExitCode run(const PortsOptions& options) {
  const std::vector<io::PortInfo> ports = ports_to_hear(options.extra);
  if (ports.empty())
    throw Error(ExitCode::device_missing, "this machine has no serial port", "",
                "plug the devices in; without hardware: thermorig simulate");
  SavedProfile saved{.name = options.save, .file = {}};
  if (!saved.name.empty()) {
    saved.file = profile_path(saved.name);
    rig::require_profile_storage(saved.file);
  }
  if (!options.json) {
    print("listening to {} port{} for up to 6 s ...\n\n", ports.size(), ports.size() == 1 ? "" : "s");
    flush_output();
  }
  std::vector<rig::PortFinding> findings = rig::identify_devices(ports);
  const FoundPorts found = found_ports(std::move(findings), profile_before(saved.file), saved);
  if (!saved.name.empty()) rig::write_profile(saved.file, found.profile);
  if (options.json)
    print_json(json_of(found));
  else
    print("{}", text_of(found));
  return found.code();
}

}  // namespace thermorig::app
