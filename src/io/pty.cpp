// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

namespace {

[[noreturn]] void refuse_terminal() {
  throw Error(ExitCode::failed, std::strerror(errno), "/dev/ptmx",
              "check that /dev/pts is mounted and that it has room for more terminals");
}

/// The program's side is set up from the device's side: without it the line discipline would echo.
void switch_echo_off(int master) {
  termios settings{};
  if (tcgetattr(master, &settings) != 0) return;
  cfmakeraw(&settings);
  tcsetattr(master, TCSANOW, &settings);
}

}  // namespace

Pty::Pty() {
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> name{};
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, name.data(), name.size()) != 0)
    refuse_terminal();
  path_ = name.data();
  // Only after a first close does the kernel tell "nobody has it open" (POLLHUP).
  const int program = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (program < 0) refuse_terminal();
  ::close(program);
  switch_echo_off(master_);
}

Pty::~Pty() {
  unplug();
}

Pty::Pty(Pty&& other) noexcept
    : path_(std::move(other.path_)),
      master_(std::exchange(other.master_, -1)),
      was_open_(std::exchange(other.was_open_, false)) {}

Pty& Pty::operator=(Pty&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(master_, other.master_);
  std::swap(was_open_, other.was_open_);
  return *this;
}

const std::string& Pty::path() const {
  return path_;
}

int Pty::fd() const {
  return master_;
}

bool Pty::is_open() {
  if (master_ < 0) return false;
  pollfd state{.fd = master_, .events = 0, .revents = 0};
  poll(&state, 1, 0);
  const bool open = (state.revents & POLLHUP) == 0;
  if (was_open_ && !open) switch_echo_off(master_);  // some kernels reset the settings at the last close
  was_open_ = open;
  return open;
}

std::size_t Pty::write(std::span<const std::uint8_t> bytes) {
  if (!is_open()) return 0;
  const ssize_t written = ::write(master_, bytes.data(), bytes.size());
  return written < 0 ? 0 : static_cast<std::size_t>(written);
}

std::vector<std::uint8_t> Pty::read() {
  std::array<std::uint8_t, 4096> buffer;
  const ssize_t size = master_ < 0 ? -1 : ::read(master_, buffer.data(), buffer.size());
  if (size <= 0) return {};  // nothing yet, or nobody has it open
  return {buffer.begin(), buffer.begin() + size};
}

void Pty::unplug() {
  if (master_ >= 0) ::close(std::exchange(master_, -1));
}

}  // namespace thermorig::io
