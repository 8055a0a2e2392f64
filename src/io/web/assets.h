// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace thermorig::web {

/// One file of the page. All views are to constants of the program.
struct Asset {
  std::string_view type;   // of the answer's Content-Type, e.g. "text/html; charset=utf-8"
  std::string_view etag;   // with its quotes, e.g. "\"3f2a...\""
  std::string_view bytes;  // gzip; empty: only as plain text
  std::string_view plain;  // the same without gzip, for a client that does not take that
};

/// The file of a request's target, e.g. "/", "/page.js", "/page.css", "/licences.txt"; an exact match, or
/// nothing. The table is made by src/io/web/page; no path ever reaches the file system.
std::optional<Asset> asset(std::string_view path);

/// The page of a session as a document of its own, without its title and its data: what stands before the
/// title, between the two, and behind the data.
extern const std::array<std::string_view, 3> document_pieces;

/// Whether the page was built into this program; else "/" says how to get it.
extern const bool has_page;

}  // namespace thermorig::web
