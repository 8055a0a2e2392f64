// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/io/port.h"

namespace thermorig::io {

/// An open file descriptor, closed at the end of its life.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  void close();

 private:
  int fd_ = -1;
};

/// Opens a terminal device (non-blocking, never the controlling terminal) and takes the lock that every
/// thermorig takes on its ports. `path` has no links in it.
/// Throws Error: device_missing (gone, not a terminal, no hardware), no_permission (not allowed, in use, the
/// console).
Descriptor open_exclusively(const std::string& path, Refusal refusal);

}  // namespace thermorig::io
