// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace thermorig::sandbox {

/// Throws Error(not_a_session): `what` is wrong with the file, and what to try.
[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what);

}  // namespace thermorig::sandbox
