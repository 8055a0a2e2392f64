// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace thermorig::tests {

/// A list of what a program left behind, which may be less than a test hopes for: an element that is not
/// there is an exception, which fails the test, where a vector's would crash it.
template <typename T>
class Checked : public std::vector<T> {
 public:
  using std::vector<T>::vector;
  Checked(std::vector<T> values) : std::vector<T>(std::move(values)) {}

  T& operator[](std::size_t i) { return this->at(i); }
  const T& operator[](std::size_t i) const { return this->at(i); }
  T& front() { return this->at(0); }
  const T& front() const { return this->at(0); }
  T& back() { return this->at(this->size() - 1); }
  const T& back() const { return this->at(this->size() - 1); }
};

}  // namespace thermorig::tests
