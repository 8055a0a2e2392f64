// SPDX-License-Identifier: MIT
#pragma once

#include <libdeflate.h>

#include <bit>
#include <cstdint>
#include <string>

#include "thermorig/learning/interchange/formats.h"

namespace thermorig::interchange {

static_assert(std::endian::native == std::endian::little, "these formats are little-endian, and so are we");

/// Appends numbers as they lie in memory.
template <typename... Numbers>
void append_little_endian(std::string& bytes, Numbers... numbers) {
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof(numbers)), ...);
}

/// Counts what is written to it, and sums it up (CRC-32); passes it on where there is another sink.
class CheckedSink final : public Sink {
 public:
  explicit CheckedSink(Sink* next = nullptr) : next_(next) {}

  using Sink::write;
  void write(std::span<const std::byte> bytes) override {
    crc_ = libdeflate_crc32(crc_, bytes.data(), bytes.size());
    size_ += bytes.size();
    if (next_ != nullptr) next_->write(bytes);
  }

  std::uint32_t crc() const { return crc_; }
  std::uint64_t size() const { return size_; }
  void restart_crc() { crc_ = 0; }

 private:
  Sink* next_;
  std::uint32_t crc_ = 0;
  std::uint64_t size_ = 0;
};

}  // namespace thermorig::interchange
