// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace thermorig::web {

/// What outlives a server, so that the next one is found by a page that is open.
struct PageState {
  std::uint16_t port = 0;
  std::string token;
};

/// The address that opens the page: who has it has the token.
std::string url_of(const PageState& state);

struct FoundState {
  std::optional<PageState> state;
  std::string refused;  // why a file that is there was not believed; empty: it was, or there is none
};

/// Believes a regular file alone, no link, that nobody else owns, may read or may write.
FoundState read_state(const std::filesystem::path& path);

/// Mode 0600, in a folder that is created with mode 0700; with the address that opens the page. Throws
/// Error(storage).
void write_state(const std::filesystem::path& path, const PageState& state);

}  // namespace thermorig::web
