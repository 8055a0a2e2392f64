// SPDX-License-Identifier: MIT
// Stands in for the table that src/web/page makes, until that exists.
#include "assets.h"

namespace thermorig::web {

namespace {

using namespace std::string_view_literals;

constexpr auto empty_gzip = "\x1f\x8b\x08\0\0\0\0\0\0\x03\x03\0\0\0\0\0\0\0\0\0"sv;

}  // namespace

std::optional<Asset> asset(std::string_view path) {
  if (path == "/") return Asset{"text/html; charset=utf-8", "\"0\"", empty_gzip, ""};
  if (path == "/page.js") return Asset{"text/javascript; charset=utf-8", "\"0\"", empty_gzip, ""};
  if (path == "/page.css") return Asset{"text/css; charset=utf-8", "\"0\"", empty_gzip, ""};
  if (path == "/licences.txt") return Asset{"text/plain; charset=utf-8", "\"0\"", empty_gzip, ""};
  return std::nullopt;
}

}  // namespace thermorig::web
