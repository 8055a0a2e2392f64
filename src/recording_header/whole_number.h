// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace thermorig::recording_header {

/// The library casts whatever number stands there. Throws std::out_of_range.
template <typename Integer>
Integer whole_number(const nlohmann::json& in) {
  const bool fits = in.is_number_unsigned()
                        ? std::in_range<Integer>(in.get<std::uint64_t>())
                        : in.is_number_integer() && std::in_range<Integer>(in.get<std::int64_t>());
  if (!fits)
    throw std::out_of_range((in.is_number() ? in.dump() : in.type_name()) +
                            " is no whole number, or too large");
  return in.get<Integer>();
}

}  // namespace thermorig::recording_header
