// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::dataset {

/// Reads a session; for several threads at once, though the HDF5 library is in one of them at a time. Throws
/// as session::read_session() does.
session::Session read_in_turn(const std::filesystem::path& path);

/// Calls `work` with 0 to `count` - 1, in order, on all cores. Throws what it threw for the first of the
/// files.
void for_each_file(std::size_t count, const std::function<void(std::size_t)>& work,
                   const ReadingProgress& progress);

}  // namespace thermorig::dataset
