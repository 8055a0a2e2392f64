// SPDX-License-Identifier: MIT
#include <filesystem>

#include "i2c_port.h"
#include "port_list.h"
#include "thermorig/core/error.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what, const std::string& port) {
  throw Error(ExitCode::device_missing, what, port, existing_ports_text());
}

}  // namespace

std::string resolve_port(const std::string& port) {
  if (port.empty()) refuse("no port is chosen", "");
  // A bare name as other programs print it: ttyUSB0.
  const bool bare = port.find('/') == std::string::npos;
  std::error_code error;
  const fs::path path = fs::canonical(bare ? fs::path("/dev") / port : fs::path(port), error);
  if (error == std::errc::permission_denied)
    throw Error(ExitCode::no_permission, "a folder on the way to this port may not be read", port,
                "choose the port by its name in /dev");
  if (error && is_i2c_bus(port)) refuse_missing_i2c_bus(port);
  if (error) refuse("there is no such port", port);
  if (!fs::is_character_file(path, error)) refuse("this is not a serial port", port);
  return path.string();
}

bool is_pseudo_terminal(const std::string& port) {
  std::error_code error;
  return fs::canonical(port, error).string().starts_with("/dev/pts/");
}

bool is_i2c_bus(const std::string& port) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(port.find('/') == std::string::npos ? "/dev/" + port : port, error);
  return !error && path.parent_path() == "/dev" && path.filename().string().starts_with("i2c-");
}

}  // namespace thermorig::io
