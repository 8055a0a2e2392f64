// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace thermorig::session {

/// What was stored of one dataset: what a look at the finished file is compared with.
struct StoredDataset {
  std::string path;
  std::uint64_t rows = 0;
  std::uint64_t chunk_rows = 0;
  std::vector<std::uint32_t> chunk_crc;  // CRC-32 of each chunk as it stands in the file
};

}  // namespace thermorig::session
