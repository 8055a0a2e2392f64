// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <exception>
#include <string>

#include "hdf5_handle.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

/// What HDF5 reads a file by, for as long as the file is open in it.
struct DriverSource {
  const StoredFile* file = nullptr;
  std::uint64_t end = 0;       // as HDF5 is told it; behind file->size() stand zeros
  std::uint64_t used = 0;      // up to where HDF5 looks: the end that the file states
  std::exception_ptr failure;  // what file->read() threw first: the library only knows that it failed
};

/// Opens a session in HDF5, which asks `source` for its bytes: nothing but reading ever happens to the file.
/// Throws Hdf5Failure(action) if it is no HDF5 file.
Handle open_to_read(DriverSource& source, const std::string& action);

}  // namespace thermorig::session
