// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "thermorig/learning/interchange/sink.h"

namespace thermorig::interchange {

/// A ZIP archive (APPNOTE 6.3) with members as they are, neither compressed nor limited to 4 GiB. A member is
/// produced twice, first for its check sum, so that nothing has to be kept or gone back to.
class ZipWriter {
 public:
  explicit ZipWriter(Sink& sink) : sink_(sink) {}

  /// `produce` writes the same bytes each time that it is called.
  void add(const std::string& name, const std::function<void(Sink&)>& produce);

  /// The central directory; the last call.
  void finish();

 private:
  struct Member {
    std::string name;
    std::uint32_t crc = 0;
    std::uint64_t size = 0, begin = 0;
  };
  void write(const std::string& bytes);
  void write_ends(std::uint64_t directory_begin);

  Sink& sink_;
  std::uint64_t written_ = 0;
  std::vector<Member> members_;
};

}  // namespace thermorig::interchange
