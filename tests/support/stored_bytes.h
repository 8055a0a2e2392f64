// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "thermorig/storage/session/stored_file.h"

namespace thermorig::tests {

/// A session's file that is in memory alone, as it is now.
inline session::StoredFile stored_bytes(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  const auto read_at = [kept = std::vector(bytes.begin(), bytes.end())](std::uint64_t offset,
                                                                        std::span<std::byte> out) {
    std::ranges::copy(std::span(kept).subspan(offset, out.size()), out.begin());
  };
  return session::StoredFile(bytes.size(), read_at, path);
}

}  // namespace thermorig::tests
