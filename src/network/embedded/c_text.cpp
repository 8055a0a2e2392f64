// SPDX-License-Identifier: MIT
#include "thermorig/network/embedded/c_text.h"

#include <algorithm>
#include <array>

#include "thermorig/core/error.h"

namespace thermorig::embedded {

namespace {

constexpr std::size_t longest_comment = 100;
constexpr std::size_t longest_name = 48;

// A folder with a file of such a name hides the compiler's own header.
constexpr std::array<std::string_view, 24> standard_headers{
    "assert", "complex", "ctype",  "errno",  "fenv",   "float",  "inttypes", "iso646",
    "limits", "locale",  "math",   "setjmp", "signal", "stdarg", "stdbool",  "stddef",
    "stdint", "stdio",   "stdlib", "string", "tgmath", "time",   "wchar",    "wctype"};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_name(const std::string& name) {
  const auto allowed = [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= longest_name && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), allowed) &&
         std::find(standard_headers.begin(), standard_headers.end(), name) == standard_headers.end();
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

}  // namespace

void require_name(const std::string& name) {
  if (is_name(name)) return;
  throw Error(ExitCode::bad_usage, "files and symbols cannot have this name", name,
              "letters, digits and _, a letter first, at most 48, and no standard header's name");
}

std::string renamed(std::string_view text, std::string_view prefix, const std::string& name) {
  std::string result(text);
  // by way of a word that no name can hold: the name may contain what is replaced
  replace_all(result, prefix, "@1");
  replace_all(result, upper(prefix), "@2");
  replace_all(result, "@1", name);
  replace_all(result, "@2", upper(name));
  return result;
}

std::string comment_safe(std::string_view text) {
  std::string safe;
  for (char c : text.substr(0, longest_comment)) {
    const bool harmless = c >= ' ' && c <= '~' && c != '\\' && c != '?' && c != '@';
    const bool end_or_begin =
        !safe.empty() && ((safe.back() == '*' && c == '/') || (safe.back() == '/' && c == '*'));
    if (end_or_begin) safe += ' ';
    safe += harmless ? c : '_';
  }
  return safe;
}

}  // namespace thermorig::embedded
