// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace thermorig::app {

/// A file or, for "-", standard input, read in blocks so that its size does not matter.
class ByteSource {
 public:
  /// Throws Error(bad_usage) if there is no such file, Error(no_permission) or Error(storage) if it cannot be
  /// opened.
  explicit ByteSource(const std::string& path);

  /// The next block; empty at the end. Throws Error(storage) if reading fails. Valid until the next call.
  std::span<const std::uint8_t> next();

  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::vector<std::uint8_t> block_;
};

}  // namespace thermorig::app
