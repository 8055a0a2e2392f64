// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5_hl.h>

#include <cstddef>
#include <span>
#include <string>

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

}  // namespace thermorig::session
