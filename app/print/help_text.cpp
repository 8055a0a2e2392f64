// SPDX-License-Identifier: MIT
#include "print/help_text.h"

#include <algorithm>
#include <array>

namespace thermorig::app {

namespace {

constexpr std::size_t least_width = 60;
constexpr std::size_t meaning_column = 30;  // of CLI11: what an option does begins there

/// Where what an option does begins in a line; 0 of a line of another kind.
std::size_t meaning_at(const std::string& line) {
  const bool is_one = line.size() > meaning_column && line.starts_with("  ") &&
                      line[meaning_column - 1] == ' ' && line[meaning_column] != ' ' &&
                      !line.starts_with("  thermorig");
  return is_one ? meaning_column : 0;
}

/// A line that is longer than `width` goes on below where its meaning begins.
std::string wrapped(std::string line, std::size_t width) {
  const std::size_t indent = meaning_at(line);
  if (indent == 0 && line.starts_with(' ')) return line + "\n";
  std::string text;
  while (line.size() > width) {
    const std::size_t end = line.rfind(' ', width);
    if (end == std::string::npos || end <= indent) break;
    text += line.substr(0, end) + "\n";
    line = std::string(indent, ' ') + line.substr(end + 1);
  }
  return text + line + "\n";
}

/// CLI11 prints the value of a bare --simulated as "{1}"; people read "[=SEED]". Same width, so columns stay.
std::string with_choices(std::string help) {
  struct Choice {
    std::string printed, read;
  };
  static const std::array<Choice, 5> choices{{{"{1}    ", "[=SEED]"},
                                              {"{false}", "       "},  // of --no-preflight
                                              {"{windows}", "[=WHAT]  "},
                                              {"{samples}", "[=TABLE] "},
                                              {"{all}  ", "[=NAME]"}}};
  for (const Choice& choice : choices)
    for (auto at = help.find(choice.printed); at != std::string::npos; at = help.find(choice.printed, at))
      help.replace(at, choice.printed.size(), choice.read);
  return help;
}

}  // namespace

std::string help_text(const std::string& printed, std::size_t width) {
  const std::string help = with_choices(printed);
  std::string text;
  for (std::size_t at = 0; at < help.size();) {
    const std::size_t end = std::min(help.find('\n', at), help.size());
    text += wrapped(help.substr(at, end - at), std::max(width, least_width));
    at = end + 1;
  }
  return text;
}

}  // namespace thermorig::app
