// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "build_information.h"
#include "commands.h"
#include "print/output.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::app {

namespace {

namespace built = build_information;

std::string compiler() {
#if defined(__clang__)
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

nlohmann::json libraries() {
  return {{"HDF5", built::hdf5},
          {"Boost", built::boost},
          {"fmt", built::fmt},
          {"CLI11", built::cli11},
          {"zlib", built::zlib},
          {"nlohmann_json", built::nlohmann_json},
          {"libserialport", built::libserialport}};
}

}  // namespace

ExitCode run(const VersionOptions& options) {
  const std::string firmware = make_firmware(FirmwareChoice::avr_image)->description();
  if (options.json) {
    print_json({{"version", built::version},
                {"git", built::git},
                {"compiler", compiler()},
                {"build_type", built::build_type},
                {"libraries", libraries()},
                {"simulated_firmware", firmware},
                {"avr_image", firmware == "AVR image"}});
    return ExitCode::ok;
  }
  print("thermorig {} ({})\n", built::version, built::git);
  print("compiler   {}, {}\n", compiler(), built::build_type);
  const nlohmann::json used = libraries();
  std::string list;
  for (const auto& [name, version] : used.items())
    list += (list.empty() ? "" : ", ") + name + " " + version.get<std::string>();
  print("libraries  {}\n", list);
  print("firmware   the simulated ports run the {}\n", firmware);
  return ExitCode::ok;
}

}  // namespace thermorig::app
