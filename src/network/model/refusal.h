// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace thermorig::model {

/// Bytes that are no model of ours: what is wrong and what to try. `from_onnx` adds where and makes it an
/// Error.
class Refusal : public std::runtime_error {
 public:
  explicit Refusal(const std::string& what, std::string advice = "")
      : runtime_error(what), advice_(std::move(advice)) {}
  const std::string& advice() const { return advice_; }

 private:
  std::string advice_;
};

}  // namespace thermorig::model
