// SPDX-License-Identifier: MIT
#include "mutation.h"

#include <algorithm>

namespace thermorig::model {

std::size_t Mutation::below(std::size_t limit) {
  return static_cast<std::size_t>(random_() % std::max<std::size_t>(limit, 1));
}

/// Half of all changes go where the structure is: most of a file is weights. The graph's nodes come first,
/// the inputs, outputs and metadata last.
std::size_t Mutation::place(const std::string& file) {
  constexpr std::size_t structure_bytes = 2500;
  const std::size_t near = std::min(file.size(), structure_bytes);
  switch (below(4)) {
    case 0:
      return below(near);
    case 1:
      return file.size() - near + below(near);
    default:
      return below(file.size());
  }
}

/// A varint of ten bytes in the place of one byte: a huge length, dimension or number.
void Mutation::inflate(std::string& file) {
  std::string varint(1 + below(9), static_cast<char>(0x80 | below(128)));
  varint.push_back(static_cast<char>(below(128)));
  file.replace(place(file), 1, varint);
}

void Mutation::change(std::string& file, const std::string& donor) {
  if (file.empty()) return;
  const std::size_t at = place(file), length = 1 + below(1U << below(12));
  switch (below(8)) {
    case 0:
      file.resize(at);
      return;
    case 1:
      file.insert(at, file.substr(place(file), length));
      return;
    case 2:
      file.erase(at, length);
      return;
    case 3:
      file.replace(at, length, donor.substr(place(donor), length));
      return;
    case 4:
      inflate(file);
      return;
    case 5:
      file[at] = static_cast<char>(below(256));
      return;
    default:
      file[at] = static_cast<char>(file[at] ^ (1 << below(8)));
  }
}

std::string Mutation::of(std::string file, const std::string& donor) {
  const std::size_t changes = 1 + below(1U << below(4));
  for (std::size_t i = 0; i < changes; ++i) change(file, donor);
  return file;
}

}  // namespace thermorig::model
