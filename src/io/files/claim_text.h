// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "thermorig/io/files/claim.h"

namespace thermorig::files {

// What a claim's file holds: a line each of what it is and of its holder, then a byte for each sign of life.

inline constexpr std::size_t longest_claim_text = 1'024;  // bytes, without signs of life
inline constexpr std::string_view given_up_mark = "given up\n";

std::string claim_text(const Process& holder, const std::string& since_utc);

/// Holder and time of day; neither is known if the text is no claim, or not all of it is there. The text is
/// hostile.
ClaimSight claim_from(std::string_view text);

}  // namespace thermorig::files
