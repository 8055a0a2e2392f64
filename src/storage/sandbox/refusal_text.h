// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "thermorig/core/error.h"

namespace thermorig::sandbox {

/// What children call the file that they are handed, whose path they do not know.
inline constexpr const char* name_in_children = "session";

/// A child's refusal, to be sent to the program.
std::string refusal_text(const Error& refusal);

/// Throws what a child sent, as if this process had refused the file itself: it never reads what a child
/// has refused. The child may be in the file's hands: all it can say is Error(not_a_session) or
/// Error(failed), and a text that it did not write as refusal_text() does means "damaged or hostile".
[[noreturn]] void refuse_as_told(std::string_view text, const std::filesystem::path& path);

/// Throws Error(not_a_session) for a file whose reader did not say how it ended.
[[noreturn]] void refuse_as_hostile(const std::filesystem::path& path);

}  // namespace thermorig::sandbox
