// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <utility>

namespace thermorig::spill {

struct Limits {
  std::size_t array_bytes = 1U << 20U;       // a block of so many is a large array
  std::size_t in_memory_bytes = 16U << 20U;  // of large arrays together, before others go to the disk
  std::size_t resident_bytes = 36U << 20U;   // of mapped pages of files, the program's own included
};

/// From here on, for the rest of the program, large arrays (whatever asks `new` for so much) lie in files
/// without a name on the disk of `near`, once there are more of them than memory shall hold. To the program
/// they are memory; what it has not touched lately is on the disk alone. Called again, it changes where new
/// arrays go. Where no disk has room they stay in memory. May be called from several threads.
void arrays_near(const std::filesystem::path& near, const Limits& limits = {});

/// Gives pages of such arrays back to the system, if more of them are in memory than shall be. A thread does
/// that four times a millisecond; who looks at large arrays quickly calls it now and then.
void give_pages_back();

/// Tells when so many bytes have passed by, again and again.
class EveryBytes {
 public:
  explicit EveryBytes(std::size_t bytes) : every_(bytes) {}

  bool is_due_after(std::size_t bytes) {
    if ((passed_ += bytes) < every_) return false;
    passed_ = 0;
    return true;
  }

 private:
  std::size_t every_;
  std::size_t passed_ = 0;
};

/// `rows` for a loop that goes through them and hardly looks at each: pages are given back on the way. Such a
/// walk brings more of a large array into memory than a thread can give back beside it.
template <typename Rows>
class Paced {
  using At = decltype(std::begin(std::declval<Rows&>()));

 public:
  explicit Paced(Rows& rows) : rows_(&rows) {}

  class Iterator {
   public:
    explicit Iterator(At at) : at_(at) {}
    decltype(auto) operator*() const { return *at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }
    Iterator& operator++() {
      if (look_.is_due_after(sizeof *at_)) give_pages_back();
      ++at_;
      return *this;
    }

   private:
    At at_;
    EveryBytes look_{2U << 20U};
  };

  Iterator begin() const { return Iterator(std::begin(*rows_)); }
  Iterator end() const { return Iterator(std::end(*rows_)); }

 private:
  Rows* rows_;
};

/// Bytes of arrays that lie on a disk now.
std::size_t spilled_bytes();

}  // namespace thermorig::spill
