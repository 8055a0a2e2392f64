// SPDX-License-Identifier: MIT
#include "exclusive.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "port_list.h"
#include "thermorig/core/error.h"

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
  return printable(name);
}

bool is_process_folder(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos;
}

[[noreturn]] void refuse_in_use(const std::string& path) {
  throw Error(ExitCode::no_permission, fmt::format("port is in use by {}", holder_of(path)), path,
              "stop that program, or choose another port");
}

[[noreturn]] void refuse_open(const std::string& path, int error) {
  if (error == EACCES || error == EPERM)
    throw Error(ExitCode::no_permission, "you are not allowed to open this port", path,
                "sudo usermod -aG dialout $USER, then log out and in again");
  if (error == EBUSY) refuse_in_use(path);
  throw Error(ExitCode::device_missing, fmt::format("the port cannot be opened: {}", std::strerror(error)),
              path, existing_ports_text());
}

}  // namespace

Descriptor::~Descriptor() {
  close();
}

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

void Descriptor::close() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

std::string holder_of(const std::string& path) {
  const std::string own = std::to_string(getpid());
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end;
       process.increment(error)) {
    const std::string name = process->path().filename();
    if (!is_process_folder(name) || name == own || !holds(process->path(), path)) continue;
    return fmt::format("process {} ({})", name, command_of(process->path()));
  }
  return holds("/proc/self", path) ? "this process" : "another program";
}

Descriptor open_exclusively(const std::string& path) {
  if (is_system_console(path))  // asked before open(), which already moves its control lines
    throw Error(ExitCode::no_permission, "this port is the system's console", path, existing_ports_text());
  Descriptor port(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!port) refuse_open(path, errno);
  if (isatty(port.get()) != 1)  // also a /dev/ttyS* without a chip behind it
    throw Error(ExitCode::device_missing, "this is not a serial port, or no device is behind it", path,
                existing_ports_text());
  // TIOCEXCL does not stop root, so the lock is what two recorders see; pyserial's exclusive=True uses it
  // too.
  if (flock(port.get(), LOCK_EX | LOCK_NB) != 0) {
    port.close();
    refuse_in_use(path);
  }
  return port;
}

}  // namespace thermorig::io
