// SPDX-License-Identifier: MIT
// What stands in for the table of the page's files where node was not there to make it.
#include "assets.h"

namespace thermorig::web {

namespace {

using namespace std::string_view_literals;

constexpr Asset notice{"text/plain; charset=utf-8"sv,
                       "\"without-page\""sv,
                       {},
                       "This thermorig was built without its page. To have it: bash app/setup.sh page, then "
                       "cmake --preset release && cmake --build build\n"sv};

}  // namespace

const bool has_page = false;

const std::array<std::string_view, 3> document_pieces{};

std::optional<Asset> asset(std::string_view path) {
  if (path == "/" || path == "/session") return notice;
  return std::nullopt;
}

}  // namespace thermorig::web
