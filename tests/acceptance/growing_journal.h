// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "thermorig/storage/journal/journal.h"

namespace thermorig::tests {

/// What stands so far in a journal that another process writes; none while its first record is not whole.
std::optional<journal::JournalContents> growing_journal(const std::filesystem::path& path);

/// The first leg has begun.
bool has_first_leg(const std::filesystem::path& path);

}  // namespace thermorig::tests
