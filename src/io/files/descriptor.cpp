// SPDX-License-Identifier: MIT
#include "thermorig/io/files/descriptor.h"

#include <unistd.h>

#include <utility>

namespace thermorig::files {

Descriptor::~Descriptor() {
  close();
}

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

void Descriptor::close() {
  if (fd_ >= 0) ::close(release());
}

int Descriptor::release() {
  return std::exchange(fd_, -1);
}

}  // namespace thermorig::files
