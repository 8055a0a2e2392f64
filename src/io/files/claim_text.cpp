// SPDX-License-Identifier: MIT
#include "claim_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace thermorig::files {

namespace {

constexpr std::string_view first_line = "thermorig claim 1";

/// Letters, digits and what stands in host names and times: nothing that steers a terminal.
bool is_word(std::string_view text) {
  constexpr std::size_t longest = 64;
  return !text.empty() && text.size() <= longest && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.' || c == ':';
  });
}

/// Takes the next line off the text; none if it does not end.
std::optional<std::string_view> next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

/// The value of the next line, which must be "<name> <word>".
std::optional<std::string> next_word(std::string_view& text, std::string_view name) {
  const auto line = next_line(text);
  if (!line || !line->starts_with(name) || line->size() <= name.size() || (*line)[name.size()] != ' ')
    return std::nullopt;
  const std::string_view word = line->substr(name.size() + 1);
  return is_word(word) ? std::optional<std::string>(word) : std::nullopt;
}

std::optional<std::uint64_t> next_count(std::string_view& text, std::string_view name) {
  const auto word = next_word(text, name);
  std::uint64_t count = 0;
  if (!word) return std::nullopt;
  const auto [at, error] = std::from_chars(word->data(), word->data() + word->size(), count);
  return error == std::errc() && at == word->data() + word->size() ? std::optional(count) : std::nullopt;
}

}  // namespace

std::string claim_text(const Process& holder, const std::string& since_utc) {
  const std::string boot = holder.boot.empty() ? "unknown" : holder.boot;
  return fmt::format("{}\nhost {}\nboot {}\nspace {}\nprocess {}\nstart {}\nsince {}\n", first_line,
                     holder.host, boot, holder.space, holder.number, holder.start, since_utc);
}

ClaimSight claim_from(std::string_view text) {
  if (next_line(text) != first_line) return {};
  const auto host = next_word(text, "host");
  const auto boot = next_word(text, "boot");
  const auto space = next_count(text, "space");
  const auto number = next_count(text, "process");
  const auto start = next_count(text, "start");
  const auto since = next_word(text, "since");
  if (!host || !boot || !space || !number || !start || !since) return {};
  ClaimSight sight;
  sight.holder = Process{*host, *boot, *space, *number, *start};
  sight.since_utc = *since;
  return sight;
}

}  // namespace thermorig::files
