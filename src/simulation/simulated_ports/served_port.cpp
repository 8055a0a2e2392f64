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

void ServedPort::plug_in(std::unique_ptr<io::DeviceSide> next) {
  const std::lock_guard lock(mutex_);
  next_ = std::move(next);
  changes_ = true;
}

void ServedPort::follow_plug() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(changes_, false)) side_ = std::move(next_);
}

bool ServedPort::was_opened() {
  const bool was_open = std::exchange(was_open_, is_open());
  return was_open_ && !was_open;
}

int ServedPort::readable_fd() const {
  // While it is closed a wait would return at once: the terminal reports a hang-up for all that time.
  return is_open() ? side_->fd() : -1;
}

std::size_t ServedPort::write(std::span<const std::uint8_t> bytes) {
  const std::size_t written = side_->write(bytes);
  tally_.bytes_delivered += written;
  if (keeps_delivered_)
    delivered_.insert(delivered_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(written));
  return written;
}

void ServedPort::deliver(std::span<const std::uint8_t> bytes) {
  deliver_waiting();
  if (!is_open()) {
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
  if (is_open()) {
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(write(waiting_)));
  } else {
    tally_.bytes_unheard += waiting_.size();
    waiting_.clear();
  }
}

std::vector<std::uint8_t> ServedPort::receive() {
  if (!side_) return {};
  std::vector<std::uint8_t> bytes = side_->read();
  tally_.bytes_received += bytes.size();
  return bytes;
}

}  // namespace thermorig
