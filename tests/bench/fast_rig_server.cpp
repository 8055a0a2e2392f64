// SPDX-License-Identifier: MIT
// Serves the fast rig on three pseudo terminals until standard input ends, and says how well it kept the
// clock. Usage: fast_rig_server PROFILE_TO_WRITE
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "fast_rig.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::bench {
namespace {

void serve(const char* profile_path) {
  const simulation::VirtualRigConfig config = fast_rig();
  SimulatedPorts ports(config, FirmwareChoice::host_build);  // the cheapest: it shares the machine
  RigProfile profile = config.profile;
  profile.name = "fast";
  for (const Device device : all_devices) profile.link(device).port = ports.paths()[device];
  rig::write_profile(profile_path, profile);
  ports.start();
  fmt::print("ready\n");
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  ports.stop();
  const ServingTally tally = ports.tally();
  std::uint64_t overrun = 0, delayed = 0;
  for (const PortTally& port : tally.ports.values) {
    overrun += port.bytes_overrun;
    delayed += port.bytes_delayed;
  }
  fmt::print(
      "{{\"worst_lag_s\": {:.6f}, \"bytes_delayed\": {}, \"bytes_overrun\": {}, \"thread_cpu_s\": {:.3f}, "
      "\"elapsed_s\": {:.3f}}}\n",
      tally.worst_lag_s, delayed, overrun, tally.thread_cpu_s, tally.elapsed_s);
}

}  // namespace
}  // namespace thermorig::bench

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    thermorig::bench::serve(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fast_rig_server: {}\n", error.what());
    return 1;
  }
}
