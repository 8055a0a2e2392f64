// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace thermorig::session {

/// Takes rows as a vector does and keeps none of them: whatever a reader checks of a value is checked, and a
/// table of any length takes no memory.
template <typename Row>
class PassedRows {
 public:
  using value_type = Row;

  void resize(std::size_t size) { size_ = size; }
  std::size_t size() const { return size_; }
  Row& operator[](std::size_t /*index*/) { return row_; }

 private:
  std::size_t size_ = 0;
  Row row_{};
};

/// What raw_columns() reads of one direction of one port.
struct PassedStream {
  PassedRows<std::uint8_t> bytes;
  PassedRows<std::uint64_t> chunk_end;
  PassedRows<std::int64_t> time_ns;
};

}  // namespace thermorig::session
