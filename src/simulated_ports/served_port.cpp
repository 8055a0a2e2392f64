// SPDX-License-Identifier: MIT
#include "served_port.h"

namespace thermorig {

int ServedPort::readable_fd() {
  if (unplug_) pty_.unplug();
  // While it is closed a wait would return at once: the terminal reports a hang-up for all that time.
  return pty_.is_open() ? pty_.fd() : -1;
}

void ServedPort::deliver(std::span<const std::uint8_t> bytes) {
  if (!pty_.is_open()) {
    tally_.bytes_unheard += bytes.size();
    return;
  }
  const std::size_t written = pty_.write(bytes);
  tally_.bytes_delivered += written;
  tally_.bytes_overrun += bytes.size() - written;
  if (keeps_delivered_)
    delivered_.insert(delivered_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(written));
}

std::vector<std::uint8_t> ServedPort::receive() {
  std::vector<std::uint8_t> bytes = pty_.read();
  tally_.bytes_received += bytes.size();
  return bytes;
}

}  // namespace thermorig
