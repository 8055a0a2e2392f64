// SPDX-License-Identifier: MIT
#include "system_text.h"

#include <fstream>
#include <sstream>

namespace thermorig::doctor {

std::string first_line(const std::filesystem::path& file) {
  std::string line;
  std::ifstream in(file);
  std::getline(in, line);
  return line;
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  constexpr std::size_t most = 4096;
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; lines.size() < most && std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

}  // namespace thermorig::doctor
