// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace thermorig {

/// The name that needs the fewest changes, if it is near enough to be meant.
std::optional<std::string> nearest_name(std::string_view unknown, std::span<const std::string> names);

/// What to type instead of a name that is not known: `did you mean "text"? one of: text, witmotion`, the
/// nearest first. There must be a name; without one that is near only the list.
std::string advice_on_name(std::string_view unknown, std::span<const std::string> names);

}  // namespace thermorig
