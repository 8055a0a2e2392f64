// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stored_dataset.h"
#include "thermorig/session/session.h"

namespace thermorig::session {

/// A whole HDF5 file in memory, and what must be found in it. Building it in memory keeps HDF5 away from full
/// disks, which it does not survive; it is as large as the file.
struct SessionImage {
  std::vector<std::byte> bytes;
  std::vector<StoredDataset> datasets;
};

/// The bytes do not depend on `threads`. Throws Hdf5Failure, std::bad_alloc.
SessionImage build_image(const Session& session, unsigned threads);

/// Re-opens a written file and holds shapes and stored chunks against what was meant. Throws Hdf5Failure.
void check_written(const std::string& path, const std::vector<StoredDataset>& datasets);

}  // namespace thermorig::session
