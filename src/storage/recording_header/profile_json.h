// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "thermorig/core/profile.h"

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

/// An object of tables, as in the TOML file: keys are the fields' names.
nlohmann::json profile_to_json(const RigProfile& profile);

/// The inverse, of that form or of the one before session format 2.0. Keys that are missing keep their
/// standard value, unknown ones are ignored. Throws nlohmann::json::exception or std::out_of_range.
RigProfile profile_from_json(const nlohmann::json& in);

}  // namespace thermorig::recording_header
