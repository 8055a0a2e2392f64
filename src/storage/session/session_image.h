// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chunk_writer.h"
#include "hdf5_handle.h"
#include "stored_attributes.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

/// A whole HDF5 file in memory (a large array of io/spill), and what must be found in it. Building it there
/// keeps HDF5 away from full disks, which it does not survive.
struct SessionImage {
  Handle file;
  std::span<const std::byte> bytes;  // all of it, while `file` is open
  std::uint32_t crc = 0;             // CRC-32 of them
  std::vector<StoredDataset> datasets;

  /// Gives the memory of the file back. Throws Hdf5Failure.
  void release();
};

/// The bytes do not depend on `threads`. `added`: attributes that somebody else has put into the file that
/// this one is to replace. Throws Hdf5Failure, std::bad_alloc.
SessionImage build_image(const Session& session, unsigned threads,
                         const std::vector<StoredAttribute>& added = {});

/// Holds what the disk gave back of a written file against what was meant, byte by byte, and against what the
/// file was made of: opens it and looks at shapes and stored chunks. `meant.bytes` may be gone by then.
/// Throws Hdf5Failure.
void check_written(const StoredFile& file, const SessionImage& meant);

}  // namespace thermorig::session
