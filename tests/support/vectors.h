// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace thermorig::test {

/// One line of a file in protocols/vectors: `name | hex | meaning`.
struct GoldenVector {
  std::string name;
  std::vector<std::uint8_t> bytes;
  std::string meaning;  // "type sequence field=value ...", "field=value ...": as its file says
};

inline std::vector<std::uint8_t> bytes_from_hex(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

inline std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// All vectors of protocols/vectors/`file`. Throws where the file or a line is not as it ought to be.
inline std::vector<GoldenVector> read_vectors(const std::string& file) {
  std::ifstream in(std::string(THERMORIG_VECTORS) + "/" + file);
  if (!in) throw std::runtime_error("no golden vectors: " + file);
  std::vector<GoldenVector> vectors;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t first = line.find('|');
    const std::size_t second = line.find('|', first + 1);
    if (second == std::string::npos) throw std::runtime_error(file + ": not a vector: " + line);
    vectors.push_back({trimmed(line.substr(0, first)),
                       bytes_from_hex(trimmed(line.substr(first + 1, second - first - 1))),
                       trimmed(line.substr(second + 1))});
  }
  return vectors;
}

/// The words of a meaning that have the form field=value, in order.
inline std::vector<std::pair<std::string, std::string>> fields_of(const std::string& meaning) {
  std::vector<std::pair<std::string, std::string>> fields;
  std::istringstream words(meaning);
  for (std::string word; words >> word;)
    if (const std::size_t equals = word.find('='); equals != std::string::npos)
      fields.emplace_back(word.substr(0, equals), word.substr(equals + 1));
  return fields;
}

}  // namespace thermorig::test
