// SPDX-License-Identifier: MIT
#include "exclusive.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "port_list.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"

namespace thermorig::io {

namespace {

[[noreturn]] void refuse_in_use(const std::string& path, const std::string& by_whom) {
  throw Error(ExitCode::no_permission, "port is in use" + by_whom, path,
              "stop that program, or choose another port");
}

[[noreturn]] void refuse_in_use(const std::string& path, Refusal refusal) {
  refuse_in_use(path, refusal == Refusal::brief ? "" : " by " + files::holder_of(path));
}

/// Who only reads (`cat`) takes no lock, and takes bytes: each one goes to one of two readers.
std::optional<std::string> other_reader(const std::string& path, Refusal refusal) {
  return refusal == Refusal::brief ? std::nullopt : files::other_holder_of(path);
}

[[noreturn]] void refuse_open(const std::string& path, int error, Refusal refusal) {
  if (error == EACCES || error == EPERM)
    throw Error(ExitCode::no_permission, "you are not allowed to open this port", path,
                "sudo usermod -aG dialout $USER, then log out and in again");
  if (error == EBUSY) refuse_in_use(path, refusal);
  throw Error(ExitCode::device_missing, fmt::format("the port cannot be opened: {}", std::strerror(error)),
              path, existing_ports_text());
}

}  // namespace

files::Descriptor open_exclusively(const std::string& path, Refusal refusal) {
  if (is_system_console(path))  // asked before open(), which already moves its control lines
    throw Error(ExitCode::no_permission, "this port is the system's console", path, existing_ports_text());
  const auto reader = other_reader(path, refusal);  // before open(): bytes that come meanwhile would be lost
  files::Descriptor port(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!port) refuse_open(path, errno, refusal);
  if (isatty(port.get()) != 1)  // also a /dev/ttyS* without a chip behind it
    throw Error(ExitCode::device_missing, "this is not a serial port, or no device is behind it", path,
                existing_ports_text());
  port = lock_exclusively(std::move(port), path, refusal);
  if (reader) refuse_in_use(path, " by " + *reader);
  return port;
}

files::Descriptor lock_exclusively(files::Descriptor port, const std::string& path, Refusal refusal) {
  // TIOCEXCL does not stop root, so the lock is what two recorders see; pyserial's exclusive=True uses it
  // too.
  if (flock(port.get(), LOCK_EX | LOCK_NB) == 0) return port;
  port.close();  // else this process would be named, which holds it as well
  refuse_in_use(path, refusal);
}

}  // namespace thermorig::io
