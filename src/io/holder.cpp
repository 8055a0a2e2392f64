// SPDX-License-Identifier: MIT
#include "thermorig/io/holder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "port_list.h"

namespace thermorig::io {

namespace {

namespace fs = std::filesystem;

bool holds(const fs::path& process, const std::string& path) {
  std::error_code error;
  // Processes of other users cannot be looked into: the iterator then starts at its end.
  for (fs::directory_iterator fd(process / "fd", error), end; !error && fd != end; fd.increment(error)) {
    std::error_code gone;
    if (fs::read_symlink(fd->path(), gone) == path) return true;
  }
  return false;
}

std::string command_of(const fs::path& process) {
  std::string name;
  std::ifstream comm(process / "comm");
  std::getline(comm, name);
  return device_text(name);
}

bool is_process_folder(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::optional<std::string> other_holder_of(const std::string& path, const fs::path& proc) {
  const std::string own = std::to_string(getpid());
  std::error_code error;
  for (fs::directory_iterator process(proc, error), end; !error && process != end; process.increment(error)) {
    const std::string name = process->path().filename();
    if (!is_process_folder(name) || name == own || !holds(process->path(), path)) continue;
    return fmt::format("process {} ({})", name, command_of(process->path()));
  }
  return std::nullopt;
}

std::string holder_of(const std::string& path) {
  if (auto other = other_holder_of(path)) return *other;
  return holds("/proc/self", path) ? "this process" : "another program";
}

}  // namespace thermorig::io
