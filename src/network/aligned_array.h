// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace thermorig::network {

/// An array of numbers, all 0 at first, that starts at a cache line.
template <class Number>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size)
      : size_(size), values_(static_cast<Number*>(::operator new(size * sizeof(Number), alignment))) {
    clear();
  }

  Number* data() { return values_.get(); }
  const Number* data() const { return values_.get(); }
  std::size_t size() const { return size_; }
  void clear() { std::fill_n(values_.get(), size_, Number{}); }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Release {
    void operator()(Number* values) const { ::operator delete(values, alignment); }
  };

  std::size_t size_ = 0;
  std::unique_ptr<Number, Release> values_;
};

using AlignedFloats = AlignedArray<float>;

}  // namespace thermorig::network
