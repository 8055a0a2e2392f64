// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::files {

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
  int release();  // its number: whoever takes it closes it

 private:
  int fd_ = -1;
};

}  // namespace thermorig::files
