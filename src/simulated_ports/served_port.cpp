// SPDX-License-Identifier: MIT
#include "served_port.h"

#include <algorithm>
#include <utility>

namespace thermorig {

namespace {

/// The kernel keeps 64 KiB of a real port for a program, and of a terminal that a program serves a quarter of
/// that.
constexpr std::size_t waiting_max = 48 * 1024;

}  // namespace

int ServedPort::readable_fd() {
  if (unplug_) {
    pty_.unplug();
    const std::lock_guard lock(mutex_);
    if (next_) {
      pty_ = std::move(*next_);
      next_.reset();
      unplug_ = false;
    }
  }
  // While it is closed a wait would return at once: the terminal reports a hang-up for all that time.
  return pty_.is_open() ? pty_.fd() : -1;
}

std::string ServedPort::plug_in() {
  io::Pty pty;
  std::string path = pty.path();
  const std::lock_guard lock(mutex_);
  next_.emplace(std::move(pty));
  return path;
}

std::size_t ServedPort::write(std::span<const std::uint8_t> bytes) {
  const std::size_t written = pty_.write(bytes);
  tally_.bytes_delivered += written;
  if (keeps_delivered_)
    delivered_.insert(delivered_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(written));
  return written;
}

void ServedPort::deliver(std::span<const std::uint8_t> bytes) {
  deliver_waiting();
  if (!pty_.is_open()) {
    tally_.bytes_unheard += bytes.size();
    return;
  }
  const std::span<const std::uint8_t> rest = bytes.subspan(waiting_.empty() ? write(bytes) : 0);
  const std::size_t kept = std::min(rest.size(), waiting_max - waiting_.size());
  waiting_.insert(waiting_.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(kept));
  tally_.bytes_delayed += kept;
  tally_.bytes_overrun += rest.size() - kept;
}

void ServedPort::deliver_waiting() {
  if (waiting_.empty()) return;
  if (pty_.is_open()) {
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(write(waiting_)));
  } else {
    tally_.bytes_unheard += waiting_.size();
    waiting_.clear();
  }
}

std::vector<std::uint8_t> ServedPort::receive() {
  std::vector<std::uint8_t> bytes = pty_.read();
  tally_.bytes_received += bytes.size();
  return bytes;
}

}  // namespace thermorig
