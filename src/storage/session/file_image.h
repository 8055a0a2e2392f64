// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5_hl.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "hdf5_handle.h"

namespace thermorig::session {

/// Opens a whole file that lies in memory, which must outlive the handle; the library never writes to it.
/// Each call leaks 72 bytes in releases of libhdf5 before 1.14.4 (github.com/HDFGroup/hdf5, issue 827).
/// Throws Hdf5Failure(action) if it is no HDF5 file.
inline Handle open_file_image(std::span<const std::byte> image, const std::string& action) {
  if (image.empty()) throw Hdf5Failure(action + ": it is empty");
  return Handle(H5LTopen_file_image(const_cast<std::byte*>(image.data()), image.size(),
                                    H5LT_FILE_IMAGE_DONT_COPY | H5LT_FILE_IMAGE_DONT_RELEASE),
                action);
}

/// Where the file ends by its own word, as format version 0 of HDF5's superblock has it, which is what
/// thermorig writes; 0: of other versions, and of what is no HDF5.
inline std::uint64_t stated_end(std::span<const std::byte> image) {
  constexpr std::string_view signature("\x89HDF\r\n\x1a\n\0", 9);  // and the version
  constexpr std::size_t end_at = 40;
  std::uint64_t end = 0;
  if (image.size() < end_at + sizeof end ||
      std::memcmp(image.data(), signature.data(), signature.size()) != 0)
    return 0;
  std::memcpy(&end, image.data() + end_at, sizeof end);
  return end;
}

}  // namespace thermorig::session
