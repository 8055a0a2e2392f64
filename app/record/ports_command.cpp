// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "commands.h"
#include "found_ports.h"
#include "print/output.h"
#include "profile_path.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/sensors/text_format.h"

namespace thermorig::app {

namespace {

/// The one to save in as it is so far; else a new one of that name.
RigProfile profile_before(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) return rig::read_profile(file);
  RigProfile profile;
  profile.name = file.stem().string();
  return profile;
}

bool talks_to_a_person(const PortsOptions& options) {
  return !options.json && isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0;
}

/// One thing is asked of a person where the lines of a gyro do not say how they are read.
void ask_for_hand_turn(rig::PortFinding& finding) {
  print("the gyro on {} prints lines such as\n        {}\n{}.\n", printable(finding.info.path),
        printable(finding.text_format->sample_line), sensors::open_question(*finding.text_format));
  print(
      "Lay it still and press Enter. Then turn it by hand once, by a quarter turn about its\nvertical axis, "
      "within "
      "{:.0f} s, and leave it there. (Ctrl-D: do not ask)\n",
      rig::hand_turn_s - 2.0);
  flush_output();
  if (std::string answer; !std::getline(std::cin, answer)) return;
  rig::SystemPortLoop loop;
  if (auto turned = rig::hear_hand_turn(finding, loop))
    finding = *std::move(turned);
  else
    print("no column turned like a rate by a quarter turn: run this again, or fill in the profile\n");
}

}  // namespace

ExitCode run(const PortsOptions& options) {
  const std::vector<io::PortInfo> ports = ports_to_hear(options.extra);
  if (ports.empty())
    throw Error(ExitCode::device_missing, "this computer has no serial port", "",
                "plug the devices in; without hardware: thermorig simulate, then name its ports");
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
  if (!saved.name.empty() && talks_to_a_person(options))
    for (rig::PortFinding& finding : findings)
      if (finding.role && !finding.is_known()) ask_for_hand_turn(finding);
  const FoundPorts found = found_ports(std::move(findings), profile_before(saved.file), saved);
  if (!saved.name.empty()) rig::write_profile(saved.file, found.profile);
  if (options.json)
    print_json(json_of(found));
  else
    print("{}", text_of(found));
  return found.code();
}

}  // namespace thermorig::app
